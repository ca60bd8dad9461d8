#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "plugin/include/osteon.h"
#include "simulation/surface/surface_sink.h"

namespace osteon::plugin {

/// Keeps the newest mesh of each brick until a caller copies it. The surface thread writes, any thread reads.
class SurfaceMailbox final : public surface::SurfaceSink {
 public:
  void Begin(const surface::BrickLayout& layout) override;
  void Publish(std::span<const surface::SurfaceChunk> chunks, std::uint64_t frame) override;

  /// Copies the chunks that were published after `generation`, and updates `generation`
  /// (osteon_session_surface_changes).
  /// @throws Failure if a buffer is null, or is too small for the largest possible chunk.
  void CopyChanges(std::uint64_t& generation, OsteonSurfaceBuffers& buffers) const;

 private:
  struct Kept {
    std::uint64_t generation{0};  // value of generation_ when the chunk was published; 0: never
    surface::SurfaceChunk chunk;
  };
  mutable std::mutex mutex_;
  std::vector<Kept> kept_;       // newest chunk of each brick; index: number of the brick
  std::uint64_t generation_{0};  // number of chunks published so far
};

}  // namespace osteon::plugin
