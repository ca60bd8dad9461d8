#pragma once

#include <optional>

#include "console/server/surface_store.h"
#include "simulation/surface/surface_sink.h"

namespace osteon::console {

/// Puts the chunks of a changing surface into the pages' store, as bytes.
class SurfaceFeed final : public surface::SurfaceSink {
 public:
  /// @param store  outlives this
  explicit SurfaceFeed(SurfaceStore& store) : store_(store) {}

  /// Begins a surface on a new grid. Pages get {"type": "surface", "origin_mm", "voxel_mm", "bricks"}.
  void Begin(const surface::BrickLayout& layout) override;
  /// Begins a surface that shows the difference of two bones. The message also has "difference_step_mm": the
  /// material of each vertex is then the difference as a number of such steps, plus 64.
  void BeginDifference(const surface::BrickLayout& layout, float step_mm);
  void Publish(std::span<const surface::SurfaceChunk> chunks, std::uint64_t frame) override;

 private:
  // @param difference_step_mm  for the message; nothing: the materials are tissues
  void BeginStore(const surface::BrickLayout& layout, std::optional<float> difference_step_mm);

  SurfaceStore& store_;
  surface::BrickLayout layout_;
};

}  // namespace osteon::console
