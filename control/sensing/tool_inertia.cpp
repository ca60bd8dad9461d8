#include "control/sensing/tool_inertia.h"

#include <numbers>

#include "control/laws/twist_parts.h"

namespace osteon::control {

void StepMotion(const Pose& X, double filter_hz, double dt_s, MeasuredMotion& motion) OSTEON_RT {
  const double filter_s = 1.0 / (2.0 * std::numbers::pi * filter_hz);
  const double share = dt_s / (dt_s + filter_s);
  const Twist V = TwistBetween(motion.X, X, dt_s);
  const Twist dV{.v = share * (V.v - motion.V.v), .w = share * (V.w - motion.V.w)};
  motion.V.v += dV.v;
  motion.V.w += dV.w;
  motion.A.v += share * (dV.v / dt_s - motion.A.v);
  motion.A.w += share * (dV.w / dt_s - motion.A.w);
  motion.X = X;
}

Wrench InertiaWrench(const ForceSensorParams& params, const MeasuredMotion& motion,
                     const Vector3& p_WT) OSTEON_RT {
  const Vector3 center_W = motion.X * Vector3(params.tool_center_F_m);
  const Vector3 r = center_W - motion.X.translation();
  const Vector3& w = motion.V.w;
  const Vector3& alpha = motion.A.w;
  const Vector3 f = params.tool_mass_kg * (motion.A.v + alpha.cross(r) + w.cross(w.cross(r)));
  const Matrix3 R_WF = motion.X.linear();
  const Matrix3 I_W = R_WF * Matrix3(params.tool_inertia_F) * R_WF.transpose();
  return {.f = f, .t = I_W * alpha + w.cross(I_W * w) + (center_W - p_WT).cross(f)};
}

}  // namespace osteon::control
