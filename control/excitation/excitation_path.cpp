#include "control/excitation/excitation_path.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::control {
namespace {

void Require(bool accepted, const char* name, double found, const char* range) {
  if (!accepted)
    throw std::invalid_argument(std::string("excitation: ") + name + ": found " + base::NumberText(found) +
                                ", accepted " + range);
}

// Polynomial that rises from 0 to 1 for u in 0 … 1, with zero first and second derivatives at both ends.
double Quintic(double u) OSTEON_RT {
  const double v = std::clamp(u, 0.0, 1.0);
  return v * v * v * (10.0 + v * (6.0 * v - 15.0));
}

}  // namespace

ExcitationPath::ExcitationPath(const ExcitationParams& params, double period_s)
    : params_(params), period_s_(period_s), clock_(params.pause_s), period_ticks_(0) {
  Require(params.draws >= 1 && params.draws <= ExcitationParams::kMaxDraws, "draws", params.draws, "1 … 16");
  Require(params.periods >= 1 && params.periods <= 100, "periods", params.periods, "1 … 100");
  Require(params.max_travel_m > 0.0, "max_travel_m", params.max_travel_m, "> 0");
  Require(params.max_acceleration_m_per_s2 > 0.0, "max_acceleration_m_per_s2",
          params.max_acceleration_m_per_s2, "> 0");
  Require(params.pause_s >= 0.05 && params.pause_s <= 5.0, "pause_s", params.pause_s, "0.05 … 5");
  Require(period_s > 0.0 && period_s <= 0.1, "period_s", period_s, "0 … 0.1, not 0");
  period_ticks_ = static_cast<int>(std::lround(Multisine::kPeriod_s / period_s));
  for (int d = 0; d < params.draws; ++d) {
    Multisine draw(params.seed + static_cast<std::uint64_t>(d), params.peak_speed_m_per_s);
    // reduce the amplitudes if travel or acceleration would exceed its bound
    const double share = std::min({1.0, params.max_travel_m / draw.peak().x_m,
                                   params.max_acceleration_m_per_s2 / draw.peak().a_m_per_s2});
    if (share < 1.0) draw.Scale(share);
    draws_.push_back(draw);
  }
}

ExcitationStep ExcitationPath::Step(bool permitted) OSTEON_RT {
  if (part_ == ExcitationPart::kDone)
    return {.part = part_, .draw = static_cast<int>(draw_), .at_rest = true};
  const double passed_s = clock_.Step(period_s_, permitted);
  const bool full_rate = clock_.rate() >= 1.0;
  t_s_ += passed_s;
  faded_s_ += passed_s;
  // while the clock runs at less than full rate, a settling period is begun again in each tick
  if (part_ == ExcitationPart::kFading) {
    if (faded_s_ >= kFade_s) part_ = ExcitationPart::kDone;
  } else if (full_rate) {
    Count();
  } else {
    part_ = ExcitationPart::kSettling;
    ticks_ = 0;
  }
  return {.x_m = Offset(),
          .part = part_,
          .draw = static_cast<int>(draw_),
          .period = period_,
          .at_rest = !permitted && clock_.rate() <= 0.0};
}

// Counts a tick at full rate, and begins the next period or draw if the present one is complete.
void ExcitationPath::Count() OSTEON_RT {
  if (ticks_ == period_ticks_) {
    ticks_ = 0;
    if (part_ == ExcitationPart::kSettling)
      part_ = ExcitationPart::kCounted;
    else
      ++period_;
    if (period_ == params_.periods) {
      faded_s_ = 0.0;
      if (draw_ + 1 == draws_.size()) {
        part_ = ExcitationPart::kFading;
        return;
      }
      ++draw_;
      period_ = 0;
      part_ = ExcitationPart::kSettling;
    }
  }
  ++ticks_;
}

// Offset along the axis at the path's present time [m].
double ExcitationPath::Offset() const OSTEON_RT {
  const double s = Quintic(faded_s_ / kFade_s);
  switch (part_) {
    case ExcitationPart::kDone:
      return 0.0;
    case ExcitationPart::kFading:
      return (1.0 - s) * draws_[draw_].At(t_s_).x_m;
    case ExcitationPart::kSettling:
    case ExcitationPart::kCounted:
      break;
  }
  const double x_m = draws_[draw_].At(t_s_).x_m;
  if (s >= 1.0) return x_m;
  const double before_m = draw_ == 0 ? 0.0 : draws_[draw_ - 1].At(t_s_).x_m;
  return (1.0 - s) * before_m + s * x_m;
}

double ExcitationPath::duration_s() const {
  // Periods are counted once the clock runs at full rate, which takes 2/3 pause_s after its start.
  return Multisine::kPeriod_s * (params_.periods + 1) * static_cast<double>(draws_.size()) +
         params_.pause_s * 2.0 / 3.0 + kFade_s;
}

MultisineState ExcitationPath::peak() const {
  MultisineState peak;
  for (const Multisine& draw : draws_) {
    peak.x_m = std::max(peak.x_m, draw.peak().x_m);
    peak.v_m_per_s = std::max(peak.v_m_per_s, draw.peak().v_m_per_s);
    peak.a_m_per_s2 = std::max(peak.a_m_per_s2, draw.peak().a_m_per_s2);
  }
  return peak;
}

double ExcitationPath::rms_speed_m_per_s() const {
  double sum = 0.0;
  for (const Multisine& draw : draws_) sum += draw.rms_speed_m_per_s();
  return sum / static_cast<double>(draws_.size());
}

}  // namespace osteon::control
