#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>

#include "control/arm_follower.h"
#include "control/arm_speed_watch.h"
#include "control/axis_lock.h"
#include "control/gain_ramp.h"
#include "control/message_gap.h"
#include "control/ports.h"
#include "control/rt/latest_value.h"
#include "control/rt/marker.h"
#include "control/servo_params.h"
#include "control/stop_brake.h"
#include "control/tick_record.h"
#include "control/tool_inertia.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "safety/acting_limits.h"
#include "safety/cell_state.h"
#include "safety/fault.h"
#include "safety/force_limit_reaction.h"
#include "safety/motion_permit.h"
#include "safety/stored_energy_limit.h"
#include "simulation/contact_model.h"
#include "simulation/cutting_engine.h"

namespace osteon::control {

/// Peaks and counts since the start.
struct ServoStatistics {
  double peak_coupling_force_N{0.0};  ///< rendered: after every limit, as integrated
  double peak_coupling_torque_Nm{0.0};
  double peak_sensor_force_N{0.0};      ///< what the sensor said
  double peak_tool_speed_m_per_s{0.0};  ///< commanded
  double peak_tool_in_bone_m{0.0};      ///< from the tool to its collision-free pose
  double peak_power_W{0.0};             ///< from the coupling to the hand, of the motion that was commanded
  /// Between two messages, while the loop commands the arm: also on its way to the start and in a stop.
  double peak_measured_tool_speed_m_per_s{0.0};
  double peak_tracking_error_m{0.0};
  safety::LimitCounts limits;                                          ///< while rendering
  double least_depth_left_m{std::numeric_limits<double>::infinity()};  ///< to the reamer's depth limit
  double least_tank_J{std::numeric_limits<double>::infinity()};
  std::uint64_t active_ticks{0};     ///< messages answered in COMMANDING_ACTIVE, once the loop has begun
  std::uint64_t missed_messages{0};  ///< deadlines that passed without one, once commanding
};

/// The admittance loop of an arm in position mode, one arm message a tick: an LBR each millisecond, a KR each
/// 4 or 12. Knows no socket and no clock.
///
///     message → pose → ages → coupling → wrench trips and limiter → M a + D v = F_operator + F_coupling
///             (M, D by the vibration index) → tool speed, workspace → differential inverse, null space →
///             joint guard → command
///
/// **State.** safety::CellState is the authority, led by one table (safety/cell_state.h, docs/states.md); the
/// recorded Phase follows from it. A tick forms its events from what it sees, the worst first (Take).
///
/// - off, checking, ready, recovery follow the arm's own position. Nothing moves before every condition of
/// safety::MotionPermits holds in one tick. The virtual tool starts from the commanded joints, at rest, the
/// coupling faded out: no jump. An arm that stayed in the same COMMANDING_ACTIVE through a pause or a loss of
/// messages is not followed but held where it was last told to be: its own interpolator stands where
/// commanding began.
/// - aligning goes to ServoParams::start along a joint path, where the arm was handed over elsewhere. It
/// goes on while motion is permitted and pauses on its path where it is not; an arm that leaves
/// COMMANDING_ACTIVE meanwhile is waited for anew. Once rendering was begun there is no way to the start any
/// more.
/// - haptic and cutting render, the spindle still or turning. The age of the contact model slows the motion
/// down: with s the coupling's fade, the operator's force
///   counts s F, the coupling s F_c (in EvaluateCoupling), the tool moves by s v dt. At s = 0 the tool is
///   held, whoever pushes, and no energy can be made of a force that is not known.
/// - stop 1 and stop 2 brake what is commanded, whichever state commanded it: the tool's twist is scaled down
/// to rest along its own direction, |v|^2 / 2a; nothing is rendered
///   and the spindle is still. Where the tool's path has no joints (kInverseKinematics, kJointLimit) the
///   joints' own last motion is scaled down instead, and on the way to the start the path's clock.
/// - stop 0: the arm takes no commands. It is over once the arm is measured to stand.
/// - paused and fault hold, and follow the arm where it leaves COMMANDING_ACTIVE. Only RequestResume(), a
/// recovery, or a new loop goes on.
///
/// Before its first motion the sensor's bias is taken while the tool rests (BiasEstimator). Wherever the arm
/// moves or is braked, hand and sensor are supervised; while it moves by itself or renders, the spindle as
/// well. While it renders, a hand that makes the arm oscillate meets more drag (VibrationIndex), and the
/// coupling stays stable where its planes are old, change, or make energy (Stabilisers).
///
/// **Impedance law** (Law::kImpedance): the arm carries itself and is where the hand has it, so that there is
/// no commanded pose: coupling, simulation, speed and workspace count where the arm is measured. The wrench
/// goes out as FRI's overlay (on T, or as J^T F); the joints' command, the equilibrium of the arm's own
/// spring, goes along. Beyond the tool's speed and at the workspace's bounds it is braked, at half as much
/// again it stops. In kStopping nothing is rendered, the arm's spring holds it where it is and what still
/// moves is braked, until the arm is measured to stand. A hand that leans on a paused arm displaces it: that
/// is no fault, it only keeps the arm from going on.
///
/// Whatever limits the motion pulls the virtual tool back with it: commanded and integrated pose are one at
/// every tick. The joints follow the tool's twist (DifferentialInverse), so that the end of the reach, a
/// singular posture and a joint's limit are places where the tool slides or slows down, not faults; the pose
/// that is commanded is the one that these joints have. The closed-form inverse says where the elbow should
/// go: it is held where it is on its circle while the tool moves, and goes to the wanted arm angle; once it
/// has been there, it moves only while the tool does.
class ServoLoop {
 public:
  /// @param X_WB robot base in world  @param X_FT tool on the flange  @param arm_angle_rad wanted in the run
  /// @throws std::invalid_argument naming the parameter, the value and what is accepted.
  ServoLoop(const ServoParams& params, const kinematics::LbrArm& arm, const Pose& X_WB, const Pose& X_FT,
            double arm_angle_rad);
  /// The same of a six-axis arm: no elbow to lead, and its torques are not known.
  ServoLoop(const ServoParams& params, const kinematics::OrthoParallelArm& arm, const Pose& X_WB,
            const Pose& X_FT);

  /// One tick. `state` counts where `received` is kOk; otherwise the loop holds.
  /// @param now on the clock of all stamps
  /// @param[out] command what to answer; always finite, once one message with finite joints was seen
  TickRecord Tick(const ArmState& state, ReceiveResult received, const CellReadings& readings,
                  const simulation::ContactModel& model, rt::Nanoseconds now, ArmCommand& command) OSTEON_RT;

  /// Whether an arm that waits may begin to move; it may at first. From any thread: e.g. while the way to the
  /// start is looked at.
  void AllowBegin(bool allowed) OSTEON_RT { may_begin_.store(allowed, std::memory_order_relaxed); }

  /// Orderly stop. From any thread, and from a signal handler.
  void RequestStop() OSTEON_RT { stop_requested_.store(true, std::memory_order_relaxed); }

  /// Begin again after a stop that the connection to the arm brought about (Fault::kSession, kArmStale) and
  /// nothing else: waits for the arm, and then renders from where it stands. Without effect otherwise. From
  /// any thread.
  void RequestRecovery() OSTEON_RT { recovery_requested_.store(true, std::memory_order_relaxed); }
  /// An operator's pause: brakes to rest (stop 2) and holds, until RequestResume(). From any thread, and from
  /// a signal handler.
  void RequestPause() OSTEON_RT { pause_requested_.store(true, std::memory_order_relaxed); }
  /// Ends a pause: from where the tool stands, once every condition of motion holds. Without effect where the
  /// cell is not paused. From any thread, and from a signal handler.
  void RequestResume() OSTEON_RT { resume_requested_.store(true, std::memory_order_relaxed); }
  /// Whether it would have an effect now.
  [[nodiscard]] bool CanRecover() const OSTEON_RT;

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

  [[nodiscard]] safety::CellState state() const OSTEON_RT { return state_; }
  /// The conditions of motion that held when they were last looked at: while nothing moves.
  [[nodiscard]] safety::MotionPermits permits() const OSTEON_RT { return permits_; }
  /// What the recording calls the state.
  [[nodiscard]] Phase phase() const OSTEON_RT;
  [[nodiscard]] safety::FaultSet faults() const OSTEON_RT { return faults_; }
  [[nodiscard]] const ServoStatistics& statistics() const OSTEON_RT { return statistics_; }
  [[nodiscard]] double max_force_N() const OSTEON_RT { return wrench_limiter_.max_force_N(); }

 private:
  ServoLoop(const ServoParams& params, std::unique_ptr<ArmFollower> arm, const Pose& X_FT);

  void Answer(const ArmState& state, const CellReadings& readings, const simulation::ContactModel& model,
              rt::Nanoseconds now, TickRecord& record) OSTEON_RT;
  void Mirror(const ArmState& state) OSTEON_RT;
  void Miss(ReceiveResult received) OSTEON_RT;
  // servo_state.cpp
  safety::CellAction Take(safety::CellEvent event) OSTEON_RT;
  void TakeRequests(const TickInput& input) OSTEON_RT;
  void TakeRest() OSTEON_RT;
  /// Nothing is moved or braked, and no fault is latched: the arm is waited for, or the cell is paused.
  [[nodiscard]] bool Rests() const OSTEON_RT {
    return safety::Waits(state_) || state_ == safety::CellState::kPaused;
  }
  void LookAtRest(const ArmState& state) OSTEON_RT;
  [[nodiscard]] bool TakeSession(const ArmState& state) OSTEON_RT;
  [[nodiscard]] bool Commanded(const ArmState& state) const OSTEON_RT;
  [[nodiscard]] safety::MotionPermits Look(const ArmState& state, const CellReadings& readings,
                                           const simulation::ContactModel& model,
                                           rt::Nanoseconds now) const OSTEON_RT;
  [[nodiscard]] bool Permitted(const InterlockReading& interlock, rt::Nanoseconds now) const OSTEON_RT;
  void Wait(const ArmState& state) OSTEON_RT;
  void MeasureMotion(const ArmState& state) OSTEON_RT;
  void Align(const ArmState& state, bool permitted, rt::Nanoseconds now) OSTEON_RT;
  void Begin(const ArmState& state, rt::Nanoseconds now) OSTEON_RT;
  void StartRendering(const ArmState& state, rt::Nanoseconds now) OSTEON_RT;
  [[nodiscard]] Wrench TakeSensor(const CellReadings& readings, TickRecord& record) OSTEON_RT;
  void Render(const CellReadings& readings, const simulation::ContactModel& model, rt::Nanoseconds now,
              TickRecord& record) OSTEON_RT;
  void StepGains(TickInput& input) OSTEON_RT;  // servo_gains.cpp
  // servo_impedance.cpp
  [[nodiscard]] bool ModeFits(CommandMode mode) const OSTEON_RT;
  void RenderImpedance(const CellReadings& readings, const simulation::ContactModel& model,
                       rt::Nanoseconds now, TickRecord& record) OSTEON_RT;
  void BrakeImpedance() OSTEON_RT;
  void PutWrench(const ArmState& state, ArmCommand& command) const OSTEON_RT;
  void TakeSpindle(const CellReadings& readings) OSTEON_RT;
  void Supervise(const CouplingOutput& coupling, const Wrench& F_operator_T_W, double sensor_age_s,
                 const CellReadings& readings, rt::Nanoseconds now) OSTEON_RT;
  void PutWrenchStep(TickRecord& record) const OSTEON_RT;
  /// Time between the tool's poses of this coupling and of the last: a commanded tool stands while messages
  /// are lost, a measured one goes on.
  [[nodiscard]] double CouplingStep_s() const OSTEON_RT {
    return params_.law == Law::kImpedance ? elapsed_s_ : params_.period_s;
  }
  void SuperviseDevices(double model_age_s, double sensor_age_s, const CellReadings& readings,
                        rt::Nanoseconds now) OSTEON_RT;
  void SuperviseSensor(double sensor_age_s, const CellReadings& readings, rt::Nanoseconds now) OSTEON_RT;
  void SuperviseSpindle(const CellReadings& readings, rt::Nanoseconds now) OSTEON_RT;
  void SuperviseHand(const Wrench& F_operator_T_W) OSTEON_RT;
  void SuperviseStartPath(const CellReadings& readings, rt::Nanoseconds now, TickRecord& record) OSTEON_RT;
  void SuperviseStop(const CellReadings& readings, rt::Nanoseconds now, TickRecord& record) OSTEON_RT;
  void BrakeForPause(const CellReadings& readings, const simulation::ContactModel& model, rt::Nanoseconds now,
                     TickRecord& record) OSTEON_RT;
  void Brake() OSTEON_RT;
  void BrakeJoints() OSTEON_RT;
  [[nodiscard]] bool Follow(bool& limited) OSTEON_RT;
  [[nodiscard]] safety::LimitedWrench LimitCoupling(const CouplingOutput& coupling, const Pose& X_WT,
                                                    const Twist& V_WT) OSTEON_RT;
  [[nodiscard]] safety::LimitedWrench LimitRenderedWrench(const Wrench& F_coupling_T_W,
                                                          const Vector3& f_depth_W, double fade) OSTEON_RT;
  void LimitPower(double power_share, safety::LimitedWrench& rendered) OSTEON_RT;
  void WatchArmSpeed(const ArmState& state, bool active, TickRecord& record) OSTEON_RT;
  void CountRendered(const safety::LimitedWrench& limited, double speed_m_per_s, bool twist_limited,
                     bool workspace_limited, double fade, double sensor_share) OSTEON_RT;

  ServoParams params_;
  std::unique_ptr<ArmFollower> arm_;  ///< its pose is the virtual tool's, once it is known
  Pose X_TF_;
  safety::WrenchLimiter wrench_limiter_;
  safety::WrenchRateTrip rate_trip_;
  safety::SensorForceTrip sensor_trip_;
  safety::Workspace workspace_;
  safety::DepthLimit depth_limit_;
  safety::StoredEnergyLimit stored_energy_limit_;
  safety::ForceLimitReaction force_limit_reaction_;
  safety::SpindleTrip spindle_trip_;
  safety::Watchdog watchdog_;
  ArmSpeedWatch arm_speed_;

  safety::CellState state_{safety::CellState::kOff};
  safety::MotionPermits permits_;
  std::uint32_t activation_{0};  ///< of the arm, that motion began with
  bool commanded_{false};        ///< motion began, and no message has said since that the arm left
  bool on_path_{false};          ///< what is commanded is the way to the start
  bool rendered_{false};         ///< at least once: no way to the start any more
  bool moved_{false};            ///< at least once: a fault of the drive waits for a recovery
  JointArray q_seen_{};          ///< [rad] measured in the last message
  static constexpr int kStandingTicks = 10;
  int standing_ticks_{0};  ///< messages in a row in which the arm stood, kStandingTicks at most
  safety::FaultSet faults_;
  ServoStatistics statistics_;
  CouplingState coupling_;
  BiasEstimator bias_;
  MeasuredMotion flange_motion_;  ///< where the tool's inertia counts
  VibrationIndex vibration_;
  Stabilisers stabilisers_;
  double mass_factor_{1.0};  ///< of the virtual tool, in the last tick
  AxisLock axis_lock_;

  struct GainsRequest {
    std::uint64_t number{0};  ///< counts them; 0: none
    Gains gains;
  };
  rt::LatestValue<GainsRequest> gains_asked_;
  std::uint64_t gains_number_{0};  ///< the asking thread's
  std::uint64_t gains_taken_{0};   ///< of the last one taken
  double most_stiffness_N_per_m_{0.0};
  GainRamp gain_ramp_;
  bool pressed_{false};  ///< a plane was penetrated in the last tick
  std::uint64_t tick_{0};
  rt::Nanoseconds now_{0};

  bool differed_{false};           ///< ReportDifference since the last tick
  bool recorder_stalled_{false};   ///< ReportRecorder since the last tick
  bool stop_asked_{false};         ///< as the last tick saw it
  bool pause_asked_{false};        ///< and not begun yet: no message came since
  bool spindle_permitted_{true};   ///< by the PLC
  double spindle_rad_per_s_{0.0};  ///< what it does: measured where there is a drive

  // the virtual tool
  bool has_pose_{false};
  Twist V_WT_;               ///< of the law, before the share below
  double share_{0.0};        ///< of V_WT_ that moves the tool
  double sight_age_s_{0.0};  ///< the models' greatest age of late

  // the measured motion, from the arm's messages
  MeasuredTwist measured_twist_;
  MessageGap message_gap_;
  double elapsed_s_{0.0};       ///< between the last two messages: a multiple of the period
  double hand_N_{0.0};          ///< what the hand exerts, as supervised last
  JointArray q_meas_before_{};  ///< of the last message, rendering with the impedance law
  Pose X_WT_meas_{Pose::Identity()};
  rt::Nanoseconds measured_at_{0};  ///< the tick that X_WT_meas_ came with; 0: none yet

  // the impedance law
  Wrench F_sent_T_W_;  ///< of this tick: coupling, damping and braking, within the limits
  StopBrake stop_brake_;
  int stop_ticks_{0};  ///< of a stop so far

  bool overloaded_{false};   ///< the arm's joints are about to bear more than they hold
  bool reduced_{false};      ///< the arm is in T1, or does not say
  safety::LimitSet acting_;  ///< in this tick

  std::atomic<bool> stop_requested_{false}, recovery_requested_{false}, may_begin_{true},
      pause_requested_{false}, resume_requested_{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
};

}  // namespace osteon::control
