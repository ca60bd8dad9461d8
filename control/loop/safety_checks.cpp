#include "control/loop/safety_checks.h"

namespace osteon::control {

using safety::Fault, safety::FaultSet;

SafetyChecks::SafetyChecks(const ServoParams& params, double max_force_N)
    : params_(params),
      rate_trip_(params.coupling.max_stiffness_N_per_m, params.twist.max_speed_m_per_s),
      sensor_trip_(params.sensor_force, max_force_N),
      spindle_trip_(params.spindle_limits),
      watchdog_(params.watchdog),
      arm_speed_(ArmSpeedParams{}, params.period_s) {}

void SafetyChecks::OnMotionStarted(rt::Nanoseconds now) OSTEON_RT {
  watchdog_.Start(now);
  spindle_trip_.Reset();
}

void SafetyChecks::OnRenderingStarted(rt::Nanoseconds now) OSTEON_RT {
  OnMotionStarted(now);
  rate_trip_.Reset();
}

FaultSet SafetyChecks::CheckDevices(const CellReadings& readings, const InputAges& ages,
                                    rt::Nanoseconds now) OSTEON_RT {
  FaultSet faults;
  safety::Ages watched{.model_s = ages.model_s};
  if (params_.has_interlock) {
    watched.interlock_s = safety::StampAge(now, readings.interlock.stamp);
    if (!readings.interlock.permitted || !readings.interlock.enabled) faults.Latch(Fault::kInterlock);
  }
  faults.Latch(watchdog_.Check(now, watched));
  faults.Latch(CheckSensor(readings.force, ages.sensor_s, now));
  faults.Latch(CheckSpindle(readings.spindle, now));
  return faults;
}

FaultSet SafetyChecks::CheckSensor(const ForceReading& reading, double age_s,
                                   rt::Nanoseconds now) const OSTEON_RT {
  FaultSet faults = watchdog_.Check(now, {.sensor_s = age_s});
  if (!reading.trusted) faults.Latch(Fault::kSensorFault);
  return faults;
}

FaultSet SafetyChecks::CheckSpindle(const SpindleReading& reading, rt::Nanoseconds now) OSTEON_RT {
  if (!params_.has_spindle) return {};
  FaultSet faults = watchdog_.Check(now, {.spindle_s = safety::StampAge(now, reading.stamp)});
  if (!reading.ready || reading.fault) faults.Latch(Fault::kSpindle);
  if (spindle_trip_.Check(reading.torque_Nm, reading.speed_rad_per_s, params_.period_s))
    faults.Latch(Fault::kSpindleLimit);
  return faults;
}

FaultSet SafetyChecks::CheckHand(const Wrench& F_hand_T_W) OSTEON_RT {
  FaultSet faults;
  if (!safety::IsFinite(F_hand_T_W)) {
    faults.Latch(Fault::kNotFinite);
    return faults;
  }
  hand_N_ = F_hand_T_W.f.stableNorm();
  if (sensor_trip_.Check(hand_N_)) faults.Latch(Fault::kSensorForce);
  return faults;
}

FaultSet SafetyChecks::CheckCoupling(const CouplingOutput& coupling, double dt_s) OSTEON_RT {
  FaultSet faults;
  if (!safety::IsFinite(coupling.F_T_W)) faults.Latch(Fault::kNotFinite);
  if (coupling.status == ModelStatus::kDeviceLost) faults.Latch(Fault::kDevice);
  if (coupling.status == ModelStatus::kNotCredible) faults.Latch(Fault::kNotFinite);
  if (rate_trip_.Check(coupling.F_T_W.f, dt_s)) faults.Latch(Fault::kWrenchRate);
  return faults;
}

FaultSet SafetyChecks::CheckArmSpeed(const ArmState& state, const Vector3& p_WT,
                                     double limit_m_per_s) OSTEON_RT {
  FaultSet faults;
  if (arm_speed_.Check(state, p_WT, limit_m_per_s)) faults.Latch(Fault::kArmSpeed);
  return faults;
}

bool SafetyChecks::IsMotionPermitted(const InterlockReading& reading, rt::Nanoseconds now) const OSTEON_RT {
  return !params_.has_interlock ||
         (reading.permitted && reading.enabled &&
          safety::StampAge(now, reading.stamp) <= params_.watchdog.interlock_stop_s);
}

bool SafetyChecks::IsSensorReady(const ForceReading& reading, rt::Nanoseconds now) const OSTEON_RT {
  return reading.trusted && safety::StampAge(now, reading.stamp) <= params_.watchdog.sensor_stop_s &&
         Vector3(reading.F_S.f).stableNorm() <= sensor_trip_.level_N() && safety::IsFinite(reading.F_S);
}

bool SafetyChecks::IsSpindleReady(const SpindleReading& reading, rt::Nanoseconds now) const OSTEON_RT {
  return !params_.has_spindle || (reading.ready && !reading.fault &&
                                  safety::StampAge(now, reading.stamp) <= params_.watchdog.spindle_stop_s);
}

}  // namespace osteon::control
