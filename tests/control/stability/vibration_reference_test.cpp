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

// The index in closed loop: a hand's tremor that stays at any drag, and an oscillation that grows below a
// certain drag and dies above it.

namespace osteon::control {
namespace {

constexpr double kDt_s = 1e-3;
constexpr double kTau = 2.0 * std::numbers::pi;

// Three beating lines along one axis, with a peak of 1.
double Beating(double t_s) {
  return (std::sin(kTau * 8.3 * t_s) + std::sin(kTau * 9.7 * t_s + 1.0) + std::sin(kTau * 11.1 * t_s + 2.0)) /
         3.0;
}

// Amplitude of an oscillation at 12 Hz; the noise starts it and keeps it from dying out completely.
struct Oscillation {
  double needs{5.0};        // times the law's drag; below it the oscillation grows
  double rate_per_s{15.0};  // e-folds, growing or decaying
  double amplitude_N{0.02};
  double Step(double t_s, double damping_factor) {
    amplitude_N *= std::exp(kDt_s * (damping_factor < needs ? rate_per_s : -rate_per_s));
    amplitude_N = std::clamp(amplitude_N, 0.02, 100.0);
    return amplitude_N * std::sin(kTau * 12.0 * t_s);
  }
};

struct Ride {
  VibrationIndex index{{}, kDt_s};
  double t_s{0.0}, most_index{0.0}, heavy_s{0.0}, most_N{0.0};  // since Mark
  void Mark() { most_index = heavy_s = most_N = 0.0; }
  void Go(double seconds, const std::function<double(double t_s)>& force_N) {
    for (const double end_s = t_s + seconds; t_s < end_s; t_s += kDt_s) {
      const double f = force_N(t_s);
      index.Step({.f = f * Vector3(2.0, -1.0, 2.0) / 3.0, .t = Vector3::Zero()}, 0.0);
      most_index = std::max(most_index, index.index());
      if (index.damping_factor() > 2.0) heavy_s += kDt_s;
      most_N = std::max(most_N, std::abs(f));
    }
  }
};

TEST(VibrationReference, ATremorMakesTheToolHeavyOnceAndIsThenKnown) {
  for (const double peak_N : {1.0, 2.0, 3.0}) {
    Ride run;
    run.Go(2.0, [](double) { return 10.0; });
    run.Go(3.0, [&](double t) { return 10.0 + peak_N * Beating(t); });
    EXPECT_GT(run.most_index, 0.9) << peak_N << ": it has been tested";
    EXPECT_LT(run.heavy_s, 1.7) << peak_N;
    run.Mark();
    run.Go(60.0, [&](double t) { return 10.0 + peak_N * Beating(t); });
    EXPECT_LT(run.most_index, 0.01) << peak_N << ": known, and not forgotten while it lasts";
    // the largest of the beat, as an effective value, is peak / sqrt(2)
    EXPECT_GT(run.index.reference_N(), 0.5 * peak_N / std::numbers::sqrt2);
    EXPECT_LT(run.index.reference_N(), 1.3 * peak_N / std::numbers::sqrt2);
  }
}

// Just above the threshold the tremor is suspected only now and then: the suspicion accumulates.
TEST(VibrationReference, ATremorJustBeyondWhatIsNotSuspectedIsKnownAfterSeconds) {
  Ride run;
  run.Go(10.0, [](double t) { return 0.5 * Beating(t); });
  EXPECT_GT(run.most_index, 0.9);
  run.Mark();
  run.Go(60.0, [](double t) { return 0.5 * Beating(t); });
  EXPECT_LT(run.most_index, 0.01);
}

TEST(VibrationReference, AFaintTremorIsNotSuspected) {
  Ride run;
  run.Go(60.0, [](double t) { return 10.0 + 0.3 * Beating(t); });
  EXPECT_LT(run.most_index, 0.01);
}

TEST(VibrationReference, WhatDiesUnderDragIsTheLoopsAndStaysSmall) {
  for (const double needs : {1.2, 5.0, 20.0}) {
    Ride run;
    Oscillation loop{.needs = needs};
    const auto shaken = [&](double t) { return loop.Step(t, run.index.damping_factor()); };
    run.Go(1.0, shaken);
    EXPECT_GT(run.most_index, 0.02) << needs;
    run.Mark();
    run.Go(30.0, shaken);
    EXPECT_LT(run.most_N, 1.2) << needs << ": limited, and not taken for a tremor with time";
    EXPECT_LT(run.index.reference_N(), 0.25) << needs;
  }
}

TEST(VibrationReference, ALoopThatOscillatesInAKnownTremorIsSeen) {
  Ride run;
  run.Go(5.0, [](double t) { return Beating(t); });
  const double known_N = run.index.reference_N();
  Oscillation loop{.needs = 10.0};
  const auto both = [&](double t) { return Beating(t) + loop.Step(t, run.index.damping_factor()); };
  run.Go(1.0, both);
  run.Mark();
  run.Go(30.0, both);
  EXPECT_LT(run.most_N, 4.0) << "the margin on the tremor, and what grows until it is seen";
  EXPECT_LT(run.index.reference_N(), 1.3 * known_N) << "the reference does not follow the loop";
}

TEST(VibrationReference, IsForgottenWithinHalfAMinute) {
  Ride run;
  run.Go(3.0, [](double t) { return 2.0 * Beating(t); });
  const ReferenceParams params;
  const double known_N = run.index.reference_N();
  const auto still = [](double) { return 0.0; };
  run.Go(params.calm_s + 1.0, still);
  EXPECT_GT(run.index.reference_N(), 0.9 * known_N);
  const double before = std::pow(run.index.reference_N(), 2) - std::pow(params.tremor_N, 2);
  run.Go(params.forget_s, still);
  const double after = std::pow(run.index.reference_N(), 2) - std::pow(params.tremor_N, 2);
  EXPECT_NEAR(after / before, std::exp(-1.0), 1e-3) << "an explicit step of 1 ms";
  run.Mark();
  run.Go(2.0, [](double t) { return 2.0 * Beating(t); });
  EXPECT_GT(run.most_index, 0.9) << "and tested again";
}

TEST(VibrationReference, AfterACalmedLoopItComesBackToWhatAHandMayDo) {
  Ride run;
  Oscillation loop;
  run.Go(10.0, [&](double t) { return loop.Step(t, run.index.damping_factor()); });
  const double low_N = run.index.reference_N();
  ASSERT_LT(low_N, 0.1);
  run.Go(8.0, [](double) { return 0.0; });  // the index decays, the grip is loose again
  run.Go(100.0, [](double) { return 0.0; });
  EXPECT_NEAR(run.index.reference_N(), ReferenceParams{}.tremor_N, 0.01);
}

TEST(VibrationReference, RefusesWhatItCanNotBe) {
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
