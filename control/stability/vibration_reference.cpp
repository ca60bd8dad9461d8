#include "control/stability/vibration_reference.h"

#include <algorithm>
#include <cmath>

#include "base/parameter_check.h"

namespace osteon::control {
namespace {

// If the energy falls by more than this factor during a test, the test is extended, because the energy of a
// beating tremor may fall as far.
constexpr double kBeats = 2.0;
// If the largest energy in the extension is smaller than before the test by more than this factor, the
// vibration was an oscillation of the loop.
constexpr double kLightens = 3.0;
// time constant with which suspected_s_ and before2_ decay: oscillation is intermittent
constexpr double kTrust_s = 6.0;
constexpr double kLight = 0.01;  // index below which the drag counts as released
// time at the beginning of a test's extension in which the energy is not measured
constexpr double kSettle_s = 0.15;
constexpr double kBeat_s = 1.0;  // after a test, R follows a tremor's beats for this long
// a raw index above this starts a test while watchful; a damped loop stays below it
constexpr double kSure = 0.9;

const ReferenceParams& Validated(const ReferenceParams& params) {
  Validate(params);
  return params;
}

}  // namespace

void Validate(const ReferenceParams& params) {
  const base::ParameterCheck require("vibration ");
  require("tremor_N", params.tremor_N, 0.0, 50.0);
  require("margin", params.margin, 1.0, 10.0);
  require("suspect_s", params.suspect_s, 0.01, 5.0);
  require("test_s", params.test_s, 0.02, 5.0);
  require("hold_s", params.hold_s, 0.2, 5.0);
  require("listen_s", params.listen_s, 0.01, params.test_s);
  require("calm_s", params.calm_s, 0.05, 60.0);
  require("forget_s", params.forget_s, 0.1, 3600.0);
}

VibrationReference::VibrationReference(const ReferenceParams& params)
    : params_(Validated(params)), reference2_(params.tremor_N * params.tremor_N) {}

void VibrationReference::Reset() OSTEON_RT {
  reference2_ = params_.tremor_N * params_.tremor_N;
  suspected_s_ = tested_s_ = calm_s_ = unconfirmed_s_ = before2_ = left2_ = beat_limit2_ = 0.0;
  since_s_ = 2.0 * kBeat_s;
  testing_ = watchful_ = attributed_to_hand_ = false;
}

double VibrationReference::reference_N() const OSTEON_RT { return std::sqrt(reference2_); }

// At the end of a test, decides by the remaining energy whether the vibration was a tremor or the loop's
// oscillation, or whether the test is extended.
void VibrationReference::EvaluateTest() OSTEON_RT {
  if (tested_s_ < params_.test_s) return;
  if (!watchful_) {
    watchful_ = kBeats * left2_ < before2_;
    if (watchful_) {
      left2_ = 0.0;
      return;
    }
    reference2_ = std::max({reference2_, left2_, before2_});
    attributed_to_hand_ = true;
  } else {
    if (tested_s_ < params_.test_s + params_.hold_s) return;
    watchful_ = kLightens * left2_ < before2_;
    reference2_ = left2_;
    attributed_to_hand_ = !watchful_;
  }
  testing_ = false;
  beat_limit2_ = params_.margin * params_.margin * reference2_;
  suspected_s_ = calm_s_ = unconfirmed_s_ = since_s_ = before2_ = 0.0;
}

void VibrationReference::Step(double oscillation_energy, double raw_index, double index, double min_energy,
                              double dt_s) OSTEON_RT {
  // during a test: find the largest energy in the test's measured part
  if (testing_) {
    tested_s_ += dt_s;
    const double from_s =
        tested_s_ > params_.test_s ? params_.test_s + kSettle_s : params_.test_s - params_.listen_s;
    if (tested_s_ > from_s) left2_ = std::max(left2_, oscillation_energy);
    EvaluateTest();
    return;
  }
  // for kBeat_s after a test that found a tremor, R follows the tremor's beats
  since_s_ += dt_s;
  if (since_s_ >= kBeat_s) {
    if (raw_index > 0.0) attributed_to_hand_ = false;
  } else if (!watchful_) {
    reference2_ = std::max(reference2_, std::min(oscillation_energy, beat_limit2_));
  }
  // The suspected time decays slowly, because an oscillation near the threshold is intermittent.
  const bool suspected = raw_index > (watchful_ ? kSure : 0.0);
  suspected_s_ += suspected ? dt_s : -dt_s / kTrust_s * suspected_s_;
  before2_ = std::max(oscillation_energy, before2_ - dt_s / kTrust_s * before2_);
  if (suspected_s_ > params_.suspect_s) {
    testing_ = true;
    watchful_ = false;
    tested_s_ = left2_ = 0.0;
    return;
  }

  calm_s_ = oscillation_energy < min_energy ? calm_s_ + dt_s : 0.0;
  if (calm_s_ > params_.calm_s && index < kLight) watchful_ = false;
  unconfirmed_s_ =
      oscillation_energy * params_.margin * params_.margin < reference2_ ? unconfirmed_s_ + dt_s : 0.0;
  // slow return to tremor_N
  const double prior2 = params_.tremor_N * params_.tremor_N;
  const bool down = reference2_ > prior2 && unconfirmed_s_ > params_.calm_s;
  const bool up = reference2_ < prior2 && !watchful_ && calm_s_ > params_.calm_s;
  if (down || up) reference2_ += dt_s / params_.forget_s * (prior2 - reference2_);
}

}  // namespace osteon::control
