#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/can/can_bus.h"
#include "io/can/can_pump.h"
#include "io/can/canopen.h"
#include "io/can/cia402.h"

namespace osteon::io {

struct ReamerDriveParams {
  std::uint8_t node{16};            ///< 1 … 127; at least 16 beside an ATI sensor
  std::uint8_t master_node{127};    ///< the controller's node, whose heartbeat the drive watches
  std::int8_t mode{3};              ///< 3 profile velocity, 9 cyclic synchronous velocity
  double gear_ratio{1.0};           ///< turns of the motor for each turn of the tool
  double rated_torque_Nm{0.0};      ///< of the motor; no default. Must match the drive's 6076 within 1 %
  int direction{1};                 ///< 1 or -1: the motor's direction for a positive tool speed
  double max_speed_rad_per_s{0.0};  ///< of the tool; commands beyond are clamped. No default
  double acceleration_rad_per_s2{100.0};             ///< of the tool, both up and down
  double quick_stop_rad_per_s2{400.0};               ///< of the tool
  rt::Nanoseconds cycle{4 * rt::kMillisecond};       ///< of command, SYNC and status
  rt::Nanoseconds heartbeat{50 * rt::kMillisecond};  ///< period of the drive's heartbeat and of ours, in
                                                     ///< whole ms
  int missed_heartbeats{3};                          ///< this many in a row are a loss, on both sides
  int missed_cycles{10};                             ///< this many missing status PDOs in a row are a
                                                     ///< loss
  rt::Nanoseconds answer_timeout{100 * rt::kMillisecond};  ///< for the answer to an SDO
  int attempts{3};                                         ///< an SDO is sent at most this often
  /// The maker's object for the temperature, an i16 (CiA 402 has none). Accepted size: 2 bytes.
  canopen::Object temperature{0x3201, 0x01, 2};
};

/// Faults of the drive; latched until ResetFaults().
enum DriveFault : std::uint32_t {
  kDriveHeartbeatLost = 1u << 0,    ///< missed_heartbeats heartbeats in a row did not come
  kDriveStatusLost = 1u << 1,       ///< missed_cycles status PDOs in a row did not come
  kDriveEmergency = 1u << 2,        ///< it sent an EMCY; DriveStatus::emergency_code
  kDriveInFault = 1u << 3,          ///< its state is fault or fault reaction; DriveStatus::error_code
  kDriveRestarted = 1u << 4,        ///< the drive booted and lost its configuration
  kDriveLeftEnabled = 1u << 5,      ///< was enabled and left that state without a command
  kDriveLeftOperational = 1u << 6,  ///< its heartbeat reports another NMT state; DriveStatus::nmt_state
};

enum class DrivePhase : std::uint8_t {
  kStarting,  ///< being configured
  kReady,     ///< operational; status comes
  kFailed,    ///< refused; failure() gives the reason. Restart() tries again
};

struct DriveCommand {
  DriveGoal goal{DriveGoal::kOff};
  double speed_rad_per_s{0.0};  ///< of the tool; used if the goal is kEnabled. Not finite: 0
};

struct DriveStatus {
  rt::Nanoseconds stamp{0};  ///< of the newest status PDO; 0: none yet
  DriveState state{DriveState::kNotReady};
  double speed_rad_per_s{0.0};  ///< of the tool
  double torque_Nm{0.0};        ///< at the tool: per mille of rated × rated torque × gear ratio; no losses
  double temperature{0.0};      ///< in the maker's unit
  std::uint16_t statusword{0};
  std::uint8_t nmt_state{0xFF};     ///< canopen::NmtState, from its heartbeat
  std::uint16_t error_code{0};      ///< 603F
  std::uint16_t emergency_code{0};  ///< of the last EMCY; 0 after an EMCY "reset" with nothing latched
  std::uint32_t faults{0};          ///< DriveFault
};

/// The reamer's drive: a CiA 402 servo on CANopen.
///
/// Set-up: NMT pre-operational; 1000 must contain profile 402 and 6076 the rated torque; ramps, heartbeats,
/// quick stop and the three PDOs by SDO; NMT start.
///
///     RPDO1  controlword u16, mode i8, target velocity i32 (motor rpm)      applied at SYNC
///     TPDO1  statusword u16, mode i8, velocity i32 (motor rpm)              after each SYNC
///     TPDO2  torque i16 (per mille of rated), error u16, temperature i16    after each SYNC
///
/// Afterwards RPDO1 and SYNC are sent once per `cycle`. Both sides watch the other's heartbeat. A silent
/// drive is a latched fault here. If we are silent, the drive faults and stops along its quick-stop ramp.
///
/// Any fault changes the goal to kOff (kQuickStop if the drive can still be reached and turns) until
/// ResetFaults(): the drive never starts by itself. A fault of the drive itself is then reset by a rising
/// edge of controlword bit 7.
///
/// Source: CiA 301 4.2, CiA 402 (IEC 61800-7-201).
class ReamerDrive final : public CanClient {
 public:
  /// The error names the parameter, the value found and what is accepted.
  [[nodiscard]] static tl::expected<ReamerDrive, std::string> Make(const ReamerDriveParams& params);

  void Accept(const CanArrival& arrival) OSTEON_RT override;
  bool Next(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT override;

  void Command(const DriveCommand& command) OSTEON_RT {
    command_ = command;
    // A drive that is told to leave "operation enabled" did not leave it by itself, even if it is enabled
    // again before its next status arrives.
    if (command.goal != DriveGoal::kEnabled) was_enabled_ = false;
  }
  [[nodiscard]] const DriveStatus& status() const OSTEON_RT { return status_; }
  [[nodiscard]] DrivePhase phase() const OSTEON_RT { return phase_; }

  /// Clears latched faults, and resets a fault of the drive; configures the drive again if it has booted or
  /// left OPERATIONAL. Returns false and does nothing unless the command is kOff: with any other the drive
  /// would start by itself. Also false during a fault reaction.
  bool ResetFaults() OSTEON_RT;

  /// Whether a reset can reach the drive: heartbeat and status come, or it has just booted.
  [[nodiscard]] bool IsHeard(rt::Nanoseconds now) const OSTEON_RT {
    return set_up_lost_ || (!HeartbeatIsLost(now) && !StatusIsLost(now));
  }
  /// Whether the drive was refused, a fault is latched, or the drive's state is a fault. Also true during a
  /// reset, when nothing is latched any more.
  [[nodiscard]] bool faulty() const OSTEON_RT {
    return phase_ == DrivePhase::kFailed || status_.faults != 0 || status_.state == DriveState::kFault ||
           status_.state == DriveState::kFaultReaction;
  }

  /// Configures the drive again, e.g. after kDriveRestarted.
  void Restart() OSTEON_RT;

  /// Whether the phase is kFailed because the drive never answered or never became operational: it may not be
  /// switched on yet.
  [[nodiscard]] bool silent() const OSTEON_RT {
    return phase_ == DrivePhase::kFailed && (wrong_ == Failure::kSilent || wrong_ == Failure::kNotStarted);
  }
  /// Why the drive was refused. Empty unless kFailed. Not for the tick.
  [[nodiscard]] std::string failure() const;

  [[nodiscard]] std::uint64_t rejected() const OSTEON_RT {
    return rejected_;
  }  ///< frames of a wrong size or content

 private:
  // One SDO of the set-up.
  struct Step {
    enum class Kind : std::uint8_t { kRead, kWrite } kind;
    canopen::Object object;
    std::uint32_t value;  // to write, or expected when read
    std::uint32_t mask;   // for the value read; 0: the rated torque
  };
  enum class Failure : std::uint8_t { kNothing, kSilent, kAborted, kValue, kNotStarted };

  explicit ReamerDrive(const ReamerDriveParams& params);
  // Checks the answer to the present step, and goes on to the next step.
  void HandleSdo(const CanFrame& frame) OSTEON_RT;
  void HandleHeartbeat(const CanFrame& frame, rt::Nanoseconds stamp) OSTEON_RT;
  // Reads TPDO1 or TPDO2.
  void HandleStatus(const CanFrame& frame, rt::Nanoseconds stamp) OSTEON_RT;
  // Latches a lost heartbeat and missing status PDOs.
  void LatchTimeouts(rt::Nanoseconds now) OSTEON_RT;
  [[nodiscard]] bool HeartbeatIsLost(rt::Nanoseconds now) const OSTEON_RT;
  [[nodiscard]] bool StatusIsLost(rt::Nanoseconds now) const OSTEON_RT;
  void Latch(DriveFault fault) OSTEON_RT;
  // Next() while the phase is kStarting.
  bool NextSetUpFrame(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT;
  // RPDO1 with the controlword, mode and target velocity.
  [[nodiscard]] CanFrame CommandFrame() OSTEON_RT;
  [[nodiscard]] std::uint16_t Controlword() OSTEON_RT;
  // @param found  the value read or the abort code, for failure()
  void Fail(Failure wrong, std::uint32_t found) OSTEON_RT;

  ReamerDriveParams params_;
  std::vector<Step> steps_;  // filled once
  DrivePhase phase_{DrivePhase::kStarting};
  std::size_t step_{0};     // of steps_; its size: NMT start is due; one more: NMT start was sent
  bool quiet_{false};       // NMT pre-operational was sent
  int attempts_{0};         // of the present step
  rt::Nanoseconds due_{0};  // time of the next frame of the set-up
  Failure wrong_{Failure::kNothing};
  std::uint32_t found_{0};

  DriveCommand command_;
  DriveStatus status_;
  bool was_enabled_{false};  // in the last status, and commanded to be
  bool set_up_lost_{false};  // the drive booted, or left OPERATIONAL
  int reset_cycles_{0};      // controlwords of a fault reset still to send
  bool sync_due_{false};
  rt::Nanoseconds next_cycle_{0}, next_heartbeat_{0};
  rt::Nanoseconds heard_{0};  // time of the last heartbeat
  rt::Nanoseconds ready_since_{0};
  std::uint64_t rejected_{0};
};

/// Identifiers that the bus must deliver for this drive.
[[nodiscard]] std::vector<CanFilter> Filters(const ReamerDriveParams& params);

}  // namespace osteon::io
