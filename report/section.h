#pragma once

#include <span>
#include <string>
#include <vector>

#include "report/bone_shape.h"
#include "report/contour.h"
#include "simulation/tools/swept_tool.h"

// A section through the bone by a plane that contains the cup's axis, and the accuracy of the cut in it.
//
//        y along the cup's axis, out of the opening
//        ▲        ┆ swept tool ┆
//   ▓▓▓▓ │        ┆            ┆      ▓▓▓▓   before: outline of the union of the initial balls
//   ▓▓▓▓▓▓▓       ╲            ╱    ▓▓▓▓▓▓   after:  outline of the remaining balls
//   ▓▓▓▓▓▓▓▓▓▓▄▄▄▄▄▄╲________╱▄▄▄▓▓▓▓▓▓▓▓▓▓▓
//   ────────────────────────────────────▶ x
//                    origin: the cup's centre

namespace osteon::report {

using simulation::CuttingHead;
using simulation::SweptTool;

/// The plane, in G. p_G = origin + x u + y v.
struct SectionPlane {
  Vector3 origin{Vector3::Zero()}, u{Vector3::UnitX()}, v{Vector3::UnitZ()};
  [[nodiscard]] Vector3 Point(const Vector2& p) const { return origin + p.x() * u + p.y() * v; }
  [[nodiscard]] Vector2 Project(const Vector3& p) const { return {(p - origin).dot(u), (p - origin).dot(v)}; }
};

/// Distance between the cavity's surface and the surface that the tool's cutting balls swept [m]. Positive:
/// the cavity is larger than the swept tool (over-cut); negative: bone is left where the tool has been
/// (under-cut).
struct CavityError {
  double mean_m{0.0};       ///< signed
  double mean_abs_m{0.0};   ///< of the absolute values
  double p95_m{0.0};        ///< 95th percentile of the absolute values
  double max_over_m{0.0};   ///< greatest over-cut, >= 0
  double max_under_m{0.0};  ///< greatest under-cut, <= 0
  int samples{0};           ///< 0: nothing was cut, and the other figures have no meaning
  int open{0};  ///< directions in which the cut went through the bone: there is no surface, and no sample
};

/// The error at one place of the cut surface.
struct ErrorSample {
  double angle_rad{0.0};  ///< about the head's deepest centre, from -v, positive towards u
  double error_m{0.0};
  double weight{1.0};  ///< length of outline that the sample stands for (section), 1 (directions)
  Vector2 place_m{Vector2::Zero()};  ///< in the plane (section)
};

/// Mean, percentile and extremes of samples, by their weights.
[[nodiscard]] CavityError SummarizeErrors(std::span<const ErrorSample> samples);

/// The region of a material in the plane.
struct MaterialRegion {
  simulation::MaterialIndex material{0};
  std::vector<Polyline> outline{};
};

/// Settings of a section and of the error measured in it.
struct SectionParams {
  double step_m{0.1e-3};  ///< of the grid on which outlines are found
  double margin_m{6e-3};  ///< around the bone
  /// The drawing's window reaches at most this far from the cup's centre, sideways and down, so that the cup
  /// of a whole hip is not small; farther down only if the tool came deeper.
  double reach_in_cup_radii{2.2}, depth_in_cup_radii{1.7};
  double cut_depth_m{0.05e-3};  ///< a place was cut if it lay this deep in the bone before
  /// A surface that lies more than this behind the swept volume is not the cavity's: the bone is cut through.
  double open_gap_m{5e-3};
  const simulation::Solid* solid{nullptr};          ///< gives the materials; null: the mass points give them
  int directions{4000};                             ///< number of directions of CavityErrorByDirection
  std::span<const simulation::ToolPath> earlier{};  ///< tools that cut before this one
};

/// Outlines in the plane, and the error along the cut one. Lengths in metres.
struct Section {
  SectionPlane plane;
  Vector2 min{Vector2::Zero()}, max{Vector2::Zero()};  ///< the window of the drawing [m]
  std::vector<Polyline> before, after;                 ///< bone on the left; open where they leave the window
  std::vector<Polyline> swept;                         ///< bounds of the swept volume, which is on the left
  std::vector<Polyline> solid;                         ///< closed: the bone in the window after the cut
  std::vector<MaterialRegion> materials;               ///< of the bone after the cut
  Vector2 head_center{Vector2::Zero()};                ///< at the head's deepest place, in the plane
  double head_radius_m{0.0};                           ///< 0: no cutting ball, or no path
  CavityError error;                                   ///< measured along `after`
  std::vector<ErrorSample> samples;                    ///< sorted by angle
};

/// Chooses the plane through the cup's axis toward the point where the head's path was farthest from the
/// axis; any such plane if the path stayed on it.
[[nodiscard]] SectionPlane ChooseSectionPlane(const simulation::Bone& bone, const simulation::Tool& tool,
                                              std::span<const Pose> X_GP);

/// Computes the outlines by marching squares on the signed distance to the slices' circles (error below
/// step^2 / (8 r)), the swept outline on the distance to the swept tool, and the materials from the solid or,
/// without one, from the mass points.
[[nodiscard]] Section ComputeSection(const simulation::Bone& bone, const simulation::CarvedState& after,
                                     const simulation::Tool& tool, std::span<const Pose> X_GP,
                                     const SectionParams& params = {});

/// Computes the cavity error over directions in space, along rays from the head's deepest centre over the
/// hemisphere into the cup. The error of a ray is the distance to the first remaining ball minus the distance
/// to the end of the swept volume. A ray counts only if that end lay in the bone before.
[[nodiscard]] CavityError CavityErrorByDirection(const simulation::Bone& bone,
                                                 const simulation::CarvedState& after,
                                                 const simulation::Tool& tool, std::span<const Pose> X_GP,
                                                 const SectionParams& params = {});

/// Draws the bone after the cut by material, the outline before, and the swept tool; equal axes in mm.
[[nodiscard]] std::string SectionSvg(const Section& section, const simulation::Bone& bone,
                                     double width_px = 920.0);

/// Draws the section enlarged around the deepest place of the head's path; empty text if there is no path.
[[nodiscard]] std::string SectionDetailSvg(const Section& section, const simulation::Bone& bone,
                                           double width_px = 920.0);

}  // namespace osteon::report
