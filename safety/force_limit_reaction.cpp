#include "safety/force_limit_reaction.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/number_text.h"
#include "base/parameter_check.h"

namespace osteon::safety {

void Validate(const ForceLimitReactionParams& params) {
  const base::ParameterCheck require("on force limit ");
  require("advance_factor", params.advance_factor, 1.0, 2.0);
  require("slow_zone_m", params.slow_zone_m, 1e-5, 0.1);
  require("stop_after_s", params.stop_after_s, 1e-3, 10.0);
  if (!(params.max_tool_in_bone_m > 0.0))
    throw std::invalid_argument("on force limit max_tool_in_bone_m: found " +
                                base::NumberText(params.max_tool_in_bone_m) + ", accepted > 0");
}

ForceLimitReaction::ForceLimitReaction(const ForceLimitReactionParams& params, double deceleration_m_per_s2,
                                       double period_s)
    : params_(params), deceleration_m_per_s2_(deceleration_m_per_s2), period_s_(period_s) {
  Validate(params);
}

void ForceLimitReaction::Reset() OSTEON_RT {
  into_bone_W_ = Vector3::Zero();
  depth_m_ = allowed_m_per_s_ = saturated_s_ = 0.0;
  saturated_ = false;
}

void ForceLimitReaction::Step(const ForceLimitInput& input) OSTEON_RT {
  depth_m_ = input.displacement_W.norm();
  saturated_ = depth_m_ > 0.0 && input.rendered_scale < 1.0;
  saturated_s_ = saturated_ ? saturated_s_ + period_s_ : 0.0;
  into_bone_W_ = Vector3::Zero();
  if (!saturated_) return;
  into_bone_W_ = -input.displacement_W / depth_m_;
  // e, x, the factor on the advance, and v_max of the formulas in the header
  const double beyond_m = depth_m_ * (1.0 - input.rendered_scale);
  const double room_m = std::max(0.0, params_.slow_zone_m - beyond_m);
  const double step_m_per_s = deceleration_m_per_s2_ * period_s_;
  const double zones = std::min(2.0, beyond_m / params_.slow_zone_m);
  const double factor = params_.advance_factor + (1.0 - params_.advance_factor) * zones;
  allowed_m_per_s_ = factor * std::max(0.0, input.advance_m_per_s) +
                     std::sqrt(step_m_per_s * step_m_per_s + 2.0 * deceleration_m_per_s2_ * room_m) -
                     step_m_per_s;
}

bool ForceLimitReaction::Limit(const Vector3& v_before_W, Vector3& v_W) const OSTEON_RT {
  if (params_.reaction != OnForceLimit::kSlow || !saturated_) return false;
  const double into_m_per_s = into_bone_W_.dot(v_W);
  const double braked_m_per_s = into_bone_W_.dot(v_before_W) - deceleration_m_per_s2_ * period_s_;
  const double max_speed_m_per_s = std::max(allowed_m_per_s_, braked_m_per_s);
  if (!(into_m_per_s > max_speed_m_per_s)) return false;
  v_W -= (into_m_per_s - max_speed_m_per_s) * into_bone_W_;
  return true;
}

bool ForceLimitReaction::must_stop() const OSTEON_RT {
  return params_.reaction == OnForceLimit::kStop && saturated_s_ >= params_.stop_after_s - 0.5 * period_s_;
}

}  // namespace osteon::safety
