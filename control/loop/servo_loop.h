#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/marker.h"
#include "control/arm/arm_follower.h"
#include "control/coupling/coupling_pipeline.h"
#include "control/laws/impedance_renderer.h"
#include "control/loop/arm_session.h"
#include "control/loop/commanded_tool.h"
#include "control/loop/gain_requests.h"
#include "control/loop/haptic_rendering.h"
#include "control/loop/loop_requests.h"
#include "control/loop/motion_checks.h"
#include "control/loop/motion_start.h"
#include "control/loop/motion_supervisor.h"
#include "control/loop/safety_checks.h"
#include "control/loop/servo_statistics.h"
#include "control/loop/start_conditions.h"
#include "control/loop/state_actions.h"
#include "control/loop/tick_input.h"
#include "control/loop/tick_result.h"
#include "control/loop/tool_table.h"
#include "control/ports.h"
#include "control/sensing/hand_force.h"
#include "control/setup/loop_tool.h"
#include "control/setup/servo_params.h"
#include "control/tick_record.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "simulation/contact/contact_model.h"
#include "simulation/engine/cutting_engine.h"

namespace osteon::control {

/// The servo loop. Each tick answers one message of the arm: an LBR sends one per millisecond, a KR one every
/// 4 or 12 ms. The loop uses no socket and no clock. It calls its parts in order and assembles the tick's
/// record from their outputs:
///
///     ArmState ─▶ ArmSession ─▶ MotionSupervisor ─▶ HapticRendering | MotionStart | StateActions
///     HapticRendering | MotionStart | StateActions ─▶ CommandedTool ─▶ ArmCommand
///     CellReadings ─▶ HandForce ─▶ SafetyChecks ─▶ MotionChecks | HapticRendering ─▶ MotionSupervisor
///     ContactModel ─▶ CouplingPipeline ─▶ AdmittanceRenderer | ImpedanceRenderer, both in HapticRendering
///
/// **State.** safety::CellState decides what the loop does. One table changes it (safety/cell_state.h,
/// docs/states.md), and the recorded Phase follows from it. Each tick derives events from its inputs, most
/// severe first, and applies them (StateActions::ApplyEvent).
///
/// - off, checking, ready and recovery: the command follows the arm's own position. Motion begins only once
///   every condition of safety::MotionPermits holds in one tick. The virtual tool then starts from the
///   commanded joints, at rest and with the coupling faded out, so that nothing jumps. If the arm stayed in
///   the same activation during a pause or a loss of messages, the last command is held instead, because the
///   arm's interpolator still reports the position at which the activation began.
/// - aligning: the arm was not handed over at ServoParams::start, and moves there along a joint path. The
///   path is paused while motion is not permitted. If the arm leaves COMMANDING_ACTIVE, the loop waits for it
///   again. Once the loop has rendered, it does not move the arm to the start again.
/// - haptic and cutting: the loop renders, with the spindle still or turning (HapticRendering).
/// - stop 1 and stop 2: the motion of the previous state is braked (CommandedTool::Brake,
///   ImpedanceRenderer::Brake). Nothing is rendered, and the spindle is stopped. On the path to the start,
///   the path's clock is braked instead.
/// - stop 0: the arm takes no commands. The state ends once the arm, by measurement, stands still.
/// - paused and fault: the command is held; if the arm leaves COMMANDING_ACTIVE, the command follows it. Only
///   RequestResume(), a recovery or a new loop ends these states. Under the impedance law, a hand may
///   displace a paused arm. This is no fault, but the loop cannot resume while the arm is displaced.
///
/// **Checks** (SafetyChecks, run by MotionChecks and HapticRendering). The sensor's bias is estimated before
/// the first motion, while the tool rests. Hand and sensor are checked whenever the arm moves or brakes. The
/// spindle is also checked on the path to the start and while rendering.
///
/// **Motion.** After limiting, the virtual tool's state is set to the commanded motion, so the integrated
/// pose never drifts from the commanded one. The joints follow the tool's twist (DifferentialInverse), and
/// the commanded pose is that of the joints. At the end of the reach, at a singular posture or at a joint
/// limit, the tool therefore slides or slows down; none of these is a fault. The closed-form inverse
/// kinematics guides the elbow: it keeps the arm angle while the tool moves, and turns it to the wanted
/// angle. Once the wanted angle has been reached, the elbow moves only while the tool moves.
class ServoLoop {
 public:
  /// @param X_WB robot base in world  @param X_FT tool on the flange  @param arm_angle_rad arm angle to be
  /// kept in the run
  /// @throws std::invalid_argument naming the parameter, the value and what is accepted.
  ServoLoop(const ServoParams& params, const kinematics::LbrArm& arm, const Pose& X_WB, const Pose& X_FT,
            double arm_angle_rad);
  /// A loop for a six-axis arm, which has no redundant joint, and whose torques are unknown.
  ServoLoop(const ServoParams& params, const kinematics::OrthoParallelArm& arm, const Pose& X_WB,
            const Pose& X_FT);
  ServoLoop(const ServoLoop&) = delete;
  ServoLoop& operator=(const ServoLoop&) = delete;

  /// Gives the loop a table of tools, and selects the one at `index`. Call before the first tick. Without
  /// this call, the loop has only the tool of its constructor.
  /// @throws std::invalid_argument naming the entry and what is wrong with it.
  void SetTools(std::vector<LoopTool> tools, int index);

  /// Computes one tick. Without a message of the arm the last command is held.
  /// @param[out] command answer to the arm; always finite after the first message with finite joints
  /// @returns the tick's record
  TickRecord Tick(const TickInputs& tick, ArmCommand& command) OSTEON_RT;

  /// Allows or forbids that a waiting arm begins to move. Allowed by default; forbidden e.g. while the path
  /// to the start is being checked. From any thread.
  void AllowStart(bool allowed) OSTEON_RT { requests_.AllowStart(allowed); }

  /// Requests an orderly stop. From any thread, and from a signal handler.
  void RequestStop() OSTEON_RT { requests_.RequestStop(); }

  /// Requests a recovery after a stop that only the connection to the arm has caused (Fault::kSession,
  /// kArmStale). The loop then waits for the arm, and renders from the arm's present position. No effect
  /// after other stops. From any thread.
  void RequestRecovery() OSTEON_RT { requests_.RequestRecovery(); }
  /// Requests an operator's pause: brakes to rest (stop 2) and holds, until RequestResume(). From any thread,
  /// and from a signal handler.
  void RequestPause() OSTEON_RT { requests_.RequestPause(); }
  /// Requests the end of a pause: once every condition of motion holds, the loop continues from the tool's
  /// present pose. No effect if the cell is not paused. From any thread, and from a signal handler.
  void RequestResume() OSTEON_RT { requests_.RequestResume(); }
  /// Requests another gain of the guidance, 0 … 1, from the next tick on; a value outside is clamped, one
  /// that is not a number is ignored. No effect without guidance. From any thread, and from a signal handler.
  void RequestGuidanceGain(double gain) OSTEON_RT { requests_.RequestGuidanceGain(gain); }
  /// Requests another tool of the table. The next tick selects it if the loop is paused and has rendered
  /// before. The joints stay unchanged; coupling and law begin anew. In any other state, or with an unknown
  /// index, the request has no effect. From any thread.
  void RequestTool(int index) OSTEON_RT { requests_.RequestTool(index); }
  /// Index of the tool in use.
  [[nodiscard]] int tool_index() const OSTEON_RT { return tools_.index(); }
  /// Whether RequestRecovery would have an effect now.
  [[nodiscard]] bool CanRecover() const OSTEON_RT { return supervisor_.CanRecover(); }

  /// Reports that a repeated tick gave another result (LoopRepeat): the next tick latches
  /// Fault::kRepeatDiffers. From the tick's thread.
  void ReportDifference() OSTEON_RT { requests_.ReportDifference(); }

  /// Reports that the recorder stalls or refuses ticks: the next tick latches Fault::kRecorder. From the
  /// tick's thread.
  void ReportRecorder() OSTEON_RT { requests_.ReportRecorder(); }

  /// Loads this loop's data into the processor's cache for the next tick. From the tick's thread.
  void Prefetch() const OSTEON_RT;

  /// Requests other gains. They are reached within GainRamp::kRampSeconds from the next tick on, without
  /// creating energy. If no tick has taken the previous request yet, the new one replaces it. Call from one
  /// thread only, not from the tick's.
  /// @throws std::invalid_argument naming the field, the value and what is accepted. The coupling's stiffness
  ///   may not exceed the value at construction, because trips and simulation are set up for that value.
  void RequestGains(const Gains& gains);

  /// The tool pose for the simulation: with the admittance law the commanded pose of the last tick, with the
  /// impedance law the measured pose, with the time of the tick that got its message. Until the arm has
  /// reported its position, the stamp is 0 and the pose is invalid.
  [[nodiscard]] simulation::ToolCommand tool_command() const OSTEON_RT;

  /// Commands to the cell's devices.
  [[nodiscard]] CellCommands cell_commands() const OSTEON_RT;

  [[nodiscard]] safety::CellState state() const OSTEON_RT { return supervisor_.state(); }
  /// The conditions of motion, as evaluated last. They are evaluated while the loop waits, is paused, or is
  /// on the path to the start.
  [[nodiscard]] safety::MotionPermits permits() const OSTEON_RT { return supervisor_.permits(); }
  /// Phase of the run in the recording; follows from the state.
  [[nodiscard]] Phase phase() const OSTEON_RT { return supervisor_.phase(); }
  [[nodiscard]] safety::FaultSet faults() const OSTEON_RT { return supervisor_.faults(); }
  [[nodiscard]] const ServoStatistics& statistics() const OSTEON_RT { return statistics_; }
  [[nodiscard]] double max_force_N() const OSTEON_RT { return coupling_.limiter().max_force_N(); }

 private:
  ServoLoop(const ServoParams& params, std::unique_ptr<ArmFollower> arm, const Pose& X_FT);

  // steps of a tick, in order
  [[nodiscard]] TickRecord RecordInputs(const TickInputs& tick) OSTEON_RT;
  void ApplyToolRequest(TickInput& input) OSTEON_RT;
  void StepGains(TickInput& input) OSTEON_RT;
  void ApplyRequests(const TickInput& input) OSTEON_RT;
  void OnMissedMessage(ReceiveResult received) OSTEON_RT;
  void ProcessArmMessage(const TickInputs& tick) OSTEON_RT;
  void FillCommand(const ArmState& state, ArmCommand& command) const OSTEON_RT;
  void FinishRecord(const ArmCommand& command, TickRecord& record) const OSTEON_RT;

  // the loop's parts refer to these, so a change by StepGains takes effect in all of them
  ServoParams params_;
  LoopRequests requests_;
  MotionSupervisor supervisor_;
  ArmSession session_;
  CommandedTool tool_;
  HandForce hand_;
  CouplingPipeline coupling_;
  SafetyChecks checks_;
  ImpedanceRenderer impedance_;
  ServoStatistics statistics_;
  ToolTable tools_;
  GainRequests gains_;
  TickResult result_;  ///< results of this tick
  StateActions actions_;
  MotionStart start_;
  MotionChecks motion_checks_;
  HapticRendering rendering_;

  std::uint64_t tick_{0};
  rt::Nanoseconds now_{0};
  /// Time of the last tick in which motion was not requested of the PLC.
  rt::Nanoseconds withdrawn_at_{StartConditions::kNeverWithdrawn};
};

}  // namespace osteon::control
