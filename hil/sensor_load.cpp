#include "hil/sensor_load.h"

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

}  // namespace osteon::hil
