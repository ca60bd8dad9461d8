#pragma once

#include <string>
#include <vector>

#include "control/guidance/guidance_field.h"
#include "hil/arm/servo_arm.h"
#include "hil/loops/linear_loop.h"
#include "hil/loops/loop_arm.h"
#include "hil/operator/hand_grid.h"

// The planar loop of guidance: a hand holds the handle of an admittance-controlled arm above the tool's apex,
// and the guidance's funnel and cone act on the commanded pose, laterally and on its tilt.
//
//     hand at its lever ── arm: w, z, dead time ◀── x_c, tilt_c ◀── virtual tool m, b, J, d ◀── guidance
//      └─────── felt force and torque, sensor_delay samples late ──────────▶ F, t

namespace osteon::studies {

/// Pose from which the guidance is computed.
enum class GuidanceOn { kCommanded, kMeasured };

/// Parameters of the loop. The defaults are those of the loop in docs/theory/guidance.md.
struct GuidedLoopParams {
  hil::GridHand hand{"firm", 500.0, 20.0, 1.5};
  double lever_m{0.1};                          ///< height of the hand above the apex
  double mass_kg{1.7}, damping_Ns_per_m{30.0};  ///< mass and damping of the virtual tool
  /// Inertia and damping of the virtual tool's rotation, about the law's centre.
  double inertia_kg_m2{0.15}, damping_Nms_per_rad{1.5};
  double centre_m{0.0};  ///< height of the law's centre above the apex
  hil::ServoArmParams arm;
  int sensor_delay{1};  ///< [ticks]
  double period_s{0.001};
  control::GuidanceParams guidance;  ///< its stiffnesses may exceed what Validate accepts
  GuidanceOn on{GuidanceOn::kCommanded};
};

/// The loop as a linear system, for a tool in the linear part of funnel and cone. The guidance's damping is
/// left out, since it is bounded by a share of the force. The guidance's stiffness is the slope of the
/// shipped EvaluateGuidance; law and arm are the shipped StepAdmittance and ServoArm.
class GuidedLoop {
 public:
  explicit GuidedLoop(const GuidedLoopParams& params);

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] Eigen::VectorXd Step(const Eigen::VectorXd& state) const;
  [[nodiscard]] double SpectralRadius() const;
  /// Whether no motion grows. A motion without a restoring force, such as a turn about the hand, may persist.
  [[nodiscard]] bool IsStable() const { return SpectralRadius() < 1.0 + 1e-7; }
  /// Negative derivative of the guidance's (lateral force, torque) with respect to (lateral displacement,
  /// tilt): positive for a spring.
  [[nodiscard]] const Eigen::Matrix2d& stiffness() const { return stiffness_; }

 private:
  GuidedLoopParams params_;
  hil::LoopArm linear_arm_;
  Eigen::Matrix2d stiffness_;
  int history_, size_;  // number of stored commands for each coordinate; size of the state
};

/// Distances at which a hand may hold the tool above its apex [m].
[[nodiscard]] std::vector<double> GuidanceLevers_m();

/// A hand, and the distance above the apex at which it holds the tool.
struct HeldHand {
  hil::GridHand hand;
  double lever_m{0.0};
};

/// The hands of the grid except fixture and clamp, each at every lever.
[[nodiscard]] std::vector<HeldHand> GuidanceHands();
/// Those of GuidanceHands with which the loop is stable without guidance.
[[nodiscard]] std::vector<HeldHand> HandsStableWithoutGuidance(GuidedLoopParams params);

/// Returns the indices of those of `hands` with which the guidance makes the loop unstable. It tries the
/// stiffnesses of an n × n grid, from 0 to the lateral and cone stiffness of params.guidance.
[[nodiscard]] std::vector<std::size_t> HandsThatGuidanceMakesUnstable(GuidedLoopParams params,
                                                                      const std::vector<HeldHand>& hands,
                                                                      int n = 5);

/// Finds the smallest factor on both stiffnesses with which the guidance makes the loop unstable with one of
/// the hands. Scans from 0.1 up to `max_factor`; 0: already unstable at 0.1.
[[nodiscard]] hil::Boundary GuidanceBoundary(GuidedLoopParams params, const std::vector<HeldHand>& hands,
                                             double max_factor = 4.0);

}  // namespace osteon::studies
