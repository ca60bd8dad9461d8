#include "control/stability/vibration_reference.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "control/stability/vibration_index.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests the vibration index and its reference with two sources of vibration. A hand's tremor remains at any
// drag of the virtual tool. An oscillation of the loop grows below a certain drag and dies out above it.

namespace osteon::control {
namespace {

constexpr double kDt_s = 1e-3;
constexpr double kTau = 2.0 * std::numbers::pi;

// A tremor: the sum of three sines with nearby frequencies, which beat. Its peak is 1.
double BeatingTremor(double t_s) {
  return (std::sin(kTau * 8.3 * t_s) + std::sin(kTau * 9.7 * t_s + 1.0) + std::sin(kTau * 11.1 * t_s + 2.0)) /
         3.0;
}

// An oscillation of the loop at 12 Hz. Noise of 0.02 N starts the oscillation and keeps it from dying out.
struct Oscillation {
  double needs{5.0};        // factor on the law's drag below which the oscillation grows
  double rate_per_s{15.0};  // rate of the exponential growth or decay
  double amplitude_N{0.02};
  // @returns the force in the next tick [N]
  double Step(double t_s, double damping_factor) {
    amplitude_N *= std::exp(kDt_s * (damping_factor < needs ? rate_per_s : -rate_per_s));
    amplitude_N = std::clamp(amplitude_N, 0.02, 100.0);
    return amplitude_N * std::sin(kTau * 12.0 * t_s);
  }
};

// A run of the vibration index over a force. It keeps the largest values since the last ResetPeaks.
struct IndexRun {
  VibrationIndex index{{}, kDt_s};
  double t_s{0.0};  // time since the run began
  double max_index{0.0}, max_N{0.0};
  double heavy_s{0.0};  // time in which the drag was more than twice the law's drag
  void ResetPeaks() { max_index = heavy_s = max_N = 0.0; }
  void Run(double seconds, const std::function<double(double t_s)>& force_N) {
    for (const double end_s = t_s + seconds; t_s < end_s; t_s += kDt_s) {
      const double f = force_N(t_s);
      index.Step({.f = f * Vector3(2.0, -1.0, 2.0) / 3.0, .t = Vector3::Zero()}, 0.0);
      max_index = std::max(max_index, index.index());
      if (index.damping_factor() > 2.0) heavy_s += kDt_s;
      max_N = std::max(max_N, std::abs(f));
    }
  }
};

TEST(VibrationReference, ATremorRaisesTheDragOnceAndIsThenTolerated) {
  for (const double peak_N : {1.0, 2.0, 3.0}) {
    IndexRun run;
    run.Run(2.0, [](double) { return 10.0; });
    run.Run(3.0, [&](double t) { return 10.0 + peak_N * BeatingTremor(t); });
    EXPECT_GT(run.max_index, 0.9) << peak_N << ": it has been tested";
    EXPECT_LT(run.heavy_s, 1.7) << peak_N;
    run.ResetPeaks();
    run.Run(60.0, [&](double t) { return 10.0 + peak_N * BeatingTremor(t); });
    EXPECT_LT(run.max_index, 0.01) << peak_N << ": known, and not forgotten while it lasts";
    // the RMS value at the peak of the beat is peak / sqrt(2)
    EXPECT_GT(run.index.reference_N(), 0.5 * peak_N / std::numbers::sqrt2);
    EXPECT_LT(run.index.reference_N(), 1.3 * peak_N / std::numbers::sqrt2);
  }
}

// A tremor just above the threshold counts as vibration only at the peaks of its beat. These times add up
// until the index starts a test.
TEST(VibrationReference, ATremorJustAboveTheThresholdIsToleratedAfterSeconds) {
  IndexRun run;
  run.Run(10.0, [](double t) { return 0.5 * BeatingTremor(t); });
  EXPECT_GT(run.max_index, 0.9);
  run.ResetPeaks();
  run.Run(60.0, [](double t) { return 0.5 * BeatingTremor(t); });
  EXPECT_LT(run.max_index, 0.01);
}

TEST(VibrationReference, AFaintTremorIsNotSuspected) {
  IndexRun run;
  run.Run(60.0, [](double t) { return 10.0 + 0.3 * BeatingTremor(t); });
  EXPECT_LT(run.max_index, 0.01);
}

TEST(VibrationReference, AnOscillationThatDragDampsIsAttributedToTheLoop) {
  for (const double needs : {1.2, 5.0, 20.0}) {
    IndexRun run;
    Oscillation loop{.needs = needs};
    const auto shaken = [&](double t) { return loop.Step(t, run.index.damping_factor()); };
    run.Run(1.0, shaken);
    EXPECT_GT(run.max_index, 0.02) << needs;
    run.ResetPeaks();
    run.Run(30.0, shaken);
    EXPECT_LT(run.max_N, 1.2) << needs << ": limited, and not taken for a tremor with time";
    EXPECT_LT(run.index.reference_N(), 0.25) << needs;
  }
}

TEST(VibrationReference, ALoopOscillationOnTopOfAToleratedTremorIsLimited) {
  IndexRun run;
  run.Run(5.0, [](double t) { return BeatingTremor(t); });
  const double known_N = run.index.reference_N();
  Oscillation loop{.needs = 10.0};
  const auto tremor_and_loop = [&](double t) {
    return BeatingTremor(t) + loop.Step(t, run.index.damping_factor());
  };
  run.Run(1.0, tremor_and_loop);
  run.ResetPeaks();
  run.Run(30.0, tremor_and_loop);
  EXPECT_LT(run.max_N, 4.0) << "the margin on the tremor, and what grows until it is seen";
  EXPECT_LT(run.index.reference_N(), 1.3 * known_N) << "the reference does not follow the loop";
}

TEST(VibrationReference, IsForgottenWithTheTimeConstantOfThirtySeconds) {
  IndexRun run;
  run.Run(3.0, [](double t) { return 2.0 * BeatingTremor(t); });
  const ReferenceParams params;
  const double known_N = run.index.reference_N();
  const auto still = [](double) { return 0.0; };
  run.Run(params.calm_s + 1.0, still);
  EXPECT_GT(run.index.reference_N(), 0.9 * known_N);
  const double before = std::pow(run.index.reference_N(), 2) - std::pow(params.tremor_N, 2);
  run.Run(params.forget_s, still);
  const double after = std::pow(run.index.reference_N(), 2) - std::pow(params.tremor_N, 2);
  EXPECT_NEAR(after / before, std::exp(-1.0), 1e-3) << "an explicit step of 1 ms";
  run.ResetPeaks();
  run.Run(2.0, [](double t) { return 2.0 * BeatingTremor(t); });
  EXPECT_GT(run.max_index, 0.9) << "and tested again";
}

TEST(VibrationReference, ReturnsToTheToleratedTremorAfterALoopOscillation) {
  IndexRun run;
  Oscillation loop;
  run.Run(10.0, [&](double t) { return loop.Step(t, run.index.damping_factor()); });
  const double low_N = run.index.reference_N();
  ASSERT_LT(low_N, 0.1);
  run.Run(8.0, [](double) { return 0.0; });  // until the index has decayed
  run.Run(100.0, [](double) { return 0.0; });
  EXPECT_NEAR(run.index.reference_N(), ReferenceParams{}.tremor_N, 0.01);
}

TEST(VibrationReference, RefusesParametersOutOfRange) {
  EXPECT_THROW(VibrationReference({.margin = 0.9}), std::invalid_argument);
  EXPECT_THROW(VibrationReference({.test_s = 0.1, .listen_s = 0.2}), std::invalid_argument);
  EXPECT_THROW(VibrationReference({.tremor_N = -1.0}), std::invalid_argument);
}

TEST(VibrationReference, DoesNotAllocate) {
  VibrationReference reference({});
  rt::CheckedNoAllocScope no_alloc;
  for (int i = 0; i < 2000; ++i) reference.Step(i % 3, i < 1000 ? 1.0 : 0.0, 0.5, 0.01, kDt_s);
  reference.Reset();
}

}  // namespace
}  // namespace osteon::control
