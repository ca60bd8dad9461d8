#include "control/excitation/excitation_path.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

// Tests the excitation that identifies the arm: the multisine (its spectrum and peak), and the path that
// connects several random multisines (draws) with fades and pauses.

namespace osteon::control {
namespace {

// Offsets [m] of one period of 4 s, sampled every millisecond.
std::vector<double> PeriodOf(const Multisine& motion) {
  std::vector<double> x_m;
  for (int k = 0; k < 4000; ++k) x_m.push_back(motion.At(1e-3 * k).x_m);
  return x_m;
}

// Amplitude of one harmonic in the period, as a Fourier sum.
double AmplitudeAt(const std::vector<double>& x_m, int harmonic) {
  std::complex<double> sum = 0.0;
  for (int k = 0; k < 4000; ++k)
    sum +=
        x_m[static_cast<std::size_t>(k)] * std::polar(1.0, -2.0 * std::numbers::pi * harmonic * k / 4000.0);
  return 2.0 * std::abs(sum) / 4000.0;
}

TEST(Multisine, HasPowerOnlyOnItsOwnHarmonics) {
  const Multisine motion(1, 0.05);
  const std::vector<double> x_m = PeriodOf(motion);
  const auto harmonics = Multisine::Harmonics();
  for (int h = 1; h < 300; ++h) {
    const auto line = std::ranges::find(motion.lines(), h, &MultisineLine::harmonic);
    const bool excited = std::ranges::find(harmonics, h) != harmonics.end();
    ASSERT_EQ(line != motion.lines().end(), excited) << h;
    EXPECT_NEAR(AmplitudeAt(x_m, h), excited ? line->amplitude_m : 0.0, 1e-12) << h;
    if (excited) {
      EXPECT_TRUE(h % 2 == 1 && !Multisine::IsEmptyOdd(h)) << h;
    }
  }
  EXPECT_EQ(harmonics.front(), 3);
  EXPECT_EQ(harmonics.back(), 237);
}

TEST(Multisine, SpeedIsFlatUpTo20HzAndAccelerationAbove) {
  const Multisine motion(1, 0.05);
  for (const MultisineLine& line : motion.lines()) {
    // amplitude of the speed, divided by 2 pi
    const double hz = Multisine::Frequency(line.harmonic), speed = line.amplitude_m * hz;
    const double first_speed = motion.lines()[0].amplitude_m * Multisine::Frequency(3);
    EXPECT_NEAR(speed, first_speed * std::min(1.0, 20.0 / hz), 1e-12) << hz;
  }
}

TEST(Multisine, HasTheRequestedPeakSpeedAndASmallCrestFactor) {
  for (const std::uint64_t seed : {1u, 2u, 77u}) {
    const Multisine motion(seed, 0.05);
    EXPECT_NEAR(motion.peak().v_m_per_s, 0.05, 1e-12);
    EXPECT_LT(motion.peak().v_m_per_s / motion.rms_speed_m_per_s(),
              2.7);  // limit of the crest factor; with arbitrary random phases it is 3 or more
    EXPECT_LT(motion.peak().x_m, 0.0035);
    EXPECT_LT(motion.peak().a_m_per_s2, 8.0);
  }
  EXPECT_NE(Multisine(1, 0.05).At(0.1).x_m, Multisine(2, 0.05).At(0.1).x_m);
  EXPECT_EQ(Multisine(1, 0.05).At(0.1).x_m, Multisine(1, 0.05).At(0.1).x_m);
  EXPECT_THROW(Multisine(1, 0.0), std::invalid_argument);
}

TEST(ExcitationPath, CountsEachPeriodOfEachDrawAndMovesSmoothly) {
  const ExcitationParams params{.draws = 2, .periods = 2};
  ExcitationPath path(params, 1e-3);
  std::vector<double> x{0.0};
  int counted[2][2] = {};  // number of ticks for each draw and period
  ExcitationStep step;
  while (step.part != ExcitationPart::kDone) {
    {
      rt::CheckedNoAllocScope no_alloc;
      step = path.Step(true);
    }
    if (step.part == ExcitationPart::kCounted) ++counted[step.draw][step.period];
    x.push_back(step.x_m);
    ASSERT_LT(x.size(), 40000u);
  }
  for (const auto& draw : counted)
    for (const int ticks : draw) EXPECT_EQ(ticks, 4000);
  EXPECT_EQ(x.back(), 0.0);
  EXPECT_NEAR(1e-3 * static_cast<double>(x.size()), path.duration_s(), 0.01);
  for (std::size_t k = 2; k < x.size(); ++k) {
    EXPECT_LT(std::abs(x[k] - x[k - 1]), 0.06e-3);  // at most 60 mm/s, including the cross-fade
    EXPECT_LT(std::abs(x[k] - 2.0 * x[k - 1] + x[k - 2]), 10e-6)
        << k;  // at most 10 m/s², so there is no jolt between the parts of the path
  }
}

TEST(ExcitationPath, PausesWithinHalfASecondAndRepeatsTheInterruptedPeriod) {
  ExcitationPath path({.draws = 2, .periods = 2}, 1e-3);
  ExcitationStep step;
  while (step.part != ExcitationPart::kCounted || step.period != 1) step = path.Step(true);
  for (int k = 0; k < 1000; ++k) step = path.Step(true);
  int to_rest = 0;
  while (!step.at_rest) {
    step = path.Step(false);
    ASSERT_LE(++to_rest, 501);
  }
  const double resting_m = step.x_m;
  for (int k = 0; k < 100; ++k) EXPECT_EQ(path.Step(false).x_m, resting_m);
  int settling = 0;
  do {
    step = path.Step(true);
    ++settling;
  } while (step.part != ExcitationPart::kCounted);
  EXPECT_GE(settling, 4000);
  EXPECT_EQ(step.period, 1) << "the period that was cut is measured again";
}

TEST(ExcitationPath, ScalesDownToTravelAndAcceleration) {
  const ExcitationPath by_travel({.max_travel_m = 1e-3}, 1e-3);
  EXPECT_LE(by_travel.peak().x_m, 1e-3 * (1.0 + 1e-12));
  const ExcitationPath by_acceleration({.max_acceleration_m_per_s2 = 2.0}, 1e-3);
  EXPECT_LE(by_acceleration.peak().a_m_per_s2, 2.0 * (1.0 + 1e-12));
  EXPECT_LT(by_acceleration.rms_speed_m_per_s(), ExcitationPath({}, 1e-3).rms_speed_m_per_s());
}

TEST(ExcitationPath, RefusesParametersOutOfRange) {
  EXPECT_THROW(ExcitationPath({.draws = 0}, 1e-3), std::invalid_argument);
  EXPECT_THROW(ExcitationPath({.periods = 0}, 1e-3), std::invalid_argument);
  EXPECT_THROW(ExcitationPath({.max_travel_m = 0.0}, 1e-3), std::invalid_argument);
  EXPECT_THROW(ExcitationPath({.pause_s = 0.01}, 1e-3), std::invalid_argument);
  EXPECT_THROW(ExcitationPath({}, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
