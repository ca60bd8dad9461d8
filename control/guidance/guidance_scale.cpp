#include "control/guidance/guidance_scale.h"

#include <algorithm>
#include <cmath>

#include "control/laws/twist_parts.h"

namespace osteon::control {
namespace {

constexpr double kRise_s = 0.1;     // shortest time in which the scale rises from 0 to 1 outside the corridor
constexpr double kRounding = 1e-9;  // relative rounding error of the closed form
// Largest energy beyond the stored one that the scale remembers as taken from the hand.
constexpr double kMaxSurplus_J = 0.05;

// The largest s in [0, max_scale] with |a + s b| <= limit; 0 if there is none.
double ScaleWithin(const Vector3& a, const Vector3& b, double limit, double max_scale) OSTEON_RT {
  const double bb = b.squaredNorm(), ab = a.dot(b);
  const double room = limit * limit * (1.0 + kRounding) - a.squaredNorm();
  if (!(room >= 0.0)) return 0.0;
  if (!(bb > 0.0)) return max_scale;
  const double root = (std::sqrt(ab * ab + bb * room) - ab) / bb;
  return std::min(max_scale, (1.0 - kRounding) * root);
}

}  // namespace

double ScaleWithin(const safety::WrenchLimiter& limiter, const Wrench& other, const Wrench& guidance,
                   double max_scale) OSTEON_RT {
  return std::min(ScaleWithin(other.f, guidance.f, limiter.max_force_N(), max_scale),
                  ScaleWithin(other.t, guidance.t, limiter.max_torque_Nm(), max_scale));
}

double GuidanceScale::ProposeScale(const GuidanceField& field, const Pose& X_WT, double max_scale,
                                   double dt_s) OSTEON_RT {
  const Twist dx = has_pose_ ? SmallStep(X_WT_, X_WT) : Twist{};
  X_WT_ = X_WT;
  has_pose_ = true;
  F_field_T_W_ = field.F_T_W;
  potential_J_ = field.potential_J;
  energy_before_J_ = energy_J_ + 0.5 * Power(F_T_W_, dx);
  work_J_ = 0.5 * Power(F_field_T_W_, dx);

  double scale = field.inside ? max_scale : std::min(max_scale, scale_ + dt_s / kRise_s);
  const double price_J = work_J_ + potential_J_;  // energy that the field would need at scale 1
  if (price_J > 0.0) scale = std::min(scale, std::max(0.0, -energy_before_J_ / price_J));
  return scale;
}

void GuidanceScale::AcceptScale(double scale) OSTEON_RT {
  scale_ = scale;
  F_T_W_ = {.f = scale * F_field_T_W_.f, .t = scale * F_field_T_W_.t};
  energy_J_ = std::max(energy_before_J_ + scale * work_J_, -(scale * potential_J_ + kMaxSurplus_J));
}

}  // namespace osteon::control
