#pragma once

#include <array>
#include <cstdint>

#include "base/clock.h"
#include "base/marker.h"
#include "control/tick_record.h"
#include "kinematics/spatial.h"

// The servo loop's interfaces to arm, devices and recorder. io implements them; virtual time has its own.

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

/// Command mode that the arm's program asks of the client, numbered as in FRI.
enum class CommandMode : std::uint8_t {
  kNone = 0,
  kPosition = 1,
  kWrench = 2,         ///< a wrench along with the position; the arm in Cartesian impedance
  kTorque = 3,         ///< joint torques along with the position; the arm in joint impedance
  kCartesianPose = 4,  ///< not supported: the link holds the arm where it is
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
  double period_s{0.001};  ///< time from message to message, as the arm is set up
  JointArray q_meas{};     ///< [rad]
  JointArray q_ipo{};      ///< [rad] the arm's own interpolator; valid in COMMANDING_*
  bool has_ipo{false};
  JointArray tau_ext{};  ///< [N·m] external torque, the arm's estimate

  /// Number of times that COMMANDING_ACTIVE began: a command must name it to be followed.
  std::uint32_t activation{0};
  /// COMMANDING_ACTIVE, but no command has named this activation yet: the link holds the interpolator's
  /// position.
  bool holding{false};

  // Messages so far.
  std::uint32_t lost{0};           ///< never came
  std::uint32_t duplicate{0};      ///< came twice
  std::uint32_t late{0};           ///< came in order, but were not read before the next one arrived
  std::uint32_t reordered{0};      ///< overtaken by a newer one in transit
  std::uint32_t rejected{0};       ///< hostile, damaged, of another sender or of another version
  std::uint32_t other_version{0};  ///< part of `rejected`: another version of the protocol
  // Answers so far, as the arm's messages reflect them.
  std::uint32_t answers_lost{0};     ///< never seen by the arm, which took a later answer
  std::uint32_t answers_foreign{0};  ///< reflected by the arm, but sent by another client
};

/// The loop's answer: where the joints should be. In states in which the arm moves by itself, the link
/// mirrors its position instead.
struct ArmCommand {
  JointArray q{};  ///< [rad]
  /// ArmState::activation as the loop knows it: the loop has seen that the arm is handed over, and begins at
  /// the interpolator's position. The link withholds commands for another activation, so that a loop that
  /// missed the arm's leaving and return does not make it jump.
  std::uint32_t activation{0};
  PlainWrench F{};   ///< kWrench: on the arm's motion centre, in its frame
  JointArray tau{};  ///< [N·m] kTorque
};

/// Result of waiting for a message; kClosed: the link has ended for good.
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
  /// Warms the caches for the next message: the message last received, and an answer to it, pass once more
  /// through the protocol and the system, on separate sockets. Nothing goes to the arm.
  virtual void WarmUp(const ArmCommand& /*command*/) OSTEON_RT {}
};

/// One reading of the force sensor.
struct ForceReading {
  rt::Nanoseconds stamp{0};  ///< 0: none yet
  PlainWrench F_S;           ///< on the sensor's tool side, at S's origin, in S; the tool's weight is in it
  bool trusted{true};        ///< false: beyond the sensor's range, or it reports a fault of its own
};

/// One reading of the reamer's drive.
struct SpindleReading {
  rt::Nanoseconds stamp{0};     ///< 0: none yet
  double speed_rad_per_s{0.0};  ///< of the tool
  double torque_Nm{0.0};  ///< at the tool; includes friction and the torque that accelerates the spindle
  bool ready{false};      ///< configured, and its status arrives
  bool fault{false};      ///< the drive or its connection has a fault; latched by the drive's client
  // Causes of the fault: io::DescribeDriveFaults has the texts.
  std::uint8_t faults{0};           ///< io::DriveFault bits
  std::uint8_t nmt_state{0};        ///< NMT state in the drive's last heartbeat (CiA 301)
  std::uint16_t emergency_code{0};  ///< code of the drive's EMCY message (CiA 301); 0: none
  std::uint16_t error_code{0};      ///< object 603F (CiA 402); 0: none
};

/// One reading of the cell's PLC.
struct InterlockReading {
  rt::Nanoseconds stamp{0};       ///< 0: none yet
  bool permitted{false};          ///< the PLC permits motion; false while it is silent or stands still
  bool enabled{false};            ///< the enabling switch is in its middle position
  bool spindle_permitted{false};  ///< the foot pedal is pressed, and motion is permitted
  std::uint8_t reason{0};         ///< why not permitted: io::PlcVerdict; 0: permitted
};

/// Readings of the cell's devices beside the arm.
struct CellReadings {
  ForceReading force{};
  SpindleReading spindle{};
  InterlockReading interlock{};
};

/// Commands to these devices.
struct CellCommands {
  bool motion_requested{false};  ///< asks the PLC to permit motion
  double spindle_rad_per_s{0.0};
  bool quick_stop{false};  ///< stops the spindle along its steepest ramp
  /// Latched faults of the drive may be reset: before the first motion, and in a recovery.
  bool clear_faults{false};
};

/// Force sensor, spindle and PLC.
class CellDevices {
 public:
  virtual ~CellDevices() = default;
  /// Passes the commands on and takes the newest readings; never waits.
  [[nodiscard]] virtual CellReadings Exchange(const CellCommands& commands,
                                              rt::Nanoseconds now) OSTEON_RT = 0;
};

/// Stores the records of ticks.
class TickRecorder {
 public:
  virtual ~TickRecorder() = default;
  /// Takes a record. False if the recorder is behind; the tick goes on.
  virtual bool Push(const TickRecord& record) OSTEON_RT = 0;
  /// Whether so many records wait in the recorder that some will soon be lost. Called from the tick's thread.
  [[nodiscard]] virtual bool Stalled() const OSTEON_RT { return false; }
};

}  // namespace osteon::control
