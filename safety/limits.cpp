#include "safety/limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::safety {
namespace {

// Rounding in norm, quotient and product may each add half an ulp. This factor keeps the result within the
// limit in spite of that.
constexpr double kRoundDown = 1.0 - 1e-15;

// |v|, without overflow in the squares. The result may still be infinite for the largest doubles; such a v is
// then scaled to zero.
double SafeNorm(const Vector3& v) {
  const double largest = v.cwiseAbs().maxCoeff();
  return largest > 1e100 ? largest * (v / largest).norm() : v.norm();
}

// Largest factor, 0 … 1, that keeps |v| within the limit.
double ScaleWithin(const Vector3& v, double limit) {
  const double size = SafeNorm(v);
  return size > limit ? limit / size * kRoundDown : 1.0;
}

void RequirePositive(double value, const char* name) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw std::invalid_argument(std::string(name) + ": found " + base::NumberText(value) +
                                ", accepted > 0 and finite");
}

}  // namespace

bool IsFinite(const Vector3& v) OSTEON_RT {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}
bool IsFinite(const Wrench& F) OSTEON_RT { return IsFinite(F.f) && IsFinite(F.t); }
bool IsFinite(const Twist& V) OSTEON_RT { return IsFinite(V.v) && IsFinite(V.w); }

LimitedWrench ScaleWrench(const Wrench& F, double max_force_N, double max_torque_Nm) OSTEON_RT {
  if (!IsFinite(F)) return {.F = {}, .share = 0.0};
  const double share = std::min(ScaleWithin(F.f, max_force_N), ScaleWithin(F.t, max_torque_Nm));
  if (share == 1.0) return {.F = F, .share = 1.0};
  return {.F = {.f = share * F.f, .t = share * F.t}, .share = share};
}

WrenchLimiter::WrenchLimiter(const WrenchLimitParams& params) : params_(params) {
  RequirePositive(params.max_force_N, "max_force_N");
  RequirePositive(params.max_torque_Nm, "max_torque_Nm");
  force_limit_N_ = params_.max_force_N = std::min(params.max_force_N, kForceCeiling_N);
}

LimitedWrench WrenchLimiter::Limit(const Wrench& F) const OSTEON_RT {
  return ScaleWrench(F, params_.max_force_N, params_.max_torque_Nm);
}

LimitedWrench WrenchLimiter::Limit(const Wrench& F,
                                   const kinematics::ForceCapability<7>& arm) const OSTEON_RT {
  LimitedWrench limited = Limit(F);
  limited.arm_share = IsFinite(F) ? arm.HoldableShare(F) : 0.0;
  if (limited.arm_share >= limited.share) return limited;
  limited.share = limited.arm_share;
  limited.F = {.f = limited.share * F.f, .t = limited.share * F.t};
  return limited;
}

WrenchRateTrip::WrenchRateTrip(double stiffness_N_per_m, double max_speed_m_per_s)
    : max_rate_N_per_s_(1.5 * stiffness_N_per_m * max_speed_m_per_s) {
  RequirePositive(stiffness_N_per_m, "stiffness_N_per_m");
  RequirePositive(max_speed_m_per_s, "max_speed_m_per_s");
}

bool WrenchRateTrip::Check(const Vector3& f_N, double dt_s) OSTEON_RT {
  growth_N_ = std::numeric_limits<double>::infinity();
  if (!IsFinite(f_N)) return true;
  const double before_squared = before_N_.squaredNorm();
  // s f_before is the point nearest to f on the segment from zero to the previous force
  const double s = before_squared > 0.0 ? std::clamp(f_N.dot(before_N_) / before_squared, 0.0, 1.0) : 0.0;
  growth_N_ = SafeNorm(f_N - s * before_N_);
  // store at most 1e6 N, because the squares of a huge force would overflow in the next tick
  before_N_ = ScaleWrench({.f = f_N, .t = Vector3::Zero()}, 1e6, 1.0).F.f;
  return !(growth_N_ <= max_rate_N_per_s_ * dt_s);
}

SensorForceTrip::SensorForceTrip(const SensorForceParams& params, double max_force_N)
    : level_N_(max_force_N + params.margin_N), ticks_(params.ticks) {
  RequirePositive(max_force_N, "max_force_N");
  RequirePositive(params.margin_N, "margin_N");
  if (params.ticks < 1)
    throw std::invalid_argument("ticks: found " + std::to_string(params.ticks) + ", accepted >= 1");
}

bool SensorForceTrip::Check(double force_N) OSTEON_RT {
  count_ = force_N <= level_N_ ? 0 : std::min(count_ + 1, ticks_);  // NaN counts as beyond the level
  return count_ >= ticks_;
}

LimitedTwist LimitTwist(const Twist& V, const TwistLimitParams& params) OSTEON_RT {
  if (!IsFinite(V)) return {.V = {}, .share = 0.0};
  const double share =
      std::min(ScaleWithin(V.v, params.max_speed_m_per_s), ScaleWithin(V.w, params.max_turn_rad_per_s));
  if (share == 1.0) return {.V = V, .share = 1.0};
  return {.V = {.v = share * V.v, .w = share * V.w}, .share = share};
}

}  // namespace osteon::safety
