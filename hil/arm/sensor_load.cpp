#include "hil/arm/sensor_load.h"

#include "kinematics/serial_chain.h"

namespace osteon::hil {

Wrench SensorLoad(const control::ForceSensorParams& sensor, const Pose& X_WT, const Pose& X_WF,
                  const Wrench& F_hand_T_W) {
  const Pose X_WS = X_WF * Pose(sensor.X_FS);
  const Vector3 weight_W = sensor.tool_mass_kg * kinematics::kGravity_W_m_per_s2;
  const Vector3 lever_hand_W = X_WT.translation() - X_WS.translation();
  const Vector3 lever_weight_W = X_WF * Vector3(sensor.tool_center_F_m) - X_WS.translation();
  const Wrench F_S_W{.f = F_hand_T_W.f + weight_W,
                     .t = F_hand_T_W.t + lever_hand_W.cross(F_hand_T_W.f) + lever_weight_W.cross(weight_W)};
  return {.f = X_WS.linear().transpose() * F_S_W.f, .t = X_WS.linear().transpose() * F_S_W.t};
}

Wrench SubtractInertia(const control::ForceSensorParams& sensor, const Wrench& F_S,
                       const SensorMotion& motion) {
  const auto& [X_WT, X_WF, V_WT, A_WT] = motion;
  const Matrix3 R_SW = (X_WF * Pose(sensor.X_FS)).linear().transpose(), R_FW = X_WF.linear().transpose();
  const Vector3 from_T_W = X_WF * Vector3(sensor.tool_center_F_m) - X_WT.translation();
  const Vector3 center_m_per_s2 = A_WT.v + A_WT.w.cross(from_T_W) + V_WT.w.cross(V_WT.w.cross(from_T_W));
  const Matrix3 I_F = sensor.tool_inertia_F;
  const Vector3 w_F = R_FW * V_WT.w, alpha_F = R_FW * A_WT.w;
  const Vector3 spin_F = I_F * alpha_F + w_F.cross(I_F * w_F);  // Euler's equation, in F
  // wrench at S's origin, in S
  const Vector3 f_S = R_SW * (sensor.tool_mass_kg * center_m_per_s2);
  const Vector3 center_S = Pose(sensor.X_FS).inverse() * Vector3(sensor.tool_center_F_m);
  const Vector3 t_S = Pose(sensor.X_FS).linear().transpose() * spin_F + center_S.cross(f_S);
  return {.f = F_S.f - f_S, .t = F_S.t - t_S};
}

}  // namespace osteon::hil
