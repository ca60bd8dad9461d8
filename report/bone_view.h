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

// An interactive view of the carved bone, which a reader of the page can rotate. The page contains the
// surface as bytes, and the page's script draws it.

namespace osteon::report {

/// The carved surface of a run, coarse enough to be embedded in a page.
struct CarvedSurface {
  surface::BrickLayout layout{};
  std::vector<std::uint8_t> chunks{};  ///< the surface in the format of simulation/surface/chunk_bytes.h
  /// Distance of each vertex on a cut face from the planned or, without a plan, the ideal cavity [µm], in the
  /// order of the chunks; positive: too much was removed. Empty: no tool cuts, or there is no path.
  std::vector<std::int16_t> deviation_um{};
  std::size_t quads{0};
  CavityError error{};  ///< over the cut faces' vertices
  bool planned{false};  ///< deviations are from the planned cavity; false: from the tools' ideal cavity
};

/// Bone and tool paths to carve, and the cavity with which the cut faces are compared. Spans, pointers and
/// references must stay valid during the call.
struct CarveInput {
  const simulation::Bone& bone;
  const simulation::Solid* solid{nullptr};  ///< shape of the uncut bone; null: the union of the bone's balls
  const MaterialMap& materials;
  std::span<const simulation::ToolPath> paths{};  ///< paths of the tools, in the order in which the tools cut
  /// Signed distance of a point in G to the planned cavity [m], negative inside it. Empty: there is no plan.
  std::function<double(const Vector3& p_G_m)> planned{};
  std::size_t max_quads{120'000};
};

/// Carves the bone by the tools' paths, and measures the cut faces against the planned cavity. Without a plan
/// they are measured against the ideal cavity: the space that the cutting balls of each tool sweep if the
/// tool moves straight out along the site's axis from its deepest pose. The grid is made coarser until the
/// surface has at most `max_quads` quads. Returns no chunks if there is no surface, or if the surface had too
/// many quads on all of five grids.
[[nodiscard]] CarvedSurface CarveSurface(const CarveInput& input);

/// The bone before and after the cut, for pictures.
struct BoneMeshes {
  BoneMesh before, after;
};

/// Carves the bone by the tools' paths, on the grid for the last tool; the grid is made coarser if a mesh has
/// more than `max_quads` quads. Returns empty meshes if there is no surface, or if a mesh had too many quads
/// on all of five grids.
[[nodiscard]] BoneMeshes MeshBone(const CarveInput& input);

/// Returns the space that a tool's cutting parts sweep along its path, as capsules. Carving with the capsules
/// of all paths at once takes a fraction of the time of carving frame by frame, and leaves the same field.
[[nodiscard]] std::vector<surface::Capsule> CapsulesAlong(const simulation::ToolPath& path);

/// Carves a field by the path of one tool, or by the paths of several tools.
void CarveAlong(surface::CarvedField& field, const simulation::ToolPath& path);
void CarveAlong(surface::CarvedField& field, std::span<const simulation::ToolPath> paths);

/// The view as it is at first.
struct BoneViewStart {
  bool shows_deviation{false};  ///< false: shows the tissues' colours
  double range_mm{0.0};         ///< deviation at the end of the colour scale; 0: the rounded 95th percentile
};

/// Makes the view's markup, which is hidden until the script draws it. Empty text if there are no chunks.
[[nodiscard]] std::string BoneViewHtml(const CarvedSurface& carved, const simulation::Bone& bone,
                                       const RenderParams& params, const BoneViewStart& start = {});

}  // namespace osteon::report
