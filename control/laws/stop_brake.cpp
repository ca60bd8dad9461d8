#include "control/laws/stop_brake.h"

namespace osteon::control {

void StopBrake::Reset() OSTEON_RT { *this = {}; }

Wrench StopBrake::Step(const ImpedanceParams& params, const Matrix3& R_WT, const Twist& V_WT) OSTEON_RT {
  // smaller velocities are encoder noise
  constexpr double kStands_m_per_s = 5e-3, kStands_rad_per_s = 0.05;
  const bool turned_back = V_WT.v.dot(V_before_WT_.v) < -kStands_m_per_s * kStands_m_per_s ||
                           V_WT.w.dot(V_before_WT_.w) < -kStands_rad_per_s * kStands_rad_per_s;
  // The filtered velocity passes zero slowly. Therefore it is compared with the last velocity above the
  // noise.
  if (V_WT.v.norm() > kStands_m_per_s) V_before_WT_.v = V_WT.v;
  if (V_WT.w.norm() > kStands_rad_per_s) V_before_WT_.w = V_WT.w;
  if (turned_back) gain_scale_ *= 0.5;
  const Wrench F = DampingWrench(params, R_WT, V_WT, {});
  return {.f = gain_scale_ * F.f, .t = gain_scale_ * F.t};
}

}  // namespace osteon::control
