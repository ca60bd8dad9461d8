#pragma once

#include <algorithm>
#include <functional>

#include "control/loop/servo_loop.h"
#include "hil/operator/operator_hand.h"
#include "kinematics/spatial.h"
#include "safety/fault.h"
#include "simulation/contact/contact_model.h"
#include "simulation/engine/cutting_engine.h"

// Test bench of the compliance scenarios: the shipped servo loop moves a simulated arm, and a scene supplies
// the hand's wrench and the bone's contact.

namespace osteon::studies {

/// A run of the shipped servo loop on compliant bone with one of the two laws. The admittance law moves an
/// arm that follows positions (hil/arm/servo_arm.h). The impedance law acts through a wrench overlay on an
/// arm with masses (hil/arm/dynamic_arm.h). Laws, limits, depth limit and compliance are the loop's own.
struct LawTrialParams {
  /// Law and gains, compliance, depth limit, spindle. The bench itself sets the arm's limits and a wide
  /// workspace.
  control::ServoParams loop{};
  double seconds{1.0};  ///< > 0
};

/// The state after one millisecond.
struct LawTrialTick {
  Pose X_WT{Pose::Identity()};  ///< the tool's true pose
  /// Pose of the tool's head in the world that moves with the bone, as the simulation gets it.
  Pose X_ME{Pose::Identity()};
  Pose X_WT_sim{Pose::Identity()};  ///< pose of the rigid tool to which that head belongs
  Vector3 f_coupling_N{Vector3::Zero()};
  bool renders{false};
};

/// The arm's surroundings, evaluated once a millisecond; ticks count from 0.
struct LawScene {
  /// Wrench of a hand, or of a guide, on the tool at the tool's origin, in W, for the tool's true motion in
  /// W.
  std::function<Wrench(int tick, const Pose& X_WT, const Twist& V_WT)> hand;
  /// The newest frame, for the command of the previous tick. The bench sets the frame's stamp.
  std::function<simulation::ContactModel(const simulation::ToolCommand& command)> bone;
  /// Called after each tick; may be empty. Returns false to end the run.
  std::function<bool(int tick, const LawTrialTick& state)> seen{};
};

/// Returns the gains with which the shipped cells render bone of `stiffness_N_per_m` under a law, without
/// compliance.
[[nodiscard]] control::ServoParams LoopOfLaw(control::Law law, double stiffness_N_per_m);

/// The pose of the tool at which every run begins, at rest.
[[nodiscard]] Pose StartOfLawTrial();
/// The bone's frame G at StartOfLawTrial: its origin is the tool's apex, +z points against the feed, x along
/// the tool's x.
[[nodiscard]] Pose BoneOfLawTrial();

/// A push that rises from zero to its full force.
[[nodiscard]] inline double RisingPush(double full_N, double time_s, double rise_s) {
  return full_N * std::min(1.0, time_s / rise_s);
}

/// A stiff hand (3 N/mm) that leads the tool down from the start: it holds the tool across the feed and
/// against rotation, and pushes along the feed.
class PushingHand {
 public:
  PushingHand();
  /// Steps by a millisecond and returns the hand's wrench for the tool's true motion.
  /// @param push_N  along the feed
  [[nodiscard]] Wrench Step(double push_N, const Pose& X_WT, const Twist& V_WT);

 private:
  hil::HandImpedance hand_;
  Pose X_start_;
};

/// Simulates the run. Deterministic. @returns the faults that the loop has latched
[[nodiscard]] safety::FaultSet RunLawTrial(const LawTrialParams& params, const LawScene& scene);

}  // namespace osteon::studies
