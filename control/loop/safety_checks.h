#pragma once

#include "base/marker.h"
#include "control/arm/arm_speed_watch.h"
#include "control/coupling/virtual_coupling.h"
#include "control/ports.h"
#include "control/setup/servo_params.h"
#include "safety/fault.h"
#include "safety/limits.h"
#include "safety/spindle_trip.h"
#include "safety/watchdog.h"

namespace osteon::control {

/// Ages of a tick's inputs [s]. An input that never arrived has the age safety::kNoAge_s.
struct InputAges {
  double model_s{0.0};   ///< age of the pose that the contact model was computed for
  double sensor_s{0.0};  ///< age of the force reading
};

/// Checks devices, hand's force, coupling and arm for conditions that must stop the cell. Each check returns
/// the faults that it finds; it does not change the motion. MotionChecks and HapticRendering run the checks
/// that each state needs (x):
///
/// | the arm | sensor | spindle | interlock, model | hand | coupling | speed |
/// |---|---|---|---|---|---|---|
/// | goes to its start | x | x | the path pauses instead | x | | x |
/// | renders | x | x | x | x | x | x |
/// | brakes for a pause (stop 2) | x | x | x | x | lost device only | x |
/// | brakes to end the motion (stop 1) | x | | | x | | x |
class SafetyChecks {
 public:
  /// @param max_force_N  largest force that the coupling may render
  /// @throws std::invalid_argument naming the parameter, the value and what is accepted.
  SafetyChecks(const ServoParams& params, double max_force_N);

  /// Call when motion starts. Each input gets its full time limit again for its first value. Resets the check
  /// of the spindle's torque.
  void OnMotionStarted(rt::Nanoseconds now) OSTEON_RT;
  /// Call when rendering starts. Does the same as OnMotionStarted, and also resets the check of the
  /// coupling's force, which then begins at zero.
  void OnRenderingStarted(rt::Nanoseconds now) OSTEON_RT;

  /// Checks the inputs' ages, the sensor, the spindle and the PLC's permission, while the cell renders or
  /// brakes for a pause.
  [[nodiscard]] safety::FaultSet CheckDevices(const CellReadings& readings, const InputAges& ages,
                                              rt::Nanoseconds now) OSTEON_RT;
  /// Checks that the force reading is recent, and that the sensor itself reports it as valid.
  [[nodiscard]] safety::FaultSet CheckSensor(const ForceReading& reading, double age_s,
                                             rt::Nanoseconds now) const OSTEON_RT;
  /// Checks that the drive's reading is recent and without a fault, and that torque and speed are within
  /// their limits. In a cell without a drive, it finds no fault.
  [[nodiscard]] safety::FaultSet CheckSpindle(const SpindleReading& reading, rt::Nanoseconds now) OSTEON_RT;
  /// Checks that the hand's wrench on the tool is finite, and its force not too large.
  [[nodiscard]] safety::FaultSet CheckHand(const Wrench& F_hand_T_W) OSTEON_RT;
  /// Checks the coupling's wrench before it is limited. It must be finite, be computed from a credible
  /// contact model, and grow no faster than a real contact allows (safety::WrenchRateTrip).
  /// @param dt_s  time between the tool poses of this wrench and of the previously checked one
  [[nodiscard]] safety::FaultSet CheckCoupling(const CouplingOutput& coupling, double dt_s) OSTEON_RT;
  /// Checks the measured speed of the tool. @param limit_m_per_s  speed limit that the commanded motion keeps
  [[nodiscard]] safety::FaultSet CheckArmSpeed(const ArmState& state, const Vector3& p_WT,
                                               double limit_m_per_s) OSTEON_RT;
  /// Call while the loop does not command the arm: its speed is not checked then.
  void ResetArmSpeed() OSTEON_RT { arm_speed_.Reset(); }

  /// Whether a recent reading of the PLC permits motion and the enabling switch is held. True if the cell has
  /// no PLC.
  [[nodiscard]] bool IsMotionPermitted(const InterlockReading& reading, rt::Nanoseconds now) const OSTEON_RT;
  /// Whether motion may begin with this force reading: recent, valid, finite and not too large.
  [[nodiscard]] bool IsSensorReady(const ForceReading& reading, rt::Nanoseconds now) const OSTEON_RT;
  /// Whether motion may begin with the drive in this state. True if the cell has no drive.
  [[nodiscard]] bool IsSpindleReady(const SpindleReading& reading, rt::Nanoseconds now) const OSTEON_RT;

  /// Factor on the hand's force by the age of its reading, 0 … 1: an old reading is faded out.
  [[nodiscard]] double SensorFade(double age_s) const OSTEON_RT { return watchdog_.SensorFade(age_s); }
  /// The hand's force as of the last CheckHand with a finite wrench.
  [[nodiscard]] double hand_N() const OSTEON_RT { return hand_N_; }
  /// Force of the hand above which CheckHand finds a fault.
  [[nodiscard]] double max_hand_N() const OSTEON_RT { return sensor_trip_.level_N(); }
  /// Growth of the coupling's force found by the last CheckCoupling [N]. A change of direction also counts as
  /// growth.
  [[nodiscard]] double wrench_growth_N() const OSTEON_RT { return rate_trip_.growth_N(); }
  /// Largest growth of the coupling's force within dt_s that is no fault [N].
  [[nodiscard]] double max_wrench_growth_N(double dt_s) const OSTEON_RT {
    return rate_trip_.max_rate_N_per_s() * dt_s;
  }
  /// The tool's measured speed as of the last CheckArmSpeed.
  [[nodiscard]] double arm_speed_m_per_s() const OSTEON_RT { return arm_speed_.speed_m_per_s(); }

 private:
  const ServoParams& params_;
  safety::WrenchRateTrip rate_trip_;
  safety::SensorForceTrip sensor_trip_;
  safety::SpindleTrip spindle_trip_;
  safety::Watchdog watchdog_;
  ArmSpeedWatch arm_speed_;
  double hand_N_{0.0};
};

}  // namespace osteon::control
