#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "report/bone_shape.h"
#include "report/render.h"
#include "report/section.h"
#include "simulation/surface/surface_chunk.h"

// The carved bone that can be turned: its surface as bytes within the page, drawn by the page's own script.

namespace osteon::app {

/// The carved surface of a run, as small as a page should carry.
struct CarvedSurface {
  surface::BrickLayout layout{};
  std::vector<std::uint8_t> chunks{};  ///< simulation/surface/chunk_bytes.h
  /// Distance of each vertex on a cut face from the ideal cavity [µm], in the chunks' order; positive: too
  /// much was removed. Empty: no tool that cuts, or no path.
  std::vector<std::int16_t> deviation_um{};
  std::size_t quads{0};
  CavityError ideal{};  ///< over the cut faces' vertices
};

/// Carves the bone's solid, or the union of its balls where `solid` is null, by the tool's path, and measures
/// the cut faces against the ideal cavity: what the tool's cutting balls sweep if the tool is drawn straight
/// out along the site's axis from its deepest pose.
/// The grid is made coarser until there are at most `max_quads`. No chunk where nothing has a surface.
[[nodiscard]] CarvedSurface CarveSurface(const simulation::Bone& bone, const simulation::Solid* solid,
                                         const MaterialMap& materials, const simulation::Tool& tool,
                                         std::span<const Pose> X_GP, std::size_t max_quads = 120'000);

/// Markup of the view: hidden until the script draws it. Empty text without a chunk.
[[nodiscard]] std::string BoneViewHtml(const CarvedSurface& carved, const simulation::Bone& bone,
                                       const RenderParams& params);

}  // namespace osteon::app
