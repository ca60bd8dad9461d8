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
  std::uint8_t node{16};          ///< 1 … 127; at least 16 if an ATI sensor is on the same bus
  std::uint8_t master_node{127};  ///< the controller's node, whose heartbeat the drive watches
  std::int8_t mode{3};            ///< 3 profile velocity, 9 cyclic synchronous velocity
  double gear_ratio{1.0};         ///< turns of the motor per turn of the tool
  /// Rated torque of the motor; no default. Must match object 6076 of the drive within 1 %.
  double rated_torque_Nm{0.0};
  int direction{1};                 ///< 1 or -1: the motor's direction for a positive tool speed
  double max_speed_rad_per_s{0.0};  ///< largest speed of the tool; commands are clamped to it. No default
  double acceleration_rad_per_s2{100.0};        ///< acceleration and deceleration of the tool
  double quick_stop_rad_per_s2{400.0};          ///< deceleration of the tool in a quick stop
  rt::Nanoseconds cycle{4 * rt::kMillisecond};  ///< period of command, SYNC and status
  /// Period of the drive's and the controller's heartbeat, in whole ms.
  rt::Nanoseconds heartbeat{50 * rt::kMillisecond};
  int missed_heartbeats{3};  ///< number of consecutive missing heartbeats that count as a loss, on both sides
  int missed_cycles{10};     ///< number of consecutive missing status PDOs that count as a loss
  rt::Nanoseconds answer_timeout{100 * rt::kMillisecond};  ///< longest time to wait for the answer to an SDO
  int attempts{3};                                         ///< largest number of times that an SDO is sent
  /// The manufacturer's object of the temperature, an i16 (CiA 402 defines none). Accepted size: 2 bytes.
  canopen::Object temperature{0x3201, 0x01, 2};
};

/// Faults of the drive; latched until ResetFaults().
enum DriveFault : std::uint32_t {
  kDriveHeartbeatLost = 1u << 0,  ///< missed_heartbeats consecutive heartbeats are missing
  kDriveStatusLost = 1u << 1,     ///< missed_cycles consecutive status PDOs are missing
  kDriveEmergency = 1u << 2,      ///< the drive sent an EMCY; see DriveStatus::emergency_code
  kDriveInFault = 1u << 3,      ///< the drive's state is fault or fault reaction; see DriveStatus::error_code
  kDriveRestarted = 1u << 4,    ///< the drive booted and lost its configuration
  kDriveLeftEnabled = 1u << 5,  ///< the drive left the state "operation enabled" without a command
  /// The drive's heartbeat reports another NMT state; see DriveStatus::nmt_state.
  kDriveLeftOperational = 1u << 6,
};

enum class DrivePhase : std::uint8_t {
  kStarting,  ///< the drive is being configured
  kReady,     ///< the drive is operational and sends status PDOs
  kFailed,    ///< the drive was refused; failure() gives the reason, Restart() tries again
};

struct DriveCommand {
  DriveGoal goal{DriveGoal::kOff};
  /// Wanted speed of the tool; used if the goal is kEnabled. If not finite, 0 is used.
  double speed_rad_per_s{0.0};
};

struct DriveStatus {
  rt::Nanoseconds stamp{0};  ///< time of arrival of the newest status PDO; 0: none yet
  DriveState state{DriveState::kNotReady};
  double speed_rad_per_s{0.0};  ///< of the tool
  double torque_Nm{0.0};  ///< torque at the tool: reported share of the rated torque × rated torque × gear
                          ///< ratio, without losses
  double temperature{0.0};  ///< in the manufacturer's unit
  std::uint16_t statusword{0};
  std::uint8_t nmt_state{0xFF};     ///< canopen::NmtState in the drive's last heartbeat
  std::uint16_t error_code{0};      ///< value of object 603F
  std::uint16_t emergency_code{0};  ///< of the last EMCY; 0 after an EMCY "reset" with nothing latched
  std::uint32_t faults{0};          ///< DriveFault bits
};

/// Client of the reamer's drive, a CiA 402 servo on CANopen.
///
/// Set-up: NMT command "pre-operational"; check that object 1000 contains profile 402 and object 6076 the
/// rated torque; write ramps, heartbeats, quick stop and the three PDOs by SDO; NMT command "start".
///
///     RPDO1  controlword u16, mode i8, target velocity i32 (motor rpm)      applied at SYNC
///     TPDO1  statusword u16, mode i8, velocity i32 (motor rpm)              after each SYNC
///     TPDO2  torque i16 (per mille of rated), error u16, temperature i16    after each SYNC
///
/// Afterwards RPDO1 and SYNC are sent once per `cycle`. Each side monitors the other side's heartbeat. If the
/// drive is silent, this class latches a fault. If the controller is silent, the drive changes to its fault
/// state and stops with its quick-stop deceleration.
///
/// While a fault is latched, every goal except kOff is replaced by kQuickStop until ResetFaults(), so the
/// drive never starts by itself. ResetFaults() also resets a fault state of the drive, by a rising edge of
/// controlword bit 7.
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
    // If the drive is commanded to leave "operation enabled", it does not leave that state by itself. This
    // holds even if it is commanded to be enabled again before its next status arrives.
    if (command.goal != DriveGoal::kEnabled) was_enabled_ = false;
  }
  [[nodiscard]] const DriveStatus& status() const OSTEON_RT { return status_; }
  [[nodiscard]] DrivePhase phase() const OSTEON_RT { return phase_; }

  /// Clears latched faults, and resets a fault state of the drive. Configures the drive again if it has
  /// booted or left OPERATIONAL. Returns false and does nothing if the commanded goal is not kOff, because
  /// the drive would then start by itself, or during a fault reaction.
  bool ResetFaults() OSTEON_RT;

  /// Whether a reset can reach the drive: heartbeat and status arrive, or the drive has just booted.
  [[nodiscard]] bool IsHeard(rt::Nanoseconds now) const OSTEON_RT {
    return set_up_lost_ || (!HeartbeatIsLost(now) && !StatusIsLost(now));
  }
  /// Whether the drive was refused, a fault is latched, or the drive's state is fault. True also during a
  /// reset, although no fault is latched any more.
  [[nodiscard]] bool faulty() const OSTEON_RT {
    return phase_ == DrivePhase::kFailed || status_.faults != 0 || status_.state == DriveState::kFault ||
           status_.state == DriveState::kFaultReaction;
  }

  /// Configures the drive again, e.g. after kDriveRestarted.
  void Restart() OSTEON_RT;

  /// Whether the phase is kFailed because the drive never answered or never became operational. Possibly the
  /// drive is not switched on yet.
  [[nodiscard]] bool silent() const OSTEON_RT {
    return phase_ == DrivePhase::kFailed && (wrong_ == Failure::kSilent || wrong_ == Failure::kNotStarted);
  }
  /// Returns why the drive was refused; empty unless the phase is kFailed. Not for use in the tick.
  [[nodiscard]] std::string failure() const;

  [[nodiscard]] std::uint64_t rejected() const OSTEON_RT {
    return rejected_;
  }  ///< frames of a wrong size or content

 private:
  // One SDO of the set-up.
  struct Step {
    enum class Kind : std::uint8_t { kRead, kWrite } kind;
    canopen::Object object;
    std::uint32_t value;  // value to write, or value expected when read
    std::uint32_t mask;  // bits of the value read that are compared; 0: compare with the rated torque instead
  };
  enum class Failure : std::uint8_t { kNothing, kSilent, kAborted, kValue, kNotStarted };

  explicit ReamerDrive(const ReamerDriveParams& params);
  // Checks the answer to the present step, and continues with the next step.
  void HandleSdo(const CanFrame& frame) OSTEON_RT;
  void HandleHeartbeat(const CanFrame& frame, rt::Nanoseconds stamp) OSTEON_RT;
  // Reads TPDO1 or TPDO2.
  void HandleStatus(const CanFrame& frame, rt::Nanoseconds stamp) OSTEON_RT;
  // Latches kDriveHeartbeatLost and kDriveStatusLost if they occur.
  void LatchTimeouts(rt::Nanoseconds now) OSTEON_RT;
  [[nodiscard]] bool HeartbeatIsLost(rt::Nanoseconds now) const OSTEON_RT;
  [[nodiscard]] bool StatusIsLost(rt::Nanoseconds now) const OSTEON_RT;
  void Latch(DriveFault fault) OSTEON_RT;
  // Implements Next() while the phase is kStarting.
  bool NextSetUpFrame(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT;
  // Returns RPDO1 with controlword, mode and target velocity.
  [[nodiscard]] CanFrame CommandFrame() OSTEON_RT;
  [[nodiscard]] std::uint16_t Controlword() OSTEON_RT;
  // Ends the set-up in kFailed. @param found the value read or the abort code, for failure()
  void Fail(Failure wrong, std::uint32_t found) OSTEON_RT;

  ReamerDriveParams params_;
  std::vector<Step> steps_;  // steps of the set-up, filled once
  DrivePhase phase_{DrivePhase::kStarting};
  std::size_t step_{0};  // index into steps_; steps_.size(): NMT start is due; one more: NMT start was sent
  bool quiet_{false};    // NMT pre-operational was sent
  int attempts_{0};      // number of attempts of the present step
  rt::Nanoseconds due_{0};  // time of the next frame of the set-up
  Failure wrong_{Failure::kNothing};
  std::uint32_t found_{0};

  DriveCommand command_;
  DriveStatus status_;
  bool was_enabled_{false};  // the drive was enabled in the last status, and is commanded to be
  bool set_up_lost_{false};  // the drive booted, or left OPERATIONAL
  int reset_cycles_{0};      // number of controlwords of a fault reset still to send
  bool sync_due_{false};
  rt::Nanoseconds next_cycle_{0}, next_heartbeat_{0};
  rt::Nanoseconds heard_{0};  // time of the last heartbeat
  rt::Nanoseconds ready_since_{0};
  std::uint64_t rejected_{0};
};

/// Identifiers that the bus must deliver for this drive.
[[nodiscard]] std::vector<CanFilter> Filters(const ReamerDriveParams& params);

}  // namespace osteon::io
