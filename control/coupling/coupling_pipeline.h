#pragma once

#include <optional>

#include "base/marker.h"
#include "control/arm/arm_follower.h"
#include "control/compliance/compliance.h"
#include "control/coupling/virtual_coupling.h"
#include "control/guidance/guidance.h"
#include "control/setup/servo_params.h"
#include "control/stability/stabilisers.h"
#include "control/tick_record.h"
#include "safety/acting_limits.h"
#include "safety/depth_limit.h"
#include "safety/force_limit_reaction.h"
#include "safety/limits.h"
#include "safety/stored_energy_limit.h"
#include "simulation/contact/contact_model.h"

namespace osteon::control {

/// Computes, from the contact model, the wrench that a law renders. Both laws use it:
///
///     contact model → virtual coupling → age governor, energy tank → stored energy, force, torque, arm
///                   → passivity damping → depth limit → guidance → power
///
/// Call Evaluate, Render, LimitPower and StepCompliance in this order, each at most once per tick. All
/// wrenches that they return are within the cell's limits of force and torque.
///
/// If the cell is compliant (control/compliance), coupling and stabilisers get the pose and velocity of the
/// bent head in the bone's frame, and their wrench is converted to a wrench on T.
class CouplingPipeline {
 public:
  /// @param params  the loop's parameters; gains in them may change between ticks (OnGainsChanged). Must
  /// outlive this object.
  /// @throws std::invalid_argument naming the parameter, the value and what is accepted.
  explicit CouplingPipeline(const ServoParams& params);

  /// Returns to the state without contact. Call when rendering begins.
  void Reset() OSTEON_RT;
  /// Call when gains in the loop's parameters have changed.
  void OnGainsChanged() OSTEON_RT;

  /// Evaluates the coupling of this tick. Limits its wrench by the energy that the spring may store, by the
  /// cell's limits of force and torque, and by what the arm can hold.
  /// @param[in,out] acting  the limits that act are added
  const CouplingOutput& Evaluate(const CouplingInput& input, const ArmFollower& arm,
                                 safety::LimitSet& acting) OSTEON_RT;
  /// The limited wrench of the last Evaluate, without the passivity controller's damping.
  [[nodiscard]] const safety::LimitedWrench& limited() const OSTEON_RT { return limited_; }
  [[nodiscard]] const CouplingOutput& output() const OSTEON_RT { return output_; }

  /// Replaces the guidance at a change of tool. The new guidance begins with energy and share zero, and keeps
  /// the present gain. Does not allocate.
  void SetGuidance(const std::optional<Guidance>& guidance) OSTEON_RT {
    const std::optional<Guidance> before = guidance_;
    guidance_ = guidance;
    if (before) SetGuidanceGain(before->params().gain);
  }
  /// Sets the guidance's gain, 0 … 1; no effect without guidance.
  void SetGuidanceGain(double gain) OSTEON_RT {
    if (guidance_) guidance_->SetGain(gain);
  }

  /// Returns the wrench to render: the limited wrench of the last Evaluate plus the passivity controller's
  /// damping, the depth limit's resistance and the guidance. The sum is within the same limits. The guidance
  /// is added last and gets only the force and torque that the other parts leave.
  [[nodiscard]] safety::LimitedWrench Render(const ArmFollower& arm, safety::LimitSet& acting) OSTEON_RT;
  /// Multiplies a rendered wrench by `power_scale`, 0 … 1, if that is less than 1.
  void LimitPower(double power_scale, safety::LimitedWrench& rendered, safety::LimitSet& acting) OSTEON_RT;

  /// Call if only this share, 0 … 1, of the wrench reached the arm.
  void OnWrenchScaled(double share) OSTEON_RT {
    passed_scale_ *= share;
    if (guidance_ && share < 1.0) guidance_->ScaleRendered(share);
  }

  /// Advances the compliant parts by one tick, using the planes' part of the rendered wrench.
  /// @param model  as given to Evaluate
  void StepCompliance(const simulation::ContactModel& model, safety::LimitSet& acting) OSTEON_RT;
  /// The cell's compliance; null if the cell is rigid.
  [[nodiscard]] const Compliance* compliance() const OSTEON_RT {
    return compliance_ ? &*compliance_ : nullptr;
  }
  /// Replaces the parameters of the tool's bending, at a change of tool; no effect if the cell's tool is
  /// rigid.
  void SetBending(const std::optional<ToolLinkParams>& tool) OSTEON_RT {
    if (compliance_ && params_.compliance.tool) compliance_->SetTool(tool);
  }
  /// Whether the head is more than 1 mm beyond the depth bound, for a bound that moves with the bone. A bound
  /// at rest is checked as a zone of the workspace instead.
  [[nodiscard]] bool beyond_depth() const OSTEON_RT;

  /// Adds to `acting` the limits that acted on a rendered wrench, according to its shares and to the
  /// stabilisers.
  void AddActing(const safety::LimitedWrench& rendered, safety::LimitSet& acting) const OSTEON_RT;

  [[nodiscard]] const safety::WrenchLimiter& limiter() const OSTEON_RT { return limiter_; }
  [[nodiscard]] const Stabilisers& stabilisers() const OSTEON_RT { return stabilisers_; }
  [[nodiscard]] const safety::DepthLimit& depth_limit() const OSTEON_RT { return depth_limit_; }
  [[nodiscard]] const std::optional<Guidance>& guidance() const OSTEON_RT { return guidance_; }
  /// Whether the guidance's force has grown faster than its springs allow, which only a defect can cause.
  [[nodiscard]] bool guidance_trips() const OSTEON_RT { return guidance_ && guidance_->trips(); }
  /// Whether depth limit or guidance requires the spindle to stand still.
  [[nodiscard]] bool stops_spindle() const OSTEON_RT {
    return depth_limit_.stops_spindle() || (guidance_ && guidance_->stops_spindle());
  }
  [[nodiscard]] const safety::ForceLimitReaction& force_limit_reaction() const OSTEON_RT {
    return force_limit_reaction_;
  }
  /// Whether a plane was penetrated in the last Evaluate.
  [[nodiscard]] bool pressed() const OSTEON_RT { return pressed_; }

 private:
  void AddGuidance(const ArmFollower& arm, Wrench& F_T_W) OSTEON_RT;
  [[nodiscard]] Wrench OnTool(const Wrench& F_E_M) const OSTEON_RT;
  [[nodiscard]] Wrench RenderedByPlanes() const OSTEON_RT;

  const ServoParams& params_;
  safety::WrenchLimiter limiter_;
  safety::StoredEnergyLimit stored_energy_limit_;
  safety::DepthLimit depth_limit_;
  safety::ForceLimitReaction force_limit_reaction_;
  Stabilisers stabilisers_;
  std::optional<Guidance> guidance_;
  std::optional<Compliance> compliance_;
  CouplingState state_;

  // values of the last Evaluate
  Pose X_WT_{Pose::Identity()};
  Twist V_WT_;
  Pose X_ME_{Pose::Identity()};  // the head in the bone's frame; equals X_WT_ in a rigid cell
  Twist V_ME_;
  CouplingOutput output_;
  safety::LimitedWrench limited_;    // wrench on T at To, in W
  safety::LimitedWrench limited_E_;  // on the head, in M; equals limited_ in a rigid cell
  double passed_scale_{1.0};         // share of Render's wrench that the later limits left
  bool pressed_{false};
};

}  // namespace osteon::control
