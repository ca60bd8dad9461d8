#include "control/arm/arm_speed_watch.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::control {
namespace {

// A longer time between two messages is counted as this. Otherwise a jump of the clock would allow any
// distance.
constexpr double kMaxBetween_s = 0.1;

void Require(bool accepted, const char* name, double found, const char* range) {
  if (!accepted)
    throw std::invalid_argument(std::string("arm speed: ") + name + ": found " + base::NumberText(found) +
                                ", accepted " + range);
}

}  // namespace

ArmSpeedWatch::ArmSpeedWatch(const ArmSpeedParams& params, double period_s)
    : params_(params), period_s_(period_s) {
  Require(params.margin >= 1.0, "margin", params.margin, ">= 1");
  Require(params.excess_m > 0.0, "excess_m", params.excess_m, "> 0");
  Require(period_s > 0.0, "period_s", period_s, "> 0");
}

bool ArmSpeedWatch::Check(const ArmState& state, const Vector3& p_W, double limit_m_per_s) OSTEON_RT {
  speed_m_per_s_ = 0.0;
  const double periods = gap_.Step(state);
  if (has_last_) {
    const double between_s = std::clamp(std::max(periods * period_s_, rt::ToSeconds(state.stamp - stamp_)),
                                        period_s_, std::max(kMaxBetween_s, period_s_));
    const double way_m = (p_W - p_last_W_).norm();
    speed_m_per_s_ = way_m / between_s;
    excess_m_ = std::max(0.0, excess_m_ + way_m - params_.margin * limit_m_per_s * between_s);
  }
  has_last_ = true;
  p_last_W_ = p_W;
  stamp_ = state.stamp;
  return excess_m_ > params_.excess_m;
}

void ArmSpeedWatch::Reset() OSTEON_RT {
  has_last_ = false;
  gap_.Reset();
  speed_m_per_s_ = excess_m_ = 0.0;
}

}  // namespace osteon::control
