#pragma once

#include <cstdint>
#include <span>

#include "simulation/surface/surface_chunk.h"

namespace osteon::surface {

/// Receives the mesh whenever it has changed. One thread at a time calls it; the engine's thread calls it
/// only within SurfaceThread::Apply.
class SurfaceSink {
 public:
  SurfaceSink() = default;
  virtual ~SurfaceSink() = default;
  SurfaceSink(const SurfaceSink&) = delete;
  SurfaceSink& operator=(const SurfaceSink&) = delete;

  /// The grid of all chunks. Called once, before the first Publish.
  virtual void Begin(const BrickLayout& layout) = 0;
  /// Publishes chunks that replace those of the same bricks. The first call contains every brick that has a
  /// surface.
  /// @param chunks  valid during the call only
  /// @param frame   number of the last frame that was read (ToolSweep::frame); the frames of an incomplete
  ///   batch are not carved yet
  virtual void Publish(std::span<const SurfaceChunk> chunks, std::uint64_t frame) = 0;
};

}  // namespace osteon::surface
