#include "control/sensing/hand_force.h"

#include "safety/watchdog.h"

namespace osteon::control {

HandForce::HandForce(const ServoParams& params, const Pose& X_FT)
    : sensor_(params.sensor),
      X_TF_(X_FT.inverse()),
      bias_(params.law == Law::kAdmittance ? CreepBound(params.sensor_bias, params.admittance)
                                           : params.sensor_bias,
            params.sensor, params.period_s) {}

void HandForce::SetTool(const ForceSensorParams& sensor, const Pose& X_FT) OSTEON_RT {
  sensor_ = sensor;
  X_TF_ = X_FT.inverse();
}

void HandForce::EstimateBias(const ForceReading& reading, const Pose& X_WT) OSTEON_RT {
  bias_.AddReading(reading.F_S, X_WT * X_TF_);
}

void HandForce::ResetMotion(const Pose& X_WT) OSTEON_RT {
  flange_motion_ = {.X = X_WT * X_TF_, .V = {}, .A = {}};
}

Wrench HandForce::ComputeHandWrench(const ForceReading& reading, double age_s, const Pose& X_WT,
                                    double elapsed_s) OSTEON_RT {
  const Pose X_WF = X_WT * X_TF_;
  const double inertia_share = sensor_.inertia_share;
  if (inertia_share > 0.0) StepMotion(X_WF, sensor_.acceleration_hz, elapsed_s, flange_motion_);
  if (age_s >= safety::kNoAge_s || !reading.trusted) return {};
  Wrench F_S = reading.F_S;
  F_S.f -= bias_.bias().f;
  F_S.t -= bias_.bias().t;
  Wrench F_hand_T_W = HandWrench(sensor_, F_S, X_WF, X_WT.translation());
  if (inertia_share > 0.0) {
    const Wrench inertia = InertiaWrench(sensor_, flange_motion_, X_WT.translation());
    F_hand_T_W.f += inertia_share * inertia.f;
    F_hand_T_W.t += inertia_share * inertia.t;
  }
  return F_hand_T_W;
}

}  // namespace osteon::control
