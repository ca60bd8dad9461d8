#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "procedure/assessment/sphere_fit.h"
#include "procedure/plan/surgical_plan.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"

// Compares the bone at the end of a session with the plan. Every figure is computed from the final carved
// state: shapes from its balls, volumes from its mass points.

namespace osteon::procedure {

/// A displacement along the anatomical directions.
struct AnatomicShift {
  double medial_m{0.0}, superior_m{0.0}, posterior_m{0.0};
};
/// Splits a displacement in G into its anatomical components.
[[nodiscard]] AnatomicShift ShiftOf(const PelvicFrame& pelvis, const Vector3& d_G);

/// Shape and volumes of a cavity, compared with the plan.
struct CavityResult {
  std::optional<SphereFit> fit;
  std::string fit_refused;               ///< why no sphere was fitted
  AnatomicShift from_plan, from_native;  ///< shift of the fitted centre from the planned and from the native
                                         ///< centre; zero without a fit
  /// Share of the planned hemisphere at which bone begins within ±kCoverageGap_m, measured radially.
  double coverage{0.0};
  double removed_m3{0.0};
  /// volume removed outside the planned cavity; the target of an opening is not counted
  double over_m3{0.0};
  double under_m3{0.0};  ///< volume left inside the planned cavity; the target of an opening is not counted
  /// Volume that the plan removes [m³]: the bone of the planned cavity before the cut. For the target of an
  /// opening, the removed bone counts instead, inside and outside the cavity.
  [[nodiscard]] double PlannedVolume_m3() const { return under_m3 + removed_m3 - over_m3; }
  /// Share of the cartilage within the roof arcs that remains; nothing for a bone without cartilage there.
  std::optional<double> cartilage_left;
  /// Share of the rim that remains: bone up to 3 mm outside the planned cavity, at most 2 mm below the plane
  /// through the site's centre. Nothing if there was no such bone.
  std::optional<double> rim_preserved;
};

/// Largest radial gap between planned sphere and bone at which a direction still counts as covered.
inline constexpr double kCoverageGap_m = 0.5e-3;

/// The roof arcs bound the cartilage that matters: angles about the native hip's centre, measured from
/// straight up, in the medial, anterior and posterior direction. Between these directions the boundary is
/// elliptic; laterally it reaches the rim.
inline constexpr double kRoofMedial_deg = 46.0, kRoofAnterior_deg = 52.0, kRoofPosterior_deg = 62.0;

/// Whether a point lies within the roof arcs of a hip with this native centre.
[[nodiscard]] bool InRoofArcs(const PelvicFrame& pelvis, const Vector3& native_centre_m, const Vector3& p_m);

/// The balls of a state that a tool has cut: they are smaller than in the uncut bone, but not removed.
/// Children of split balls are left out, because a state does not record their uncut size.
[[nodiscard]] std::vector<simulation::Ball> CutBalls(const simulation::Bone& uncut,
                                                     const simulation::CarvedState& state);

/// Fits the sphere and sums the volumes of a carved bone.
/// @param uncut  the bone before the cut, as it was packed
[[nodiscard]] CavityResult AssessCavity(const SurgicalPlan& plan, const simulation::Bone& uncut,
                                        const simulation::CarvedState& state);

/// Distance from the plan within which DeviationMap looks for bone.
inline constexpr double kMapReach_m = 6e-3;

/// Returns the deviation [m] of the bone's surface from the plan along each direction, for a map. Positive:
/// the bone begins deeper than planned. A direction has no value if there is no bone within kMapReach_m of
/// the plan.
/// @param directions_G  unit vectors of rays from the planned centre
[[nodiscard]] std::vector<std::optional<double>> DeviationMap(const SurgicalPlan& plan,
                                                              std::span<const simulation::Ball> live_balls,
                                                              std::span<const Vector3> directions_G);

/// Returns unit vectors, evenly spread over the hemisphere around -axis.
[[nodiscard]] std::vector<Vector3> HemisphereDirections(const Vector3& axis, int count);

}  // namespace osteon::procedure
