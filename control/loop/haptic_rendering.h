#pragma once

#include "base/marker.h"
#include "control/coupling/coupling_pipeline.h"
#include "control/laws/admittance_renderer.h"
#include "control/laws/impedance_renderer.h"
#include "control/loop/arm_session.h"
#include "control/loop/commanded_tool.h"
#include "control/loop/motion_checks.h"
#include "control/loop/motion_supervisor.h"
#include "control/loop/safety_checks.h"
#include "control/loop/servo_statistics.h"
#include "control/loop/state_actions.h"
#include "control/loop/tick_input.h"
#include "control/loop/tick_result.h"
#include "control/sensing/hand_force.h"
#include "control/setup/servo_params.h"

namespace osteon::control {

/// Haptic rendering by the cell's law: begins rendering, computes its ticks with all checks, and brakes for a
/// pause.
///
///     CellReadings, ContactModel ─▶ hand, coupling ─▶ checks ─▶ law ─▶ CommandedTool, TickResult
class HapticRendering {
 public:
  /// The loop's parts that rendering changes. References must outlive this object.
  struct Parts {
    const ServoParams& params;
    MotionSupervisor& supervisor;
    ArmSession& session;
    CommandedTool& tool;
    HandForce& hand;
    CouplingPipeline& coupling;
    SafetyChecks& checks;
    ImpedanceRenderer& impedance;
    StateActions& actions;
    MotionChecks& motion_checks;
    ServoStatistics& statistics;
    TickResult& result;
  };
  explicit HapticRendering(const Parts& parts);

  /// Begins rendering at the arm's present pose. Coupling, law and checks begin in their initial state, at
  /// rest.
  void Start(const TickInputs& tick) OSTEON_RT;
  /// Computes one tick of rendering. A fault ends rendering, and the tick brakes instead.
  void Step(const TickInputs& tick) OSTEON_RT;
  /// One tick of braking in stop 2. A fault of devices, hand or engine that is found before the tool is at
  /// rest turns this stop into a stop 1.
  void BrakeForPause(const TickInputs& tick) OSTEON_RT;
  /// Call after a change of tool. Coupling and law begin anew at the new tool's pose.
  void OnToolChanged() OSTEON_RT;

  /// Actual speed of the spindle as of the last Step: measured if the cell has a drive, else the commanded
  /// speed. 0 if the spindle counts as still.
  [[nodiscard]] double spindle_rad_per_s() const OSTEON_RT { return spindle_rad_per_s_; }
  /// Speed that the spindle is to have in the cell's present state.
  [[nodiscard]] double SpindleCommand_rad_per_s() const OSTEON_RT;

  /// Writes the results of coupling, stabilisers and compliant parts into the tick's record.
  void FillRecord(TickRecord& record) const OSTEON_RT;

 private:
  /// The tool motion at which the coupling is evaluated: commanded (admittance) or measured (impedance).
  struct ToolMotion {
    const Pose& X_WT;
    Twist V_WT;
  };
  void UpdateSpindle(const CellReadings& readings) OSTEON_RT;
  Wrench EvaluateContact(const TickInputs& tick, const ToolMotion& motion) OSTEON_RT;
  void RenderAdmittance(const TickInputs& tick) OSTEON_RT;
  void RenderImpedance(const TickInputs& tick) OSTEON_RT;
  void Stop(const ArmState& state) OSTEON_RT;
  void StoreRendered(const safety::LimitedWrench& rendered, double speed_m_per_s) OSTEON_RT;
  void StepCompliance(const simulation::ContactModel& model) OSTEON_RT;
  /// Time between the tool poses at which the coupling was evaluated in this and in the previous tick. While
  /// messages are lost, a commanded tool stands still, but a measured tool moves.
  [[nodiscard]] double CouplingStep_s() const OSTEON_RT {
    return params_.law == Law::kImpedance ? session_.elapsed_s() : params_.period_s;
  }

  const ServoParams& params_;
  MotionSupervisor& supervisor_;
  ArmSession& session_;
  CommandedTool& tool_;
  HandForce& hand_;
  CouplingPipeline& coupling_;
  SafetyChecks& checks_;
  ImpedanceRenderer& impedance_;
  StateActions& actions_;
  MotionChecks& motion_checks_;
  ServoStatistics& statistics_;
  TickResult& result_;

  AdmittanceRenderer admittance_;
  bool spindle_permitted_{true};  ///< the PLC permits the spindle
  double spindle_rad_per_s_{0.0};
};

}  // namespace osteon::control
