#include "studies/identify/hand_tremor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/percentile.h"
#include "control/stability/biquad.h"

namespace osteon::studies {
namespace {

constexpr double kMinSeconds = 5.0;  // least length of the signal
constexpr double kSettle_s = 1.0;    // beginning that is left out: the filters settle
constexpr double kWindow_s = 0.2;    // window of one RMS value
constexpr double kShare = 0.999;     // percentile of the RMS values that is reported
constexpr double kLow_hz = 5.0, kHigh_hz = 40.0, kQ = 0.7071067811865476;  // band; Butterworth filters
// Accepted mean factor on the drag; factor on tremor_N in each step.
constexpr double kMaxDrag = 1.02, kStep = 1.2;
constexpr int kMaxSteps = 30;
constexpr double kLeast_N = 1e-3;  // smallest tremor_N

// RMS of the force between 5 and 40 Hz over a sliding window [N], one value per tick from kSettle_s on.
std::vector<double> EffectiveForce(std::span<const Wrench> F_T, double period_s) {
  using control::Biquad;
  const double high_hz = std::min(kHigh_hz, 0.4 / period_s);
  Biquad high = Biquad::HighPass(kLow_hz, kQ, period_s), low = Biquad::LowPass(high_hz, kQ, period_s);
  const auto window = static_cast<std::size_t>(std::lround(kWindow_s / period_s));
  std::vector<double> squares, effective;
  double sum = 0.0;
  for (const Wrench& F : F_T) {
    const Vector3 band = low.Step(high.Step(Vector3(F.f - F_T.front().f)));
    squares.push_back(band.squaredNorm());
    sum += squares.back();
    if (squares.size() > window) sum -= squares[squares.size() - 1 - window];
    if (static_cast<double>(squares.size()) * period_s > kSettle_s)
      effective.push_back(std::sqrt(std::max(0.0, sum) / static_cast<double>(window)));
  }
  return effective;
}

// Mean factor of the vibration index on the drag over the recording, with the given tremor_N.
double MeanDrag(std::span<const Wrench> F_T, control::VibrationParams params, double tremor_N,
                double period_s) {
  params.reference.tremor_N = tremor_N;
  control::VibrationIndex index(params, period_s);
  double sum = 0.0;
  for (const Wrench& F : F_T) {
    index.Step(F, 0.0);
    sum += index.damping_factor();
  }
  return sum / static_cast<double>(F_T.size());
}

}  // namespace

HandTremor MeasureTremor(std::span<const Wrench> F_T, const control::VibrationParams& params,
                         double period_s) {
  HandTremor tremor{.seconds = period_s * static_cast<double>(F_T.size())};
  if (tremor.seconds < kMinSeconds) return tremor;
  Vector3 mean_N = Vector3::Zero();
  for (const Wrench& F : F_T) mean_N += F.f / static_cast<double>(F_T.size());
  tremor.push_N = mean_N.norm();
  std::vector<double> effective = EffectiveForce(F_T, period_s);
  tremor.p999_N = base::LowerPercentile(effective, kShare);
  tremor.tremor_N = std::max(kLeast_N, tremor.p999_N);
  for (int step = 0; step < kMaxSteps; ++step) {
    tremor.drag_factor = MeanDrag(F_T, params, tremor.tremor_N, period_s);
    if (tremor.drag_factor <= kMaxDrag) break;
    tremor.tremor_N *= kStep;
  }
  return tremor;
}

}  // namespace osteon::studies
