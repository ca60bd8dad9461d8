#include "control/stability/vibration_index.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/number_text.h"
#include "base/parameter_check.h"
#include "kinematics/sin_cos.h"
#include "safety/limits.h"

namespace osteon::control {
namespace {

constexpr double kMaxOfRate = 0.4;  // largest edge frequency of a filter, as a share of the sampling rate
// Quality factors of second-order filters: Butterworth, and critically damped (does not ring after a jolt).
constexpr double kQButterworth = 0.7071067811865476, kQCritical = 0.5;
// Share of a half-wave's peak. The next half-wave begins with the first value of the opposite sign whose
// magnitude exceeds this share.
constexpr double kTurns = 0.15;
constexpr double kPassed = 0.8;  // the peak has passed once the magnitude is below this share of it
// bounds of the ratio of an oscillation's peak to its previous peak
constexpr double kDies = 0.5, kGrows = 10.0;
constexpr double kAlertFalls = 2.0;  // ratio of the alert's time constants of fall and rise
// Tolerances of an oscillation's half period: it may be longer than that of low_hz by kSlower, and shorter
// than that of high_hz by kFaster.
constexpr double kSlower = 1.1, kFaster = 1.25;
// Factors on low_hz and high_hz. Notches remove the harmonics between the two products, because harmonics
// near the band still pass the band's filters.
constexpr double kBelowBand = 0.5, kAboveBand = 1.5;

const VibrationParams& Validated(const VibrationParams& params) {
  Validate(params);
  return params;
}

// Detector of half-waves for the band low_hz … high_hz, with tolerances.
HalfWaves MakeHalfWaves(const VibrationParams& params, double period_s) {
  // the measured half period may be wrong by one tick in either direction
  return {0.5 / (kFaster * params.high_hz) - period_s, kSlower * 0.5 / params.low_hz + period_s};
}

// Returns the filter's edge frequency [Hz], lowered if the sampling rate is too low for it.
double LimitToRate(double hz, double period_s) { return std::min(hz, kMaxOfRate / period_s); }

}  // namespace

void Validate(const VibrationParams& params) {
  const base::ParameterCheck require("vibration ");
  require("slow_hz", params.slow_hz, 0.05, 20.0);
  require("low_hz", params.low_hz, params.slow_hz + 0.1, 100.0);
  require("high_hz", params.high_hz, params.low_hz + 1.0, 400.0);
  require("lever_m", params.lever_m, 0.01, 1.0);
  require("floor_N", params.floor_N, 0.001, 50.0);
  require("slow_memory_s", params.slow_memory_s, 0.005, 5.0);
  require("share_low", params.share_low, 0.0, 0.98);
  require("share_high", params.share_high, params.share_low + 0.01, 1.0);
  require("alert_index", params.alert_index, 0.0, 1.0);
  require("alert_memory_s", params.alert_memory_s, 0.005, 1.0);
  require("rise_s", params.rise_s, 0.001, 1.0);
  require("decay_ratio", params.decay_ratio, 1.0, 1000.0);
  require("max_damping_factor", params.max_damping_factor, 1.0, 1000.0);
  require("max_mass_factor", params.max_mass_factor, 1.0, 100.0);
  require("notch_hz", params.notch_hz, 0.0, 20.0);
  require("release_s", params.release_s, 0.001, 5.0);
  Validate(params.reference);
}

double HalfWaves::Step(double x, double dt_s) OSTEON_RT {
  const double size = std::abs(x);
  since_peak_s_ += dt_s;
  since_last_s_ += dt_s;
  if (x * sign_ < 0.0 && size > kTurns * peak_) {  // smaller values are noise about zero
    sign_ = -sign_;
    last_ = peak_;
    since_last_s_ = since_peak_s_;
    peak_ = size;
    since_peak_s_ = 0.0;
    judged_ = false;
  } else if (x * sign_ > 0.0 && size > peak_) {
    peak_ = size;
    since_peak_s_ = 0.0;
    judged_ = false;
  } else if (since_peak_s_ > longest_s_) {  // the oscillation has ended
    peak_ = size;
    since_peak_s_ = 0.0;
    last_ = 0.0;
    amplitude_ = 0.0;
    sign_ = x < 0.0 ? -1.0 : 1.0;
    judged_ = false;
  } else if (!judged_ && size < kPassed * peak_) {  // the peak has passed: is it part of an oscillation?
    judged_ = true;
    const double half_s = since_last_s_ - since_peak_s_;
    const bool swings =
        half_s >= shortest_s_ && half_s <= longest_s_ && peak_ >= kDies * last_ && peak_ <= kGrows * last_;
    amplitude_ = swings ? peak_ : 0.0;
  }
  return amplitude_;
}

VibrationIndex::VibrationIndex(const VibrationParams& params, double period_s)
    : params_(Validated(params)),
      period_s_(period_s),
      rest_{.high = Biquad::HighPass(params.low_hz, kQCritical, period_s),
            .low = Biquad::LowPass(LimitToRate(params.high_hz, period_s), kQButterworth, period_s),
            .slow_high = Biquad::HighPass(params.slow_hz, kQButterworth, period_s),
            .slow_low = Biquad::LowPass(params.low_hz, kQButterworth, period_s),
            .waves = {MakeHalfWaves(params, period_s), MakeHalfWaves(params, period_s),
                      MakeHalfWaves(params, period_s)}},
      force_(rest_),
      torque_(rest_),
      reference_(params.reference) {
  if (!(period_s > 0.0 && params.low_hz < kMaxOfRate / period_s))
    throw std::invalid_argument("vibration period_s: found " + base::NumberText(period_s) +
                                ", accepted > 0, and short enough for low_hz");
}

void VibrationIndex::Reset() OSTEON_RT {
  force_ = rest_;
  torque_ = rest_;
  begun_ = false;
  angle_rad_ = 0.0;
  from_ = to_ = 0;
  seen_ = alert_ = 0.0;
  reference_.Reset();
}

// Subtracts the spindle's harmonics from the band signal x. The amplitudes of each harmonic then adapt to the
// remainder.
Vector3 VibrationIndex::RemoveSpindleLines(Lines& lines, const Vector3& x) const OSTEON_RT {
  Vector3 rest = x;
  const auto count = static_cast<std::size_t>(to_ - from_);
  for (std::size_t i = 0; i < count; ++i) rest -= cos_[i] * lines.c[i] + sin_[i] * lines.s[i];
  const double gain = 2.0 * std::numbers::pi * params_.notch_hz * period_s_;
  for (std::size_t i = 0; i < count; ++i) {
    lines.c[i] += gain * cos_[i] * rest;
    lines.s[i] += gain * sin_[i] * rest;
  }
  return rest;
}

// Advances the spindle's angle, and finds the harmonics in the band.
void VibrationIndex::AdvanceSpindle(double spindle_rad_per_s) OSTEON_RT {
  const double hz = std::abs(spindle_rad_per_s) / (2.0 * std::numbers::pi);
  int from = 0, to = 0;
  // harmonics closer together than a notch's width would remove the whole band
  if (params_.notch_hz > 0.0 && hz > params_.notch_hz && hz < kAboveBand * params_.high_hz) {
    from = std::max(1, static_cast<int>(std::ceil(kBelowBand * params_.low_hz / hz)));
    to = std::max(from, 1 + static_cast<int>(kAboveBand * params_.high_hz / hz));
    to = std::min(to, from + kHarmonics);
  }
  if (from != from_) {
    force_.lines.Clear();
    torque_.lines.Clear();
  }
  from_ = from;
  to_ = to;
  if (from == to) return;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  angle_rad_ += spindle_rad_per_s * period_s_;
  angle_rad_ -= kTurn * std::floor(angle_rad_ / kTurn);
  std::array<double, kHarmonics> angles{};
  for (int n = from; n < to; ++n) angles[static_cast<std::size_t>(n - from)] = n * angle_rad_;
  const auto lines = kinematics::SinCos(angles);
  cos_ = lines.cos;
  sin_ = lines.sin;
}

// Updates a channel's three energies (oscillation, band, slow motion) with the tick's input x [N].
void VibrationIndex::FilterChannel(Channel& channel, const Vector3& x) OSTEON_RT {
  const Vector3 from_first = x - channel.first;
  const Vector3 band = RemoveSpindleLines(channel.lines, channel.low.Step(channel.high.Step(from_first)));
  const Vector3 slow = channel.slow_low.Step(channel.slow_high.Step(from_first));
  channel.oscillation_energy = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double amplitude = channel.waves[static_cast<std::size_t>(i)].Step(band[i], period_s_);
    channel.oscillation_energy += 0.5 * amplitude * amplitude;
  }
  channel.band_energy +=
      std::min(1.0, period_s_ / params_.alert_memory_s) * (band.squaredNorm() - channel.band_energy);
  channel.slow_energy +=
      std::min(1.0, period_s_ / params_.slow_memory_s) * (slow.squaredNorm() - channel.slow_energy);
}

double VibrationIndex::Step(const Wrench& F, double spindle_rad_per_s) OSTEON_RT {
  if (!safety::IsFinite(F) || !std::isfinite(spindle_rad_per_s)) return index();
  const Vector3 at_lever_N = F.t / params_.lever_m;
  if (!begun_) {  // the filters start in the steady state of the present wrench
    force_.first = F.f;
    torque_.first = at_lever_N;
    begun_ = true;
  }
  AdvanceSpindle(spindle_rad_per_s);
  FilterChannel(force_, F.f);
  FilterChannel(torque_, at_lever_N);

  const double floor2 = params_.floor_N * params_.floor_N;
  const double slow_and_floor_energy = force_.slow_energy + torque_.slow_energy + floor2;
  // w(E), as defined in the class's comment
  const auto wanted = [&](double energy) {
    const double beyond = std::max(0.0, energy - reference_.allowed_energy());
    const double share = beyond / (beyond + slow_and_floor_energy);
    return std::clamp((share - params_.share_low) / (params_.share_high - params_.share_low), 0.0, 1.0);
  };
  // moves an index toward its goal by one tick: upward with time constant rise_s, downward with falls_s
  const auto toward = [this](double& index, double goal, double falls_s) {
    const double takes_s = goal > index ? params_.rise_s : falls_s;
    index += std::min(1.0, period_s_ / takes_s) * (goal - index);
  };
  const double oscillation_energy = force_.oscillation_energy + torque_.oscillation_energy,
               band_energy = force_.band_energy + torque_.band_energy;
  const double goal = wanted(oscillation_energy), alert = wanted(band_energy);
  // energies below this value never raise the index
  const double min_energy = params_.share_low / (1.0 - params_.share_low) * floor2;
  reference_.Step(oscillation_energy, goal, seen_, min_energy, period_s_);
  toward(seen_, reference_.testing() ? 1.0 : goal,
         reference_.attributed_to_hand() ? params_.release_s : params_.decay_ratio * params_.rise_s);
  toward(alert_, params_.alert_index * alert, kAlertFalls * params_.rise_s);
  return index();
}

double VibrationIndex::damping_factor() const OSTEON_RT {
  return params_.acts ? 1.0 + index() * (params_.max_damping_factor - 1.0) : 1.0;
}

double VibrationIndex::mass_factor() const OSTEON_RT {
  return params_.acts ? 1.0 + index() * (params_.max_mass_factor - 1.0) : 1.0;
}

}  // namespace osteon::control
