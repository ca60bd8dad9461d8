#include "control/setup/servo_params.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "base/parameter_check.h"

namespace osteon::control {

void Validate(const ServoParams& params) {
  Validate(params.admittance);
  Validate(params.impedance);
  Validate(params.coupling);
  Validate(params.sensor);
  Validate(params.sensor_bias);
  Validate(params.vibration);
  Validate(params.stabilisers);
  if (params.depth.acts) Validate(params.depth);
  if (params.guidance) Validate(*params.guidance);
  if (params.compliance.any()) Validate(params.compliance);
  Validate(params.energy);
  Validate(params.on_force_limit);
  const base::ParameterCheck require("servo ");
  require("max_speed_m_per_s", params.twist.max_speed_m_per_s, 1e-3, 2.0);
  require("max_turn_rad_per_s", params.twist.max_turn_rad_per_s, 1e-3, 10.0);
  if (!(params.max_elbow_speed_m_per_s > 0.0))
    throw std::invalid_argument("servo max_elbow_speed_m_per_s: found " +
                                base::NumberText(params.max_elbow_speed_m_per_s) + ", accepted > 0");
  require("spindle_rad_per_s", params.spindle_rad_per_s, 0.0, 50000.0);
  require("stop_deceleration_m_per_s2", params.stop_deceleration_m_per_s2, 0.01, 50.0);
  require("stop_deceleration_rad_per_s2", params.stop_deceleration_rad_per_s2, 0.01, 200.0);
  require("workspace deceleration_m_per_s2", params.workspace.deceleration_m_per_s2, 0.01,
          params.stop_deceleration_m_per_s2);
  require("joint_stop_s", params.joint_stop_s, 0.001, 2.0);
  require("model_sight_m", params.model_sight_m, 1e-5, 1.0);
  require("arm_angle_rate_rad_per_s", params.arm_angle_rate_rad_per_s, 0.0, 1.0);
  require("joint_acceleration_share", params.joint_acceleration_share, 0.01, 1000.0);
  require("posture limit_zone_rad", params.posture.limit_zone_rad, 1e-3, 3.0);
  require("posture limit_speed_rad_per_s", params.posture.limit_speed_rad_per_s, 0.0, 2.0);
  require("posture singular_zone_m", params.posture.singular_zone_m, 1e-3, 1.0);
  require("posture singular_speed_rad_per_s", params.posture.singular_speed_rad_per_s, 0.0, 2.0);
  require("posture load_zone", params.posture.load_zone, 1.01, 10.0);
  require("posture load_speed_rad_per_s", params.posture.load_speed_rad_per_s, 0.0, 2.0);
  require("posture_load axial_N", params.posture_load.axial_N, 0.0, 1000.0);
  require("posture_load lateral_N", params.posture_load.lateral_N, 0.0, 1000.0);
  require("posture_load torque_Nm", params.posture_load.torque_Nm, 0.0, 1000.0);
  require("max_tracking_error_m", params.max_tracking_error_m, 1e-4, 1.0);
  require("period_s", params.period_s, 1e-4, 0.02);
  if (params.start) {
    require("start tolerance_rad", params.start->tolerance_rad, 1e-6, 0.1);
    require("start pause_force_N", params.start->pause_force_N, 1.0, 500.0);
  }
}

StabilisedLaw LawOf(const AdmittanceParams& law, const ServoParams& params) OSTEON_RT {
  // The passivity controller's damping may at most stop the motion within a tick. The bound on it is
  // therefore the mass of the lightest axis over the period. If the law's centre is not at To, the lever
  // between them makes the effective mass at To smaller.
  const double lever_m = params.stabilisers.passivity.lever_m;
  const double min_mass_kg =
      std::min(law.mass_kg.minCoeff(), law.inertia_kg_m2.minCoeff() / (lever_m * lever_m));
  const double centre_m2 = law.centre_T_m.squaredNorm();
  const double with_lever_kg = 1.0 / (1.0 / min_mass_kg + centre_m2 / law.inertia_kg_m2.minCoeff());
  return {.damping = {.Ns_per_m = law.damping_Ns_per_m,
                      .Nms_per_rad = law.damping_Nms_per_rad,
                      .centre_T_m = law.centre_T_m},
          .max_damping_Ns_per_m = with_lever_kg / params.period_s};
}

StabilisedLaw LawOf(const ServoParams& params) {
  if (params.law == Law::kAdmittance) return LawOf(params.admittance, params);
  const ImpedanceParams& law = params.impedance;
  const AgeGovernorParams& governor = params.stabilisers.age_governor;
  const auto require = [&](const char* name, const Vector3& law_damping, double arm_damping) {
    if (governor.acts && !(law_damping.minCoeff() + arm_damping > 0.0))
      throw std::invalid_argument(std::string("impedance ") + name +
                                  " with the arm's that the age governor counts on: found 0, accepted > 0");
  };
  require("damping_Ns_per_m", law.damping_Ns_per_m, governor.arm_damping_Ns_per_m);
  require("damping_Nms_per_rad", law.damping_Nms_per_rad, governor.arm_damping_Nms_per_rad);
  // age of the pose: the wrench takes effect one period after the pose and is held for one period, 1.5
  // periods on average; the twist's filter adds its delay
  return {.damping = {.Ns_per_m = law.damping_Ns_per_m, .Nms_per_rad = law.damping_Nms_per_rad},
          .pose_age_s = 1.5 * params.period_s + law.twist_filter_s,
          .work = PortWork::kHeld,
          .max_damping_Ns_per_m = std::max(1.0, law.brake_Ns_per_m)};
}

double ToolSpeedLimit_m_per_s(const ServoParams& params, bool reduced) OSTEON_RT {
  const double kinetic_limit_m_per_s =
      safety::SpeedOfEnergy(params.energy.max_kinetic_J, params.energy.moving_mass_kg);
  const double limit_m_per_s = std::min(params.twist.max_speed_m_per_s, kinetic_limit_m_per_s);
  return reduced ? std::min(limit_m_per_s, kReducedSpeed_m_per_s) : limit_m_per_s;
}

double ElbowSpeedLimit_m_per_s(const ServoParams& params, bool reduced) OSTEON_RT {
  return reduced ? std::min(params.max_elbow_speed_m_per_s, kReducedSpeed_m_per_s)
                 : params.max_elbow_speed_m_per_s;
}

double ForceLimit_N(const ServoParams& params) OSTEON_RT {
  double stiffness_N_per_m = params.coupling.max_stiffness_N_per_m;
  if (params.compliance.any()) {  // compliant parts store energy too, and give it back
    const double compliance_m_per_N = SeriesCompliance(params.compliance, params.wrench.max_force_N);
    stiffness_N_per_m /= 1.0 + stiffness_N_per_m * compliance_m_per_N;
  }
  return std::min({params.wrench.max_force_N, safety::kForceCeiling_N,
                   safety::ForceOfEnergy(params.energy.max_stored_J, stiffness_N_per_m)});
}

int JointStopTicks(const ServoParams& params) OSTEON_RT {
  return std::max(1, static_cast<int>(std::ceil(params.joint_stop_s / params.period_s)));
}

}  // namespace osteon::control
