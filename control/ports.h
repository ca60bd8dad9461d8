#pragma once

#include <array>
#include <cstdint>

#include "base/clock.h"
#include "base/marker.h"
#include "control/tick_record.h"
#include "kinematics/spatial.h"

// The servo loop's interfaces to arm, devices and recorder. The folder io/ implements them for real time; a
// run in virtual time has implementations of its own.

namespace osteon::control {

inline constexpr int kJoints = 7;
using JointArray = std::array<double, kJoints>;

/// FRI session states, numbered as on the wire.
enum class SessionState : std::uint8_t {
  kIdle = 0,
  kMonitoringWait = 1,
  kMonitoringReady = 2,
  kCommandingWait = 3,
  kCommandingActive = 4,
};

/// Control mode of the arm's own controller, numbered as in FRI.
enum class ControlMode : std::uint8_t {
  kPosition = 0,
  kCartesianImpedance = 1,
  kJointImpedance = 2,
  kNone = 3,  ///< e.g. brakes applied
};

/// Command mode that the arm's program requires of the client, numbered as in FRI.
enum class CommandMode : std::uint8_t {
  kNone = 0,
  kPosition = 1,
  kWrench = 2,         ///< a position and a wrench; the arm's controller in Cartesian impedance
  kTorque = 3,         ///< a position and joint torques; the arm's controller in joint impedance
  kCartesianPose = 4,  ///< not supported: the link then holds the arm at its present position
};

/// One message from the arm.
struct ArmState {
  rt::Nanoseconds stamp{0};  ///< local time of arrival
  std::uint32_t sequence{0};
  SessionState session{SessionState::kIdle};
  std::uint8_t quality{0};         ///< 0 poor … 3 excellent
  std::uint8_t safety_state{0};    ///< 0 normal, 1 … 3 stop level 0 … 2
  std::uint8_t operation_mode{0};  ///< 0 T1, 1 T2, 2 automatic
  bool drives_active{false};       ///< the drives of all joints are active
  ControlMode control_mode{ControlMode::kPosition};
  CommandMode command_mode{CommandMode::kNone};
  double period_s{0.001};  ///< time between two messages, as set up at the arm
  JointArray q_meas{};     ///< [rad]
  JointArray q_ipo{};      ///< [rad] set point of the arm's own interpolator; valid in COMMANDING_WAIT and
                           ///< COMMANDING_ACTIVE
  bool has_ipo{false};
  JointArray tau_ext{};  ///< [N·m] external torques, as the arm estimates them

  /// Number of times that COMMANDING_ACTIVE has begun. The arm follows a command only if the command contains
  /// this number.
  std::uint32_t activation{0};
  /// The arm is in COMMANDING_ACTIVE, but no command has contained the present activation yet. The link
  /// meanwhile commands the interpolator's position.
  bool holding{false};

  // Counts of the arm's messages so far.
  std::uint32_t lost{0};           ///< never arrived
  std::uint32_t duplicate{0};      ///< arrived twice
  std::uint32_t late{0};           ///< arrived in order, but were not read before the next one arrived
  std::uint32_t reordered{0};      ///< overtaken by a newer one in transit
  std::uint32_t rejected{0};       ///< hostile, damaged, of another sender or of another version
  std::uint32_t other_version{0};  ///< part of `rejected`: another version of the protocol
  // Counts of the answers so far. The arm's messages repeat the number of the answer that the arm has used.
  std::uint32_t answers_lost{0};     ///< never used by the arm, which used a later answer
  std::uint32_t answers_foreign{0};  ///< used by the arm, but sent by another client
};

/// The loop's answer: the commanded joint positions. In states in which the arm moves by itself, the link
/// sends the arm's own position instead.
struct ArmCommand {
  JointArray q{};  ///< [rad]
  /// The value of ArmState::activation for which this command is made. The link withholds a command for
  /// another activation. Otherwise, if the arm has left COMMANDING_ACTIVE and returned unnoticed by the loop,
  /// the arm would jump to the loop's old position.
  std::uint32_t activation{0};
  PlainWrench F{};   ///< for kWrench: wrench on the arm's motion centre, in the frame of that centre
  JointArray tau{};  ///< [N·m] for kTorque
};

/// Result of waiting for a message. kClosed: the link has ended, and no message will come any more.
enum class ReceiveResult : std::uint8_t { kOk, kTimeout, kClosed };

/// Exchanges messages with the arm.
class ArmLink {
 public:
  virtual ~ArmLink() = default;
  /// Waits for the arm's next message, at most until the deadline. Hostile bytes are counted (`rejected`) and
  /// skipped.
  virtual ReceiveResult Receive(ArmState& state, rt::Nanoseconds deadline) OSTEON_RT = 0;
  /// Answers the message last received. False if the system could not send.
  virtual bool Send(const ArmCommand& command) OSTEON_RT = 0;

  /// Sleeps until `time` or until a message has arrived; returns true for a message.
  virtual bool Await(rt::Nanoseconds time) OSTEON_RT {
    rt::SleepUntil(time);
    return false;
  }
  /// Warms the caches for the next message. The last message and an answer to it are processed again by the
  /// protocol and by the operating system, on separate sockets. Nothing is sent to the arm.
  virtual void WarmUp(const ArmCommand& /*command*/) OSTEON_RT {}
};

/// One reading of the force sensor.
struct ForceReading {
  rt::Nanoseconds stamp{0};  ///< 0: none yet
  PlainWrench F_S;     ///< wrench on the sensor's tool side, at S's origin, in S; includes the tool's weight
  bool trusted{true};  ///< false: the reading is beyond the sensor's range, or the sensor reports a fault
};

/// One reading of the reamer's drive.
struct SpindleReading {
  rt::Nanoseconds stamp{0};     ///< 0: none yet
  double speed_rad_per_s{0.0};  ///< speed of the tool
  /// torque at the tool; includes friction and the torque that accelerates the spindle
  double torque_Nm{0.0};
  bool ready{false};  ///< the drive is configured, and its status messages arrive
  bool fault{false};  ///< the drive or its connection has a fault; latched by the drive's client
  // Causes of the fault. io::DescribeDriveFaults returns their texts.
  std::uint8_t faults{0};           ///< io::DriveFault bits
  std::uint8_t nmt_state{0};        ///< NMT state in the drive's last heartbeat (CiA 301)
  std::uint16_t emergency_code{0};  ///< code of the drive's EMCY message (CiA 301); 0: none
  std::uint16_t error_code{0};      ///< object 603F (CiA 402); 0: none
};

/// One reading of the cell's PLC.
struct InterlockReading {
  rt::Nanoseconds stamp{0};  ///< 0: none yet
  /// the PLC permits motion; false while the PLC is silent or its heartbeat stands still
  bool permitted{false};
  bool enabled{false};            ///< the enabling switch is in its middle position
  bool spindle_permitted{false};  ///< the foot pedal is pressed, and motion is permitted
  std::uint8_t reason{0};         ///< reason if motion is not permitted (io::PlcVerdict); 0: permitted
};

/// Readings of the cell's devices beside the arm.
struct CellReadings {
  ForceReading force{};
  SpindleReading spindle{};
  InterlockReading interlock{};
};

/// Commands to the devices beside the arm.
struct CellCommands {
  bool motion_requested{false};  ///< asks the PLC to permit motion
  double spindle_rad_per_s{0.0};
  bool quick_stop{false};  ///< stops the spindle along its steepest ramp
  /// True before the first motion and in a recovery: latched faults of the drive may be reset.
  bool clear_faults{false};
};

/// Force sensor, spindle and PLC.
class CellDevices {
 public:
  virtual ~CellDevices() = default;
  /// Sends the commands and returns the newest readings; never waits.
  [[nodiscard]] virtual CellReadings Exchange(const CellCommands& commands,
                                              rt::Nanoseconds now) OSTEON_RT = 0;
};

/// Stores the records of ticks.
class TickRecorder {
 public:
  virtual ~TickRecorder() = default;
  /// Stores a record. Returns false if the recorder is full; the tick continues nevertheless.
  virtual bool Push(const TickRecord& record) OSTEON_RT = 0;
  /// Whether so many records are waiting in the recorder that some will soon be lost. Called from the tick's
  /// thread.
  [[nodiscard]] virtual bool Stalled() const OSTEON_RT { return false; }
};

}  // namespace osteon::control
