#include "control/stability/vibration_index.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "control/laws/admittance_law.h"
#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::control {
namespace {

constexpr double kDt_s = 1e-3;

double Sine(double hz, double t_s) { return std::sin(2.0 * std::numbers::pi * hz * t_s); }

// The vibration index after the force has acted along one direction for `seconds`.
double IndexAfter(double seconds, const std::function<double(double t_s)>& force_N,
                  double spindle_rad_per_s = 0.0, const VibrationParams& params = {}) {
  VibrationIndex index(params, kDt_s);
  const Vector3 direction = Vector3(1.0, -2.0, 2.0) / 3.0;
  for (int i = 0; i < static_cast<int>(std::lround(seconds / kDt_s)); ++i)
    index.Step({.f = force_N(i * kDt_s) * direction, .t = Vector3::Zero()}, spindle_rad_per_s);
  return index.index();
}

// The largest vibration index while the force acts along one direction for `seconds`.
double LargestIndex(double seconds, const std::function<double(double t_s)>& force_N,
                    double spindle_rad_per_s = 0.0) {
  VibrationIndex index({}, kDt_s);
  double largest = 0.0;
  for (int i = 0; i < static_cast<int>(std::lround(seconds / kDt_s)); ++i)
    largest = std::max(largest, index.Step({.f = force_N(i * kDt_s) * Vector3::UnitY(), .t = Vector3::Zero()},
                                           spindle_rad_per_s));
  return largest;
}

// Two filters in series, whose Q factors are those of a fourth-order Butterworth filter, must have its gain
// |H|^2 = 1 / (1 + (f/f_c)^8). The frequencies are warped by tan(pi f T). The gain is measured with sines.
TEST(Biquad, HasButterworthsGain) {
  const auto gain = [](Biquad a, Biquad b, double hz) {
    double power = 0.0;
    constexpr int kTicks = 8000, kSettled = 4000;
    for (int i = 0; i < kTicks; ++i) {
      const double y = b.Step(a.Step(Vector3(Sine(hz, i * kDt_s), 0.0, 0.0))).x();
      if (i >= kSettled) power += y * y;
    }
    return std::sqrt(2.0 * power / (kTicks - kSettled));
  };
  const auto warped = [](double hz) { return std::tan(std::numbers::pi * hz * kDt_s); };
  for (const double hz : {2.0, 5.0, 8.0, 20.0, 100.0}) {
    const double ratio = std::pow(warped(hz) / warped(8.0), 8.0);
    const Biquad low_a = Biquad::LowPass(8.0, 0.5411961, kDt_s),
                 low_b = Biquad::LowPass(8.0, 1.3065630, kDt_s);
    const Biquad high_a = Biquad::HighPass(8.0, 0.5411961, kDt_s),
                 high_b = Biquad::HighPass(8.0, 1.3065630, kDt_s);
    EXPECT_NEAR(gain(low_a, low_b, hz), std::sqrt(1.0 / (1.0 + ratio)), 1e-4) << hz;
    EXPECT_NEAR(gain(high_a, high_b, hz), std::sqrt(ratio / (1.0 + ratio)), 1e-4) << hz;
  }
}

TEST(VibrationIndex, A12HzOscillationRaisesTheIndexWithinAPeriodAndAHalf) {
  const auto shaken = [](double t) { return t < 1.0 ? 20.0 : 20.0 + 5.0 * Sine(12.0, t - 1.0); };
  EXPECT_EQ(IndexAfter(1.0, shaken), 0.0);
  EXPECT_GT(IndexAfter(1.05, shaken), 0.1) << "alerted";
  EXPECT_GT(IndexAfter(1.125, shaken), 0.5);
  EXPECT_GT(IndexAfter(1.3, shaken), 0.95);
}

// A force that steps to 50 N and stays there does not swing back. So the index must stay below alert_index.
TEST(VibrationIndex, AJoltRaisesTheIndexBrieflyAndAtMostToTheAlertLevel) {
  const VibrationParams params;
  const auto jolt = [](double t) { return t < 1.0 ? 0.0 : 50.0; };
  EXPECT_GT(IndexAfter(1.05, jolt), 0.1);
  EXPECT_LE(LargestIndex(3.0, jolt), params.alert_index);
  EXPECT_LT(IndexAfter(1.3, jolt), 0.01);
}

// Oscillations of 10 Hz that last or grow must count with their amplitude. Signals that decay, are slower,
// are faster or have one sign must not count.
TEST(HalfWaves, CountOnlyLastingSwingsToAndFro) {
  const auto amplitude = [](const std::function<double(double t_s)>& x) {
    HalfWaves waves(0.01, 0.11);
    double last = 0.0;
    for (int i = 0; i < 1000; ++i) last = waves.Step(x(i * kDt_s), kDt_s);
    return last;
  };
  EXPECT_NEAR(amplitude([](double t) { return 3.0 * Sine(10.0, t); }), 3.0, 0.01);
  EXPECT_NEAR(amplitude([](double t) { return std::exp(20.0 * (t - 1.0)) * Sine(10.0, t); }), 0.6, 0.2)
      << "grows";
  EXPECT_EQ(amplitude([](double t) { return 1e3 * std::exp(-15.0 * t) * Sine(10.0, t); }), 0.0)
      << "each half-wave half as large as the one before, and less";
  EXPECT_EQ(amplitude([](double t) { return Sine(2.0, t); }), 0.0) << "slow";
  EXPECT_EQ(amplitude([](double t) { return Sine(120.0, t); }), 0.0) << "quick";
  EXPECT_EQ(amplitude([](double t) { return t < 0.5 ? 0.0 : 1.0; }), 0.0);
  EXPECT_NEAR(amplitude([](double t) { return 3.0 * Sine(10.0, t) + 0.1 * Sine(333.0, t); }), 3.0, 0.2)
      << "what rides on it turns no half-wave";
}

TEST(VibrationIndex, AnOscillatingTorqueCountsAsAForceAtALever) {
  VibrationIndex index({}, kDt_s);
  for (int i = 0; i < 300; ++i)
    index.Step({.f = Vector3::Zero(), .t = 0.3 * Sine(12.0, i * kDt_s) * Vector3::UnitX()}, 0.0);
  EXPECT_GT(index.index(), 0.9);
}

TEST(VibrationIndex, SlowMotionPushAndNoiseDoNotRaiseTheIndex) {
  const auto slow = [](double t) { return 80.0 * (1.0 - std::cos(2.0 * std::numbers::pi * 0.7 * t)); };
  for (const double t : {1.0, 2.0, 2.3, 2.6, 6.0}) EXPECT_LT(IndexAfter(t, slow), 0.01) << "slow motion";
  EXPECT_LE(LargestIndex(6.0, slow), VibrationParams{}.alert_index) << "its beginning may alert";
  EXPECT_LT(IndexAfter(0.8, [](double t) { return t < 0.5 ? 0.0 : std::min(100.0, 200.0 * (t - 0.5)); }),
            0.02)
      << "a push of 100 N within half a second";
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.1);
  EXPECT_LT(LargestIndex(6.0, [&](double) { return 50.0 + noise(random); }), 0.01) << "the sensor's noise";
}

TEST(VibrationIndex, TheSpindlesHarmonicsDoNotRaiseTheIndex) {
  const double hz = 250.0 / 60.0;  // 250 revolutions per minute
  const auto cut = [hz](double t) {
    double f = 30.0;
    for (int n = 1; n <= 6; ++n) f += 1.5 / n * Sine(n * hz, t + 0.01 * n) * std::min(1.0, t);
    return f;
  };
  const double spindle_rad_per_s = 2.0 * std::numbers::pi * hz;
  // the notch filters adapt within 0.2 s, and the index from before is forgotten within 1.2 s
  EXPECT_LT(IndexAfter(6.0, cut, spindle_rad_per_s), 0.02);
  EXPECT_GT(LargestIndex(6.0, cut, 0.0), 0.5) << "without the spindle's speed they are";
  // 10.4 Hz is halfway between the second harmonic and the third
  const auto cut_and_oscillation = [&](double t) { return cut(t) + (t < 6.0 ? 0.0 : 3.0 * Sine(10.4, t)); };
  EXPECT_GT(IndexAfter(6.3, cut_and_oscillation, spindle_rad_per_s), 0.5);
}

TEST(VibrationIndex, DecaysSixtyTimesSlowerThanItRises) {
  const VibrationParams params;
  VibrationIndex index(params, kDt_s);
  const auto step = [&index](double f) {
    return index.Step({.f = f * Vector3::UnitX(), .t = Vector3::Zero()}, 0.0);
  };
  // an oscillation of the loop, which dies out as soon as the virtual tool's damping is raised
  for (int i = 0; i < 1500; ++i) step(index.index() < 0.6 && i < 500 ? 5.0 * Sine(12.0, i * kDt_s) : 0.0);
  ASSERT_GT(index.index(), 0.5);
  EXPECT_NEAR(index.damping_factor(), 1.0 + index.index() * (params.max_damping_factor - 1.0), 1e-12);
  EXPECT_NEAR(index.mass_factor(), 1.0 + index.index() * (params.max_mass_factor - 1.0), 1e-12);
  for (int i = 0; i < 1000; ++i) step(0.0);  // until the index only decays and past force no longer raises it
  const double before = index.index();
  for (int i = 0; i < 1000; ++i) step(0.0);
  EXPECT_NEAR(index.index() / before, std::exp(-1.0 / (params.decay_ratio * params.rise_s)), 1e-3)
      << "an explicit step of 1 ms";
  index.Reset();
  EXPECT_EQ(index.index(), 0.0);
  EXPECT_EQ(index.damping_factor(), 1.0);
}

TEST(VibrationIndex, SwitchedOffTheIndexRisesButTheFactorsStayOne) {
  VibrationIndex index({.acts = false}, kDt_s);
  for (int i = 0; i < 350; ++i)
    index.Step({.f = 5.0 * Sine(12.0, i * kDt_s) * Vector3::UnitX(), .t = Vector3::Zero()}, 0.0);
  EXPECT_GT(index.index(), 0.9);
  EXPECT_EQ(index.damping_factor(), 1.0);
  EXPECT_EQ(index.mass_factor(), 1.0);
}

TEST(VibrationIndex, WorksAtASlowArmsPeriod) {
  for (const double period_s : {0.004, 0.012}) {
    VibrationIndex index({}, period_s);
    for (int i = 0; i * period_s < 0.4; ++i)
      index.Step({.f = 5.0 * Sine(8.0, i * period_s) * Vector3::UnitX(), .t = Vector3::Zero()}, 0.0);
    EXPECT_GT(index.index(), 0.9) << period_s;
  }
}

TEST(VibrationIndex, StaysFiniteForWildInputs) {
  VibrationIndex index({}, kDt_s);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> wild(-1e6, 1e6);
  for (int i = 0; i < 20'000; ++i) {
    Wrench F{.f = {wild(random), wild(random), wild(random)},
             .t = {wild(random), wild(random), wild(random)}};
    if (i % 7 == 0) F.f.x() = std::numeric_limits<double>::quiet_NaN();
    if (i % 11 == 0) F.t.y() = std::numeric_limits<double>::infinity();
    const double I = index.Step(F, wild(random) * 1e-3);
    ASSERT_TRUE(I >= 0.0 && I <= 1.0) << I;
  }
}

TEST(VibrationIndex, RefusesParametersOutOfRange) {
  EXPECT_THROW(VibrationIndex({.high_hz = 5.5}, kDt_s), std::invalid_argument);
  EXPECT_THROW(VibrationIndex({.decay_ratio = 0.5}, kDt_s), std::invalid_argument);
  EXPECT_THROW(VibrationIndex({.max_mass_factor = 0.9}, kDt_s), std::invalid_argument);
  EXPECT_THROW(VibrationIndex({}, 0.1), std::invalid_argument) << "low_hz beyond what such a rate shows";
}

TEST(VibrationIndex, DoesNotAllocate) {
  VibrationIndex index({}, kDt_s);
  rt::CheckedNoAllocScope no_alloc;
  for (int i = 0; i < 100; ++i)
    index.Step({.f = Sine(12.0, i * kDt_s) * Vector3::UnitX(), .t = Vector3::UnitY()}, 26.0);
}

TEST(AdmittanceLaw, AChangeOfMassCreatesNoKineticEnergy) {
  const Twist V{.v = {0.1, -0.2, 0.05}, .w = {0.3, 0.1, -0.2}};
  const AdmittanceParams params;
  const auto energy = [](const AdmittanceParams& p, const Twist& V_WT) {
    return 0.5 * (p.mass_kg.x() * V_WT.v.squaredNorm() + p.inertia_kg_m2.x() * V_WT.w.squaredNorm());
  };
  const double before = energy(params, V);
  EXPECT_NEAR(energy(ScaleLaw(params, 1.5, 7.0), AfterMassChange(V, 1.5)), before, 1e-15) << "heavier: kept";
  EXPECT_LT(energy(ScaleLaw(params, 0.5, 7.0), AfterMassChange(V, 0.5)), before);
  EXPECT_EQ(AfterMassChange(V, 0.5).v, V.v) << "lighter: the tool does not jump";
  EXPECT_EQ(AfterMassChange(V, 1.0).w, V.w);
}

}  // namespace
}  // namespace osteon::control
