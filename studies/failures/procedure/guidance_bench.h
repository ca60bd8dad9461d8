#pragma once

#include <cstddef>
#include <vector>

#include "control/guidance/guidance.h"
#include "control/laws/admittance_law.h"
#include "hil/arm/servo_arm.h"
#include "hil/operator/hand_grid.h"
#include "safety/limits.h"

// Test bench of the guidance scenarios: a hand leads the handle of an arm along a surgical plan. Except for
// the hand, all parts are the shipped ones. The bench's arm has no joints: its lag and dead time act on
// position and rotation.

namespace osteon::studies {

/// The method that renders the guidance: ours, or one of two baselines.
enum class GuidanceMethod {
  kOurs,
  kMeasuredPose,  ///< the same springs, evaluated at the measured pose; scaled as with kAtOnce
  /// Springs at the commanded pose; only the limits scale them, at once and without regard to energy.
  kAtOnce,
};

/// The plan of all scenarios: straight down, the head's centre at the world's origin.
[[nodiscard]] control::GuidanceParams ScenarioGuidance();

/// Plan, method and hand of the bench.
struct GuidanceBenchParams {
  control::GuidanceParams guidance{ScenarioGuidance()};
  GuidanceMethod method{GuidanceMethod::kOurs};
  hil::GridHand hand{"firm", 500.0, 20.0, 1.5};
  double lever_m{0.1};  ///< height of the hand above the tool's apex
};

/// The goal to which a hand leads the tool, and a force that the hand adds.
struct HandOffset {
  /// Goal of the hand, relative to its place when the tool is on the plan's axis [m].
  Vector3 p_W{0.0, 0.0, 0.0};
  Vector3 push_W{0.0, 0.0, 0.0};  ///< added force [N]
  bool holds{true};               ///< false: the hand has let go
};

/// State of a tick.
struct GuidanceTick {
  Wrench F_guidance_T_W;          ///< wrench that the guidance rendered
  double hand_N{0.0};             ///< size of the hand's force on the handle
  Vector3 hand_W{0.0, 0.0, 0.0};  ///< the same force as a vector [N]
  double speed_m_per_s{0.0};      ///< speed of the commanded apex
  double excess_m{0.0};           ///< distance of the tool beyond the funnel
};

/// Hand, virtual tool, guidance and arm, simulated together.
class GuidanceBench {
 public:
  static constexpr double kPeriod_s = 1e-3;

  /// Starts with the tool at rest on the axis, the head's centre 5 mm above its planned place, and the
  /// guidance on.
  explicit GuidanceBench(const GuidanceBenchParams& params);

  /// Advances by a tick. @param F_bone_T_W  the bone's wrench on the tool; the force limit applies to the sum
  /// of this wrench and the guidance's
  GuidanceTick Step(const HandOffset& goal, const Wrench& F_bone_T_W = {});

  /// Energy that the guidance has given to the virtual tool so far; negative: energy taken from it.
  [[nodiscard]] double energy_J() const { return energy_J_; }
  /// Moves the tool away from the axis, to rest there, and switches the guidance on.
  void SwitchOnAside(double aside_m);

 private:
  [[nodiscard]] Pose Measured() const;
  void StartAt(const Vector3& apex_W);
  Wrench Render(const Wrench& bone, Wrench& guidance);

  GuidanceBenchParams params_;
  control::Guidance guidance_;
  safety::WrenchLimiter limiter_{{}};
  control::AdmittanceParams law_;
  control::AdmittanceState tool_;
  hil::ServoArm arm_;
  Matrix3 R_start_;
  Wrench felt_;             // the hand's wrench on the tool, as the sensor reads it
  Wrench guidance_before_;  // rendered in the last tick
  Twist moved_, V_meas_;    // motion of the commanded tool in the last tick; the arm's measured velocity
  double energy_J_{0.0};
};

}  // namespace osteon::studies
