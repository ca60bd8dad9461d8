#pragma once

#include <cstdint>

#include "hil/can/drive_motor.h"
#include "hil/can/frame_queue.h"
#include "hil/can/object_dictionary.h"
#include "io/can/can_pump.h"

namespace osteon::hil {

struct DriveDeviceParams {
  DriveMotorParams motor{};
  int node{16};
  double friction_Nm{0.0};  ///< friction torque of motor and gear, at the motor
  /// Time at rest with the torque at its limit after which error 7121 (motor blocked) occurs.
  double stall_s{0.2};
  rt::Nanoseconds boot{100 * rt::kMillisecond};  ///< time from power-on to the boot-up message
};

/// Simulates the reamer's drive: a CiA 402 servo on CANopen, written independently of io/can. It models the
/// object dictionary with SDO access, PDO mapping (can be changed only while the PDO is off and the drive is
/// pre-operational), NMT, SYNC, heartbeats in both directions, EMCY, the whole state machine, ramps, quick
/// stop, and faults with their reactions.
///
/// Quick stop follows option code 605A: 0 changes to switch on disabled at once, so the motor coasts; 1 and 2
/// brake (with deceleration 6084, 6085) and then change to switch on disabled; 5 and 6 brake in the same way
/// and stay in quick stop active. Other codes are refused. 605E, for faults, accepts 0, 1 and 2. Bit 10 of
/// the statusword, target reached: in mode 3, the velocity (606C) has been within the window 606D (rpm of the
/// motor) of the target 60FF for the time 606E (ms); with 605A at 5 or 6, the quick stop is finished.
///
/// The motor runs in virtual time: each call advances it to the call's time, in steps of 0.1 ms. A CanPump
/// exchanges the device's frames with a bus, as for any CanClient.
class DriveDevice final : public io::CanClient {
 public:
  /// @throws std::invalid_argument on a node outside 1 … 127, or a motor parameter that DriveMotor does not
  /// accept.
  explicit DriveDevice(const DriveDeviceParams& params);

  /// Sets the cutting torque from now on: a braking torque at the tool; its sign is ignored.
  void SetCuttingTorque(double at_the_tool_Nm);
  /// Starts a fault of the device, e.g. 0x4310 (drive too hot). The fault stays until `ClearFault`; a fault
  /// reset does not clear it.
  void InjectFault(int error_code);
  void ClearFault() { broken_ = 0; }
  /// Sets a fault that the drive boots with from now on, e.g. 0x3220 (under-voltage of the DC link); a fault
  /// reset clears it. 0: none.
  void SetBootError(int error_code) { boot_error_ = error_code; }
  /// Sends an EMCY; does not change the state.
  void SendEmergency(int error_code);
  /// Switches the supply. Off: the drive sends nothing, coasts and loses all settings. On: it boots.
  void SetPower(bool on);
  /// Number of rising edges of controlword bit 7 (fault reset) so far, in any state.
  [[nodiscard]] int resets() const { return resets_; }

  void Accept(const io::CanArrival& arrival) OSTEON_RT override;
  bool Next(rt::Nanoseconds now, io::CanFrame& frame) OSTEON_RT override;

  [[nodiscard]] double tool_speed_rad_per_s() const {
    return motor_.speed_rad_per_s() / params_.motor.gear_ratio;
  }
  [[nodiscard]] const DriveMotor& motor() const { return motor_; }
  [[nodiscard]] int statusword() const;

 private:
  enum class State {
    kNotReady,
    kDisabled,
    kReady,
    kSwitchedOn,
    kEnabled,
    kQuickStop,
    kFaultReaction,
    kFault
  };

  void Boot();  // sets objects and state to those at power-on
  // Advances the motor to the time `now`.
  void AdvanceTo(rt::Nanoseconds now) noexcept;
  void StepMotor(double dt_s) noexcept;
  void HandleControlword(int word) noexcept;
  void StartQuickStop() noexcept;
  [[nodiscard]] bool StaysInQuickStop() const noexcept;
  [[nodiscard]] int StopRamp() const noexcept;
  [[nodiscard]] bool AtRest() const noexcept;
  [[nodiscard]] bool InVelocityWindow() const noexcept;
  [[nodiscard]] bool TargetReached() const noexcept;
  void Trip(int error_code) noexcept;
  void HandleRpdo() noexcept;
  void SendTpdo(int number) noexcept;
  void UpdateStatusObjects() noexcept;
  void HandleNmtCommand(int command) noexcept;
  static std::uint32_t ValidateWrite(void* self, const DictionaryEntry& entry, std::uint32_t value);

  DriveDeviceParams params_;
  DriveMotor motor_;
  ObjectDictionary objects_;
  FrameQueue queue_;
  State state_{State::kNotReady};
  int nmt_{0};  // NMT state: 0 booting, 127 pre-operational, 5 operational, 4 stopped
  bool power_{true};
  int last_control_{0};            // the last controlword
  int error_{0};                   // error code of the present fault, 0: none
  int broken_{0}, boot_error_{0};  // injected errors: present until ClearFault; raised at the next boot
  int resets_{0};
  double cutting_Nm_{0.0};
  double ramp_rad_per_s_{0.0};    // set point of the velocity loop
  double stalled_s_{0.0};         // time at rest at the torque limit
  rt::Nanoseconds in_window_{0};  // time for which the velocity has been within the window of its target
  rt::Nanoseconds time_{-1}, boot_due_{0}, heartbeat_due_{0}, master_heard_{-1};
  io::CanFrame rpdo_;  // the PDO received last; fresh until it has been applied
  bool rpdo_fresh_{false};
};

}  // namespace osteon::hil
