#pragma once

#include "base/marker.h"
#include "control/coupling/coupling_pipeline.h"
#include "control/laws/axis_lock.h"
#include "control/loop/commanded_tool.h"
#include "control/setup/servo_params.h"
#include "control/stability/vibration_index.h"
#include "safety/acting_limits.h"
#include "safety/fault.h"

namespace osteon::control {

/// Inputs of the admittance law in a tick. The coupling's wrench comes from CouplingPipeline.
struct AdmittanceInput {
  Wrench F_hand_T_W;              ///< hand's wrench on T at To, in W
  double sensor_fade{1.0};        ///< factor on the hand's wrench by its age, 0 … 1
  double max_hand_N{0.0};         ///< a larger force of the hand is scaled down to this
  double spindle_rad_per_s{0.0};  ///< actual speed of the spindle
  bool reduced_speed{false};      ///< the arm is in operation mode T1 or reports no mode
};

/// Vibration in the hand's wrench, and how it changes the virtual tool.
struct VibrationRecord {
  double index{0.0};  ///< 0 … 1
  /// RMS force up to which vibration is regarded as the hand's own tremor.
  double reference_N{0.0};
  double mass_factor{1.0}, damping_factor{1.0};  ///< factors on the virtual tool's inertia and drag
};

/// Result of a tick of the admittance law.
struct AdmittanceStep {
  bool finite{true};                          ///< false: the result was not finite, and nothing was moved
  safety::Fault fault{safety::Fault::kNone};  ///< set if the joints could not follow; nothing was moved then
  safety::LimitedWrench rendered;             ///< coupling wrench that was integrated
  safety::LimitSet acting;                    ///< limits that acted
  VibrationRecord vibration;
};

/// Renders by the admittance law, for an arm in position mode:
///
///     M a + D v = F_hand + F_coupling    M, D scaled by the vibration index and the stabilisers
///     → power limit → tool speed, bone entry, workspace, locked axes → differential inverse → command
///
/// An old contact model slows the motion down. Let s be the coupling's fade by age. The law gets s F of the
/// hand's force F and s F_c of the coupling's force F_c (EvaluateCoupling), and the tool moves by s v dt. At
/// s = 0 the tool does not move, however hard the hand pushes, so that an unknown contact force cannot create
/// energy.
class AdmittanceRenderer {
 public:
  /// @param params  the loop's parameters; gains in them may change between ticks. Must outlive this object.
  explicit AdmittanceRenderer(const ServoParams& params);

  /// Call when rendering begins, with the tool's pose.
  void Reset(const Pose& X_WT) OSTEON_RT;

  /// Computes one tick and moves the tool. Call after CouplingPipeline::Evaluate at the commanded pose and
  /// velocity.
  [[nodiscard]] AdmittanceStep Step(const AdmittanceInput& input, CouplingPipeline& coupling,
                                    CommandedTool& tool) OSTEON_RT;

 private:
  [[nodiscard]] bool ComputeTwist(const AdmittanceInput& input, const CommandedTool& tool,
                                  CouplingPipeline& coupling, AdmittanceStep& step,
                                  Twist& V_next_WT) OSTEON_RT;
  [[nodiscard]] double MaxSpeed_m_per_s(const CouplingOutput& coupling, const Twist& V_WT,
                                        bool reduced_speed) OSTEON_RT;
  [[nodiscard]] Twist LimitMotion(const Twist& V_next_WT, double max_speed_m_per_s,
                                  const CouplingPipeline& coupling, const CommandedTool& tool,
                                  safety::LimitSet& acting) const OSTEON_RT;

  const ServoParams& params_;
  VibrationIndex vibration_;
  AxisLock axis_lock_;
  double mass_factor_{1.0};  // factor on the virtual tool's mass in the last tick
  double sight_age_s_{0.0};  // peak of the contact model's age, which decays slowly (MaxSpeed_m_per_s)
};

}  // namespace osteon::control
