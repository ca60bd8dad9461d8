#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "simulation/metrics/ripple.h"

// Tests of the ripple of a force in a slow and a fast band of frequencies. Oracles: the known rms of sines,
// and Parseval's theorem for noise.

namespace osteon::simulation {
namespace {

constexpr double kRate_hz = 1000.0;

/// A sine sampled at kRate_hz, plus a mean and a slope per second.
std::vector<double> Sine(std::size_t count, double amplitude, double hz, double mean = 0.0,
                         double slope = 0.0) {
  std::vector<double> signal(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / kRate_hz;
    signal[i] = mean + slope * t + amplitude * std::sin(2.0 * std::numbers::pi * hz * t + 0.3);
  }
  return signal;
}

// The window's main lobe is four bins wide and lies within the band. Its side lobes in the other band have
// less than 1e-3 of the sine's amplitude.
TEST(Ripple, ASineCountsWithItsRmsInItsOwnBandOnly) {
  for (const double hz : {12.0, 25.4, 30.0}) {
    const std::vector<double> slow = Sine(1000, 3.0, hz);
    EXPECT_NEAR(BandRms(slow, kRate_hz, kSlowRipple), 3.0 / std::sqrt(2.0), 2e-3) << hz;
    EXPECT_LT(BandRms(slow, kRate_hz, kFastRipple), 2e-3) << hz;
  }
  for (const double hz : {60.0, 171.3, 490.0}) {
    const std::vector<double> fast = Sine(1000, 0.5, hz);
    EXPECT_NEAR(BandRms(fast, kRate_hz, kFastRipple), 0.5 / std::sqrt(2.0), 2e-3) << hz;
    EXPECT_LT(BandRms(fast, kRate_hz, kSlowRipple), 1e-3) << hz;
  }
}

TEST(Ripple, LeavesOutTheMeanAndALinearDrift) {
  const std::vector<double> signal = Sine(2000, 1.0, 20.0, 50.0, 30.0);
  const Ripple ripple = MeasureRipple(signal, kRate_hz);
  // the last of 2000 samples is at 1.999 s, so the drift's mean is 30 N/s times 0.9995 s
  EXPECT_NEAR(ripple.mean_N, 50.0 + 30.0 * 0.9995, 0.02);
  EXPECT_NEAR(ripple.slow_N, std::sqrt(0.5), 5e-3);
  EXPECT_LT(ripple.fast_N, 5e-3);
  EXPECT_NEAR(ripple.relative(), std::sqrt(0.5) / ripple.mean_N, 1e-4);
  EXPECT_LT(BandRms(Sine(2000, 0.0, 1.0, 7.0, -4.0), kRate_hz, kSlowRipple), 1e-12);
}

// Parseval: white noise of variance v has v (high - low) / (rate / 2) in a band. With n samples the
// estimate's relative standard error of v is about sqrt(2 / n), times the window's 1.4: 3 % at n = 4000.
TEST(Ripple, WhiteNoiseCountsWithTheBandsShareOfTheSpectrum) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal(0.0, 2.0);
  std::vector<double> noise(4000);
  for (double& value : noise) value = normal(random);
  EXPECT_NEAR(BandRms(noise, kRate_hz, {0.0, 500.0}), 2.0, 0.08);
  const double slow = BandRms(noise, kRate_hz, {0.0, 125.0}),
               fast = BandRms(noise, kRate_hz, {125.25, 500.0});
  EXPECT_NEAR(slow, 1.0, 0.08);
  EXPECT_NEAR(std::hypot(slow, fast), BandRms(noise, kRate_hz, {0.0, 500.0}), 1e-9);
}

TEST(Ripple, IsZeroForTooFewSamples) {
  EXPECT_EQ(BandRms({}, kRate_hz, kSlowRipple), 0.0);
  EXPECT_EQ(BandRms(std::vector<double>{1, 2, 1, 2, 1}, kRate_hz, kFastRipple), 0.0);
  EXPECT_EQ(MeasureRipple({}, kRate_hz).relative(), 0.0);
}

}  // namespace
}  // namespace osteon::simulation
