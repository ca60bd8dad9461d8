#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "app/report/bone_shape.h"
#include "app/report/contour.h"
#include "simulation/tools/swept_tool.h"

// A section through the bone by a plane that holds the cup's axis, and what it says about the cut.
//
//        y along the cup's axis, out of the opening
//        ▲        ┆ swept tool ┆
//   ▓▓▓▓ │        ┆            ┆      ▓▓▓▓   before: outline of the union of the initial balls
//   ▓▓▓▓▓▓▓       ╲            ╱    ▓▓▓▓▓▓   after:  of what is left
//   ▓▓▓▓▓▓▓▓▓▓▄▄▄▄▄▄╲________╱▄▄▄▓▓▓▓▓▓▓▓▓▓▓
//   ────────────────────────────────────▶ x
//                    origin: the cup's centre

namespace osteon::app {

using simulation::CuttingHead;
using simulation::SweptTool;

/// The plane, in G. p_G = origin + x u + y v.
struct SectionPlane {
  Vector3 origin{Vector3::Zero()}, u{Vector3::UnitX()}, v{Vector3::UnitZ()};
  [[nodiscard]] Vector3 Point(const Vector2& p) const { return origin + p.x() * u + p.y() * v; }
  [[nodiscard]] Vector2 Project(const Vector3& p) const { return {(p - origin).dot(u), (p - origin).dot(v)}; }
};

/// Distance between the cavity that the cut left and the surface that the tool's cutting balls swept [m].
/// Positive: the cavity is larger than the swept tool (over-cut); negative: bone is left where the tool has
/// been (under-cut).
struct CavityError {
  double mean_m{0.0};       ///< signed
  double mean_abs_m{0.0};   ///< of the sizes
  double p95_m{0.0};        ///< 95 % of the sizes are below
  double max_over_m{0.0};   ///< greatest over-cut, >= 0
  double max_under_m{0.0};  ///< greatest under-cut, <= 0
  int samples{0};           ///< 0: nothing was cut, and the rest says nothing
  int open{0};              ///< directions in which the cut went through the bone: no surface, left out
};

/// One place of the cut surface.
struct ErrorSample {
  double angle_rad{0.0};  ///< about the head's deepest centre, from -v, positive towards u
  double error_m{0.0};
  double weight{1.0};                ///< length of surface that it stands for (section), or 1 (directions)
  Vector2 place_m{Vector2::Zero()};  ///< in the plane (section)
};

struct MaterialRegion {
  simulation::MaterialIndex material{0};
  std::vector<Polyline> outline{};
};

struct SectionParams {
  double step_m{0.1e-3};
  double margin_m{6e-3};  ///< around the bone
  /// At most this far from the cup's centre, sideways and down, so that a whole hip still shows its cup;
  /// farther down only where the tool came deeper.
  double reach_in_cup_radii{2.2}, depth_in_cup_radii{1.7};
  double cut_depth_m{0.05e-3};  ///< a place was cut if it lay this deep in the bone before
  double open_gap_m{5e-3};      ///< a surface farther than this behind the sweep is another one: cut through
  const simulation::Solid* solid{nullptr};  ///< for the materials; null: from the mass points
  int directions{4000};                     ///< of CavityErrorByDirection over the hemisphere
};

struct Section {
  SectionPlane plane;
  Vector2 min{Vector2::Zero()}, max{Vector2::Zero()};  ///< what is shown [m]
  std::vector<Polyline> before, after;                 ///< bone on the left; open where they leave the window
  std::vector<Polyline> swept;                         ///< the same, swept volume on the left
  std::vector<Polyline> solid;                         ///< closed: the bone in the window after the cut
  std::vector<MaterialRegion> materials;               ///< of the bone after the cut
  Vector2 head_center{Vector2::Zero()};                ///< deepest, in the plane
  double head_radius_m{0.0};                           ///< 0: no cutting ball, or no path
  CavityError error;                                   ///< measured along `after`
  std::vector<ErrorSample> samples;                    ///< sorted by angle
};

/// Plane through the cup's axis towards where the head's path went farthest off the axis; where it did not,
/// any.
[[nodiscard]] SectionPlane ChooseSectionPlane(const simulation::Bone& bone, const simulation::Tool& tool,
                                              std::span<const Pose> X_GP);

/// Outlines by marching squares on the signed distance to the slices' circles (error below step^2 / (8 r)),
/// the swept one on the distance to the swept tool; materials from the mass points.
[[nodiscard]] Section ComputeSection(const simulation::Bone& bone, const simulation::CarvedState& after,
                                     const simulation::Tool& tool, std::span<const Pose> X_GP,
                                     const SectionParams& params = {});

/// The same error in three dimensions: rays from the head's deepest centre over the hemisphere into the cup,
/// first ball left against the end of the swept volume, where that end lay in the bone before.
[[nodiscard]] CavityError CavityErrorByDirection(const simulation::Bone& bone,
                                                 const simulation::CarvedState& after,
                                                 const simulation::Tool& tool, std::span<const Pose> X_GP,
                                                 const SectionParams& params = {});

/// The drawing: bone after the cut by material, outline before, swept tool; equal axes in mm.
[[nodiscard]] std::string SectionSvg(const Section& section, const simulation::Bone& bone,
                                     double width_px = 920.0);

/// The same, enlarged, around the deepest place of the head's path; empty text where there is no path.
[[nodiscard]] std::string SectionDetailSvg(const Section& section, const simulation::Bone& bone,
                                           double width_px = 920.0);

/// SectionSvg into a file. @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteSectionSvg(const Section& section,
                                                              const simulation::Bone& bone,
                                                              const std::filesystem::path& path);

}  // namespace osteon::app
