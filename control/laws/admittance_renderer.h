#pragma once

#include "base/marker.h"
#include "control/coupling/coupling_pipeline.h"
#include "control/laws/axis_lock.h"
#include "control/loop/commanded_tool.h"
#include "control/setup/servo_params.h"
#include "control/stability/vibration_index.h"
#include "control/tick_record.h"
#include "safety/acting_limits.h"
#include "safety/fault.h"

namespace osteon::control {

/// Inputs of a tick of the admittance law, beside the coupling that the pipeline has evaluated.
struct AdmittanceInput {
  Wrench F_hand_T_W;              ///< on T at To, in W
  double sensor_share{1.0};       ///< of it that its age lets through, 0 … 1
  double max_hand_N{0.0};         ///< beyond it a reading counts as this much
  double spindle_rad_per_s{0.0};  ///< what it does
  bool reduced_speed{false};      ///< the arm is in T1, or does not say
};

/// A tick of the admittance law.
struct AdmittanceStep {
  bool finite{true};                          ///< false: nothing was moved
  safety::Fault fault{safety::Fault::kNone};  ///< of the joints: nothing was moved
  safety::LimitedWrench rendered;             ///< what was integrated
  safety::LimitSet acting;
};

/// The admittance law of an arm in position mode:
///
///     M a + D v = F_hand + F_coupling    M, D by the vibration index and the stabilisers
///     → power limit → tool speed, bone entry, workspace, locked axes → differential inverse → command
///
/// The age of the contact model slows the motion down: with s the coupling's fade, the hand's force counts s
/// F, the coupling s F_c (in EvaluateCoupling), the tool moves by s v dt. At s = 0 the tool is held, whoever
/// pushes, and no energy can be made of a force that is not known.
class AdmittanceRenderer {
 public:
  /// @param params  of the loop, whose gains may change between ticks; must outlive this
  explicit AdmittanceRenderer(const ServoParams& params);

  /// The tool takes up rendering at this pose.
  void Reset(const Pose& X_WT) OSTEON_RT;

  /// One tick, after CouplingPipeline::Evaluate at the commanded pose and velocity: moves the tool.
  /// @param[in,out] record  gets what the law and the coupling did
  [[nodiscard]] AdmittanceStep Step(const AdmittanceInput& input, CouplingPipeline& coupling,
                                    CommandedTool& tool, TickRecord& record) OSTEON_RT;

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
  double mass_factor_{1.0};  // of the virtual tool, in the last tick
  double sight_age_s_{0.0};  // the models' greatest age of late
};

}  // namespace osteon::control
