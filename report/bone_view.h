#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "report/bone_shape.h"
#include "report/depth_buffer.h"
#include "report/render.h"
#include "report/section.h"
#include "simulation/surface/capsule.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/surface_chunk.h"

// The carved bone that can be turned: its surface as bytes within the page, drawn by the page's own script.

namespace osteon::report {

/// The carved surface of a run, as small as a page should carry.
struct CarvedSurface {
  surface::BrickLayout layout{};
  std::vector<std::uint8_t> chunks{};  ///< simulation/surface/chunk_bytes.h
  /// Distance of each vertex on a cut face from the cavity that it is compared with [µm], in the chunks'
  /// order; positive: too much was removed. Empty: no tool that cuts, or no path.
  std::vector<std::int16_t> deviation_um{};
  std::size_t quads{0};
  CavityError error{};  ///< over the cut faces' vertices
  bool planned{false};  ///< compared with the planned cavity; false: with the tools' ideal one
};

/// Bone and tool paths to carve, and the cavity with which the cut faces are compared. Views must outlive the
/// call.
struct CarveInput {
  const simulation::Bone& bone;
  const simulation::Solid* solid{nullptr};  ///< null: the union of the bone's balls
  const MaterialMap& materials;
  std::span<const simulation::ToolPath> paths{};  ///< of the tools, in the order in which they cut
  /// Signed distance to the planned cavity [m] of a place in G, negative within it. Empty: no plan.
  std::function<double(const Vector3& p_G_m)> planned{};
  std::size_t max_quads{120'000};
};

/// Carves the bone by the tools' paths, and measures the cut faces against the planned cavity. Without a plan
/// they are measured against the ideal cavity: what the cutting balls of each tool sweep if it is drawn
/// straight out along the site's axis from its deepest pose.
/// The grid is made coarser until there are at most `max_quads`. No chunk where nothing has a surface.
[[nodiscard]] CarvedSurface CarveSurface(const CarveInput& input);

/// The bone before and after the cut, for pictures.
struct BoneMeshes {
  BoneMesh before, after;
};

/// Carves the bone as CarveSurface does, on the tool's own grid up to `max_quads`. Empty meshes where nothing
/// has a surface.
[[nodiscard]] BoneMeshes MeshBone(const CarveInput& input);

/// The room that a tool's cutting parts sweep along its path. To carve by the capsules of all paths at once
/// takes a fraction of the time that frame by frame takes, and leaves the same field.
[[nodiscard]] std::vector<surface::Capsule> CapsulesAlong(const simulation::ToolPath& path);

/// Carves a field by a tool's path, or by those of several tools.
void CarveAlong(surface::CarvedField& field, const simulation::ToolPath& path);
void CarveAlong(surface::CarvedField& field, std::span<const simulation::ToolPath> paths);

/// How the view begins.
struct BoneViewStart {
  bool shows_deviation{false};  ///< false: the tissues' colours
  double range_mm{0.0};  ///< deviation at which the colour is full; 0: a round one by the 95th percentile
};

/// Markup of the view: hidden until the script draws it. Empty text without a chunk.
[[nodiscard]] std::string BoneViewHtml(const CarvedSurface& carved, const simulation::Bone& bone,
                                       const RenderParams& params, const BoneViewStart& start = {});

}  // namespace osteon::report
