#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "procedure/assessment/sphere_fit.h"
#include "procedure/plan/surgical_plan.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"

// The bone that a session left, compared with the plan. Every figure comes from the final carved state: its
// balls give the shape, its mass points the volume.

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
  std::string fit_refused;               ///< why there is no fit
  AnatomicShift from_plan, from_native;  ///< of the fitted centre; zero without a fit
  /// Share of the planned hemisphere that has bone within kCoverageGap_m of it, radially.
  double coverage{0.0};
  double removed_m3{0.0};
  double over_m3{0.0};   ///< removed outside the planned cavity, without the target of an opening
  double under_m3{0.0};  ///< left inside the planned cavity, without the target of an opening
  /// Volume that the plan takes away [m³]: the bone of the planned cavity before it was cut, and the target's
  /// bone that an opening removed outside it.
  [[nodiscard]] double PlannedVolume_m3() const { return under_m3 + removed_m3 - over_m3; }
  /// Share of the cartilage left within the roof arcs; nothing for a bone without cartilage there.
  std::optional<double> cartilage_left;
  /// Share of the bone left within 3 mm beside the plan, in the upper 2 mm; nothing where there was none.
  std::optional<double> rim_preserved;
};

/// Largest radial gap between planned sphere and bone that still counts as covered.
inline constexpr double kCoverageGap_m = 0.5e-3;

/// The roof arcs: angles from the highest point of the native hip up to which cartilage matters, medially,
/// anteriorly and posteriorly. They are elliptic between these directions, and reach the rim laterally.
inline constexpr double kRoofMedial_deg = 46.0, kRoofAnterior_deg = 52.0, kRoofPosterior_deg = 62.0;

/// Whether a place lies within the roof arcs of a hip with this native centre.
[[nodiscard]] bool InRoofArcs(const PelvicFrame& pelvis, const Vector3& native_centre_m, const Vector3& p_m);

/// The balls of a state that a tool has cut: smaller than in the uncut bone, but not gone. Children of split
/// balls are left out, because a state does not tell the uncut ones.
[[nodiscard]] std::vector<simulation::Ball> CutBalls(const simulation::Bone& uncut,
                                                     const simulation::CarvedState& state);

/// Fits the sphere and sums the volumes of a carved bone.
/// @param uncut  the bone of the state, as it was packed
[[nodiscard]] CavityResult AssessCavity(const SurgicalPlan& plan, const simulation::Bone& uncut,
                                        const simulation::CarvedState& state);

/// Distance from the plan within which DeviationMap looks for bone.
inline constexpr double kMapReach_m = 6e-3;

/// Returns the deviation [m] of the bone's surface from the plan along each direction, for a map. Positive:
/// the bone begins deeper than planned. Nothing where there is no bone within kMapReach_m of the plan.
/// @param directions_G  unit vectors of rays from the planned centre
[[nodiscard]] std::vector<std::optional<double>> DeviationMap(const SurgicalPlan& plan,
                                                              std::span<const simulation::Ball> live_balls,
                                                              std::span<const Vector3> directions_G);

/// Returns directions over the hemisphere around -axis, each for the same area.
[[nodiscard]] std::vector<Vector3> HemisphereDirections(const Vector3& axis, int count);

}  // namespace osteon::procedure
