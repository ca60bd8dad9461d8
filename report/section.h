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

/// The plane of the section, in G. A point (x, y) of the section is p_G = origin + x u + y v.
struct SectionPlane {
  Vector3 origin{Vector3::Zero()}, u{Vector3::UnitX()}, v{Vector3::UnitZ()};
  [[nodiscard]] Vector3 Point(const Vector2& p) const { return origin + p.x() * u + p.y() * v; }
  [[nodiscard]] Vector2 Project(const Vector3& p) const { return {(p - origin).dot(u), (p - origin).dot(v)}; }
};

/// Distance between the cavity's surface and the surface that the tool's cutting balls swept [m]. Positive:
/// the cavity is larger than the swept tool (over-cut); negative: bone is left where the tool has been
/// (under-cut).
struct CavityError {
  double mean_m{0.0};       ///< mean of the signed errors
  double mean_abs_m{0.0};   ///< mean of the absolute values
  double p95_m{0.0};        ///< 95th percentile of the absolute values
  double max_over_m{0.0};   ///< greatest over-cut, >= 0
  double max_under_m{0.0};  ///< greatest under-cut, <= 0
  int samples{0};           ///< 0: nothing was cut, and the other figures have no meaning
  int open{0};  ///< number of directions in which the cut went through the bone, so that there is no surface
                ///< and no sample
};

/// The error at one place of the cut surface.
struct ErrorSample {
  /// angle about the deepest position of the head's centre, measured from -v, positive towards u
  double angle_rad{0.0};
  double error_m{0.0};
  /// in the section: length of the outline that the sample represents; over directions: 1
  double weight{1.0};
  Vector2 place_m{Vector2::Zero()};  ///< position in the plane; only in the section
};

/// Computes mean, percentile and extremes of weighted samples.
[[nodiscard]] CavityError SummarizeErrors(std::span<const ErrorSample> samples);

/// The region of a material in the plane.
struct MaterialRegion {
  simulation::MaterialIndex material{0};
  std::vector<Polyline> outline{};
};

/// Settings of a section and of the error measured in it.
struct SectionParams {
  double step_m{0.1e-3};  ///< step of the grid on which outlines are found
  double margin_m{6e-3};  ///< margin around the bone
  /// Largest extent of the drawing's window from the cup's centre, sideways and downward, so that the cup is
  /// not drawn small if the bone is a whole hip. If the tool came deeper, the window extends down to the
  /// tool.
  double reach_in_cup_radii{2.2}, depth_in_cup_radii{1.7};
  double cut_depth_m{0.05e-3};  ///< a point of the new surface counts as cut if it lay more than this deep in
                                ///< the bone before
  /// If the first surface is more than this behind the swept volume, it does not belong to the cavity: the
  /// bone is cut through.
  double open_gap_m{5e-3};
  const simulation::Solid* solid{nullptr};          ///< gives the materials; null: the mass points give them
  int directions{4000};                             ///< number of directions of CavityErrorByDirection
  std::span<const simulation::ToolPath> earlier{};  ///< tools that cut before this one
};

/// The outlines in the plane, and the error along the cut outline. Lengths in metres.
struct Section {
  SectionPlane plane;
  Vector2 min{Vector2::Zero()}, max{Vector2::Zero()};  ///< the window of the drawing [m]
  std::vector<Polyline> before, after;  ///< outlines with the bone on their left; open at the window's border
  std::vector<Polyline> swept;          ///< outlines of the swept volume, which is on their left
  std::vector<Polyline> solid;          ///< closed: the bone in the window after the cut
  std::vector<MaterialRegion> materials;  ///< regions of the bone after the cut
  Vector2 head_center{Vector2::Zero()};   ///< deepest position of the head's centre, in the plane
  double head_radius_m{0.0};              ///< 0: no cutting ball, or no path
  CavityError error;                      ///< measured along `after`
  std::vector<ErrorSample> samples;       ///< sorted by angle
};

/// Chooses the plane that contains the cup's axis and the point of the head's path that is farthest from this
/// axis. If the path stays on the axis, any plane through the axis is chosen.
[[nodiscard]] SectionPlane ChooseSectionPlane(const simulation::Bone& bone, const simulation::Tool& tool,
                                              std::span<const Pose> X_GP);

/// Computes a section. The outlines of the bone come from marching squares on the signed distance to the
/// circles in which the plane cuts the balls (error below step^2 / (8 r) for a circle of radius r). The swept
/// outline comes from the distance to the swept tool. The materials come from the solid or, without one, from
/// the mass points.
[[nodiscard]] Section ComputeSection(const simulation::Bone& bone, const simulation::CarvedState& after,
                                     const simulation::Tool& tool, std::span<const Pose> X_GP,
                                     const SectionParams& params = {});

/// Computes the cavity error over directions in space, along rays from the deepest position of the head's
/// centre over the hemisphere that points into the cup. The error of a ray is the distance to the first
/// remaining ball minus the distance to the end of the swept volume. A ray counts only if the end of the
/// swept volume lay in the bone before the cut.
[[nodiscard]] CavityError CavityErrorByDirection(const simulation::Bone& bone,
                                                 const simulation::CarvedState& after,
                                                 const simulation::Tool& tool, std::span<const Pose> X_GP,
                                                 const SectionParams& params = {});

/// Draws the bone after the cut, coloured by material, the outline before the cut, and the swept tool. Both
/// axes are in mm with equal scales.
[[nodiscard]] std::string SectionSvg(const Section& section, const simulation::Bone& bone,
                                     double width_px = 920.0);

/// Draws the section enlarged around the deepest position of the head; empty text if there is no path.
[[nodiscard]] std::string SectionDetailSvg(const Section& section, const simulation::Bone& bone,
                                           double width_px = 920.0);

}  // namespace osteon::report
