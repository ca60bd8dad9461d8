#include "control/sensing/hand_wrench.h"

#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "kinematics/serial_chain.h"

namespace osteon::control {

void Validate(const ForceSensorParams& params) {
  if (!(params.tool_mass_kg >= 0.0 && params.tool_mass_kg <= 100.0))
    throw std::invalid_argument("force sensor tool_mass_kg: found " + base::NumberText(params.tool_mass_kg) +
                                ", accepted 0 … 100");
  if (!Vector3(params.tool_center_F_m).allFinite())
    throw std::invalid_argument("force sensor tool_center_F_m: accepted a finite position");
  if (!Vector3(params.bias_S.f).allFinite() || !Vector3(params.bias_S.t).allFinite())
    throw std::invalid_argument("force sensor bias_S: accepted finite values");
  if (!Matrix3(params.tool_inertia_F).allFinite())
    throw std::invalid_argument("force sensor tool_inertia_F: accepted finite values");
  if (!(params.inertia_share >= 0.0 && params.inertia_share <= 1.0))
    throw std::invalid_argument("force sensor inertia_share: found " +
                                base::NumberText(params.inertia_share) + ", accepted 0 … 1");
  if (!(params.acceleration_hz >= 1.0 && params.acceleration_hz <= 200.0))
    throw std::invalid_argument("force sensor acceleration_hz: found " +
                                base::NumberText(params.acceleration_hz) + ", accepted 1 … 200");
  if (!Pose(params.X_FS).matrix().allFinite())
    throw std::invalid_argument("force sensor X_FS: accepted a finite pose");
}

Wrench ToolWeight(const ForceSensorParams& params, const Pose& X_WF) OSTEON_RT {
  const Pose X_WS = X_WF * Pose(params.X_FS);
  const Vector3 weight_W = params.tool_mass_kg * kinematics::kGravity_W_m_per_s2;
  const Vector3 lever_W = X_WF * Vector3(params.tool_center_F_m) - X_WS.translation();
  return {.f = X_WS.linear().transpose() * weight_W,
          .t = X_WS.linear().transpose() * lever_W.cross(weight_W)};
}

Wrench HandWrench(const ForceSensorParams& params, const Wrench& F_S, const Pose& X_WF,
                  const Vector3& p_WT) OSTEON_RT {
  const Pose X_WS = X_WF * Pose(params.X_FS);
  const Vector3 f_W = X_WS.linear() * (F_S.f - Vector3(params.bias_S.f));
  const Vector3 weight_W = params.tool_mass_kg * kinematics::kGravity_W_m_per_s2;
  const Vector3 center_W = X_WF * Vector3(params.tool_center_F_m);
  return {.f = f_W - weight_W,
          .t = X_WS.linear() * (F_S.t - Vector3(params.bias_S.t)) + (X_WS.translation() - p_WT).cross(f_W) -
               (center_W - p_WT).cross(weight_W)};
}

}  // namespace osteon::control
