#pragma once

#include <cstdint>
#include <memory>

#include "base/latest_value.h"
#include "base/marker.h"
#include "control/arm/arm_follower.h"
#include "control/coupling/coupling_pipeline.h"
#include "control/laws/admittance_renderer.h"
#include "control/laws/gain_ramp.h"
#include "control/laws/impedance_renderer.h"
#include "control/loop/arm_session.h"
#include "control/loop/commanded_tool.h"
#include "control/loop/loop_requests.h"
#include "control/loop/motion_supervisor.h"
#include "control/loop/safety_checks.h"
#include "control/loop/servo_statistics.h"
#include "control/loop/start_conditions.h"
#include "control/ports.h"
#include "control/sensing/hand_force.h"
#include "control/setup/servo_params.h"
#include "control/tick_record.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "simulation/contact/contact_model.h"
#include "simulation/engine/cutting_engine.h"

namespace osteon::control {

/// The servo loop: one arm message a tick, an LBR each millisecond, a KR each 4 or 12. Knows no socket and no
/// clock. It calls its parts in order and assembles the tick's record from what they return:
///
///     ArmState ─▶ ArmSession ─▶ MotionSupervisor ─▶ renderer | way to the start | braking ─▶ CommandedTool ─▶ ArmCommand
///     CellReadings ─▶ HandForce ─▶ SafetyChecks ─▶ MotionSupervisor
///     ContactModel ─▶ CouplingPipeline ─▶ AdmittanceRenderer | ImpedanceRenderer
///
/// **State.** safety::CellState is the authority, led by one table (safety/cell_state.h, docs/states.md); the
/// recorded Phase follows from it. Each tick derives events from its inputs, the most severe first
/// (ApplyEvent).
///
/// - off, checking, ready and recovery follow the arm's own position. Nothing moves before every condition of
///   safety::MotionPermits holds in one tick. The virtual tool starts from the commanded joints, at rest, the
///   coupling faded out: no jump. An arm that stayed in the same COMMANDING_ACTIVE through a pause or a loss
///   of messages is held where it was last told to be: its own interpolator stands where commanding began.
/// - aligning goes to ServoParams::start along a joint path, where the arm was handed over elsewhere. It
///   goes on while motion is permitted and pauses on its path where it is not; an arm that leaves
///   COMMANDING_ACTIVE meanwhile is waited for anew. Once rendering has begun there is no way to the start
///   any more.
/// - haptic and cutting render, the spindle still or turning (AdmittanceRenderer, ImpedanceRenderer).
/// - stop 1 and stop 2 brake what is commanded, whichever state commanded it (CommandedTool::Brake,
///   ImpedanceRenderer::Brake); nothing is rendered and the spindle is still. On the way to the start the
///   path's clock is braked.
/// - stop 0: the arm takes no commands. It is over once the arm is measured to stand.
/// - paused and fault hold, and follow the arm where it leaves COMMANDING_ACTIVE. Only RequestResume(), a
///   recovery, or a new loop goes on. A hand that leans on a paused arm of the impedance law displaces it:
///   that is no fault, it only keeps the arm from going on.
///
/// Before its first motion the sensor's bias is estimated while the tool rests. Wherever the arm moves or is
/// braked, hand and sensor are checked; while it moves by itself or renders, the spindle as well
/// (SafetyChecks).
///
/// After limiting, the virtual tool's state is set to the commanded motion: commanded and integrated pose are
/// one at every tick. The joints follow the tool's twist (DifferentialInverse), so that the end of the reach,
/// a singular posture and a joint's limit are places where the tool slides or slows down, not faults; the
/// pose that is commanded is the one that these joints have. The closed-form inverse says where the elbow
/// should go: it is held where it is on its circle while the tool moves, and goes to the wanted arm angle;
/// once it has been there, it moves only while the tool does.
class ServoLoop {
 public:
  /// @param X_WB robot base in world  @param X_FT tool on the flange  @param arm_angle_rad wanted in the run
  /// @throws std::invalid_argument naming the parameter, the value and what is accepted.
  ServoLoop(const ServoParams& params, const kinematics::LbrArm& arm, const Pose& X_WB, const Pose& X_FT,
            double arm_angle_rad);
  /// The same of a six-axis arm: no elbow to lead, and its torques are not known.
  ServoLoop(const ServoParams& params, const kinematics::OrthoParallelArm& arm, const Pose& X_WB,
            const Pose& X_FT);
  ServoLoop(const ServoLoop&) = delete;
  ServoLoop& operator=(const ServoLoop&) = delete;

  /// One tick. `state` counts where `received` is kOk; otherwise the loop holds.
  /// @param now on the clock of all stamps
  /// @param[out] command what to answer; always finite, once one message with finite joints was seen
  TickRecord Tick(const ArmState& state, ReceiveResult received, const CellReadings& readings,
                  const simulation::ContactModel& model, rt::Nanoseconds now, ArmCommand& command) OSTEON_RT;

  /// Whether an arm that waits may begin to move; it may at first. From any thread: e.g. while the way to the
  /// start is looked at.
  void AllowStart(bool allowed) OSTEON_RT { requests_.AllowStart(allowed); }

  /// Orderly stop. From any thread, and from a signal handler.
  void RequestStop() OSTEON_RT { requests_.RequestStop(); }

  /// Begin again after a stop that the connection to the arm brought about (Fault::kSession, kArmStale) and
  /// nothing else: waits for the arm, and then renders from where it stands. Without effect otherwise. From
  /// any thread.
  void RequestRecovery() OSTEON_RT { requests_.RequestRecovery(); }
  /// An operator's pause: brakes to rest (stop 2) and holds, until RequestResume(). From any thread, and from
  /// a signal handler.
  void RequestPause() OSTEON_RT { requests_.RequestPause(); }
  /// Ends a pause: from where the tool stands, once every condition of motion holds. Without effect where the
  /// cell is not paused. From any thread, and from a signal handler.
  void RequestResume() OSTEON_RT { requests_.RequestResume(); }
  /// Whether it would have an effect now.
  [[nodiscard]] bool CanRecover() const OSTEON_RT { return supervisor_.CanRecover(); }

  /// A tick that was computed again came out otherwise (LoopRepeat): the next one latches
  /// Fault::kRepeatDiffers. From the tick's thread.
  void ReportDifference() OSTEON_RT { differed_ = true; }

  /// The recorder stands still or refuses ticks: the next tick latches Fault::kRecorder. From the tick's
  /// thread.
  void ReportRecorder() OSTEON_RT { recorder_stalled_ = true; }

  /// Asks for what the next tick reads of this loop to be near the processor by then. From the tick's thread.
  void Prefetch() const OSTEON_RT;

  /// Other gains from the next tick on, reached within GainRamp::kRampSeconds and without making energy. A
  /// later request before a tick has taken it replaces it. From any one thread, not the tick's.
  /// @throws std::invalid_argument naming the field, the value and what is accepted: the coupling's stiffness
  /// at most what the loop was made with, which its trips and the simulation count on.
  void RequestGains(const Gains& gains);

  /// What the simulation should follow: the commanded tool pose of the last tick; with the impedance law the
  /// measured one, stamped with the tick whose message it came with. Its stamp is 0 until the arm has said
  /// where it is: there is no pose yet.
  [[nodiscard]] simulation::ToolCommand tool_command() const OSTEON_RT;

  /// What the cell's devices should do now.
  [[nodiscard]] CellCommands cell_commands() const OSTEON_RT;

  [[nodiscard]] safety::CellState state() const OSTEON_RT { return supervisor_.state(); }
  /// The conditions of motion that held when they were last looked at: while nothing moves.
  [[nodiscard]] safety::MotionPermits permits() const OSTEON_RT { return supervisor_.permits(); }
  /// The state's name in the recording.
  [[nodiscard]] Phase phase() const OSTEON_RT { return supervisor_.phase(); }
  [[nodiscard]] safety::FaultSet faults() const OSTEON_RT { return supervisor_.faults(); }
  [[nodiscard]] const ServoStatistics& statistics() const OSTEON_RT { return statistics_; }
  [[nodiscard]] double max_force_N() const OSTEON_RT { return coupling_.limiter().max_force_N(); }

 private:
  ServoLoop(const ServoParams& params, std::unique_ptr<ArmFollower> arm, const Pose& X_FT);

  // a tick, in order
  [[nodiscard]] TickRecord RecordInputs(const TickInputs& tick, ReceiveResult received) OSTEON_RT;
  void ApplyRequests(const TickInput& input) OSTEON_RT;
  void StepGains(TickInput& input) OSTEON_RT;
  void OnMissedMessage(ReceiveResult received) OSTEON_RT;
  void ProcessArmMessage(const TickInputs& tick, TickRecord& record) OSTEON_RT;
  void FillCommand(const ArmState& state, ArmCommand& command) const OSTEON_RT;
  void FinishRecord(const ArmCommand& command, TickRecord& record) OSTEON_RT;

  // the state, and what it does to what is commanded
  safety::CellAction ApplyEvent(safety::CellEvent event) OSTEON_RT;
  void ApplyFault() OSTEON_RT { ApplyEvent(safety::CellEvent::kFault); }
  void FinishStop() OSTEON_RT;
  [[nodiscard]] bool UpdateSession(const ArmState& state) OSTEON_RT;
  void FollowArm(const ArmState& state) OSTEON_RT;
  void StartMotionIfPermitted(const TickInputs& tick) OSTEON_RT;
  void StartPath(const TickInputs& tick) OSTEON_RT;
  void StepStartPath(const TickInputs& tick) OSTEON_RT;
  void StartRendering(const TickInputs& tick) OSTEON_RT;

  // what is checked
  void CheckArmSpeed(const ArmState& state, bool active, TickRecord& record) OSTEON_RT;
  void CheckMotion(const ArmState& state) OSTEON_RT;
  void CheckOnPath(const TickInputs& tick, TickRecord& record) OSTEON_RT;
  void CheckInStop(const TickInputs& tick, TickRecord& record) OSTEON_RT;
  void CheckHand(const Wrench& F_hand_T_W) OSTEON_RT;

  // what is rendered, and how it ends
  [[nodiscard]] Wrench ComputeHandWrench(const ForceReading& reading, TickRecord& record) OSTEON_RT;
  void UpdateSpindle(const CellReadings& readings) OSTEON_RT;
  /// Where the coupling counts: the commanded tool, with the impedance law the measured one.
  struct ToolMotion {
    const Pose& X_WT;
    Twist V_WT;
  };
  Wrench EvaluateContact(const TickInputs& tick, const ToolMotion& tool, TickRecord& record) OSTEON_RT;
  void RenderAdmittance(const TickInputs& tick, TickRecord& record) OSTEON_RT;
  void RenderImpedance(const TickInputs& tick, TickRecord& record) OSTEON_RT;
  void StopRendering(TickRecord& record) OSTEON_RT;
  void CountDepthLeft() OSTEON_RT;
  void RecordRendered(const safety::LimitedWrench& rendered, double speed_m_per_s,
                      TickRecord& record) OSTEON_RT;
  void BrakeForPause(const TickInputs& tick, TickRecord& record) OSTEON_RT;
  void Brake() OSTEON_RT;
  void BrakeJoints() OSTEON_RT;
  /// Time between the tool's poses of this coupling and of the last: a commanded tool stands while messages
  /// are lost, a measured one goes on.
  [[nodiscard]] double CouplingStep_s() const OSTEON_RT {
    return params_.law == Law::kImpedance ? session_.elapsed_s() : params_.period_s;
  }

  ServoParams params_;  // the parts refer to it: their gains change with it
  LoopRequests requests_;
  MotionSupervisor supervisor_;
  ArmSession session_;
  CommandedTool tool_;
  HandForce hand_;
  CouplingPipeline coupling_;
  SafetyChecks checks_;
  AdmittanceRenderer admittance_;
  ImpedanceRenderer impedance_;
  ServoStatistics statistics_;

  struct GainsRequest {
    std::uint64_t number{0};  ///< counts them; 0: none
    Gains gains;
  };
  rt::LatestValue<GainsRequest> gains_asked_;
  std::uint64_t gains_number_{0};  ///< the asking thread's
  std::uint64_t gains_taken_{0};   ///< of the last one taken
  double max_stiffness_N_per_m_{0.0};
  GainRamp gain_ramp_;

  std::uint64_t tick_{0};
  rt::Nanoseconds now_{0};
  bool differed_{false};           ///< ReportDifference since the last tick
  bool recorder_stalled_{false};   ///< ReportRecorder since the last tick
  bool spindle_permitted_{true};   ///< by the PLC
  double spindle_rad_per_s_{0.0};  ///< what it does: measured where there is a drive
  bool arm_overloaded_{false};     ///< the arm's joints are about to bear more than they hold
  bool reduced_speed_{false};      ///< the arm is in T1, or does not say
  safety::LimitSet acting_;        ///< in this tick
};

}  // namespace osteon::control
