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

/// Ages of what a tick was given [s]; safety::kNoAge_s: there is none.
struct InputAges {
  double model_s{0.0};   ///< of the contact model's pose
  double sensor_s{0.0};  ///< of the force reading
};

/// Conditions that must stop the cell, of devices, hand, coupling and arm. Each check returns the faults that
/// it finds and moves nothing; which of them apply in a state is the servo loop's to say:
///
/// | the arm | sensor | spindle | interlock, model | hand | coupling | speed |
/// |---|---|---|---|---|---|---|
/// | goes to its start | x | x | it rests instead | x | | x |
/// | renders | x | x | x | x | x | x |
/// | brakes for a pause (stop 2) | x | x | x | x | device lost | x |
/// | brakes for good (stop 1) | x | | | x | | x |
class SafetyChecks {
 public:
  /// @param max_force_N  that the coupling may render
  /// @throws std::invalid_argument naming the parameter, the value and what is accepted.
  SafetyChecks(const ServoParams& params, double max_force_N);

  /// Motion begins: each source has its full time to show up, and the spindle's torque is forgotten.
  void OnMotionStarted(rt::Nanoseconds now) OSTEON_RT;
  /// Rendering begins: the next force of the coupling counts from zero.
  void OnRenderingStarted(rt::Nanoseconds now) OSTEON_RT;

  /// Ages, sensor, spindle and the PLC's permission of a cell that renders or brakes for a pause.
  [[nodiscard]] safety::FaultSet CheckDevices(const CellReadings& readings, const InputAges& ages,
                                              rt::Nanoseconds now) OSTEON_RT;
  /// The force sensor: young enough, and trusted by itself.
  [[nodiscard]] safety::FaultSet CheckSensor(const ForceReading& reading, double age_s,
                                             rt::Nanoseconds now) const OSTEON_RT;
  /// The reamer's drive: young enough, in order, within its torque. Nothing where the cell has none.
  [[nodiscard]] safety::FaultSet CheckSpindle(const SpindleReading& reading, rt::Nanoseconds now) OSTEON_RT;
  /// The hand's force. @param F_hand_T_W  on the tool
  [[nodiscard]] safety::FaultSet CheckHand(const Wrench& F_hand_T_W) OSTEON_RT;
  /// The coupling before its limits: credible, and not faster than any contact.
  /// @param dt_s  between the tool's poses of this coupling and of the last
  [[nodiscard]] safety::FaultSet CheckCoupling(const CouplingOutput& coupling, double dt_s) OSTEON_RT;
  /// How fast the arm is measured to move the tool. @param limit_m_per_s  that the loop keeps
  [[nodiscard]] safety::FaultSet CheckArmSpeed(const ArmState& state, const Vector3& p_WT,
                                               double limit_m_per_s) OSTEON_RT;
  /// The arm moves by itself: nobody is answerable for its speed.
  void ResetArmSpeed() OSTEON_RT { arm_speed_.Reset(); }

  /// The PLC permits motion, freshly, and the enabling switch is held; of a cell without one always.
  [[nodiscard]] bool IsMotionPermitted(const InterlockReading& reading, rt::Nanoseconds now) const OSTEON_RT;
  /// A reading at rest with which motion may begin.
  [[nodiscard]] bool IsSensorReady(const ForceReading& reading, rt::Nanoseconds now) const OSTEON_RT;
  /// A drive with which motion may begin; of a cell without one always.
  [[nodiscard]] bool IsSpindleReady(const SpindleReading& reading, rt::Nanoseconds now) const OSTEON_RT;

  /// Share of the hand's force that the reading's age lets through, 0 … 1.
  [[nodiscard]] double SensorShare(double age_s) const OSTEON_RT { return watchdog_.SensorShare(age_s); }
  /// The hand's force in the last CheckHand whose wrench was finite.
  [[nodiscard]] double hand_N() const OSTEON_RT { return hand_N_; }
  /// Beyond it the hand pushes too hard.
  [[nodiscard]] double max_hand_N() const OSTEON_RT { return sensor_trip_.level_N(); }
  /// By which the coupling's force grew or turned in the last CheckCoupling [N].
  [[nodiscard]] double wrench_growth_N() const OSTEON_RT { return rate_trip_.growth_N(); }
  /// And by which it may within dt_s.
  [[nodiscard]] double max_wrench_growth_N(double dt_s) const OSTEON_RT {
    return rate_trip_.max_rate_N_per_s() * dt_s;
  }
  /// The arm's speed in the last CheckArmSpeed.
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
