#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "control/excitation/excited_hold.h"
#include "hil/arm/servo_arm.h"
#include "hil/operator/tremor.h"
#include "studies/identify/force_noise.h"
#include "studies/identify/hand_tremor.h"
#include "studies/identify/identify_estimate.h"
#include "studies/identify/identify_table.h"

// Estimates of the arm's mass that a hand feels, of the hand's tremor and of the spindle's forces. The true
// values are known and the seeds fixed.

namespace osteon::studies {
namespace {

using Complex = std::complex<double>;
constexpr double kTwoPi = 2.0 * std::numbers::pi, kPeriod_s = 1e-3;

// --- the mass by which a hand moves the arm ---

// A free run and a held run of an arm that yields to the hand like a mass of 1 / per_mass [kg]; 0: the arm
// does not yield.
IdentifyResult FreeAndHeld(double per_mass, double noise) {
  const ServoModel arm{.bandwidth_hz = 15.0, .damping_ratio = 1.0, .dead_time_s = 4e-3};
  const double w_n = kTwoPi * arm.bandwidth_hz, tool_kg = 1.2;
  std::mt19937_64 random(6);
  std::normal_distribution<double> unit(0.0, 1.0);
  AxisResult free{.request = {}, .recording = {}, .by_encoders = {}, .fit = {}};
  AxisResult held = free;
  held.request.held = true;
  held.force_over_position.emplace();
  for (const int harmonic : control::Multisine::Harmonics()) {
    const double hz = control::Multisine::Frequency(harmonic), w = kTwoPi * hz;
    const Complex P = SampledResponse(arm, kPeriod_s, hz), hand(2000.0 - w * w * 1.5, 60.0 * w);
    const Complex C = per_mass / Complex(w_n * w_n - w * w, 2.0 * w_n * w);
    const auto line = [&](Complex value, double sd) {
      return ResponseLine{
          .hz = hz, .value = value + sd * Complex(unit(random), unit(random)), .noise_sd = sd, .sd = sd};
    };
    free.by_encoders.lines.push_back(line(P, noise));
    held.by_encoders.lines.push_back(line(P / (1.0 + C * hand), noise));
    held.force_over_position->lines.push_back(
        line((tool_kg * w * w - hand) * std::polar(1.0, -w * 1.7e-3), 1.0));
  }
  free.fit = *FitServo(free.by_encoders.lines, kPeriod_s);
  free.tool = ToolForceFit{.mass_kg = {tool_kg, 0.01}, .delay_s = {1.7e-3, 1e-5}};
  held.hand = *FitHand(held.force_over_position->lines, tool_kg);
  IdentifyResult result{.cell = "demo", .valid_for = {}, .tool_mass_kg = tool_kg, .axes = {free, held}};
  FillFeltMasses(result);
  return result;
}

TEST(FeltMass, IsEstimatedFromAFreeAndAHeldRun) {
  const IdentifyResult result = FreeAndHeld(1.0 / 5.27, 1e-4);
  ASSERT_TRUE(result.axes[1].felt_mass_kg);
  EXPECT_NEAR(result.axes[1].felt_mass_kg->value, 5.27, 0.05 * 5.27);
  EXPECT_NEAR(result.axes[1].felt_mass_kg->value, 5.27, 2.0 * result.axes[1].felt_mass_kg->half_width);
  EXPECT_FALSE(result.axes[0].felt_mass_kg);
  const config::IdentifiedCell written = ToIdentified(result);
  ASSERT_EQ(written.arm.size(), 1u);
  EXPECT_EQ(written.arm[0].felt_mass_kg, result.axes[1].felt_mass_kg->value);
}

TEST(FeltMass, IsAbsentForAnArmThatDoesNotYield) {
  EXPECT_FALSE(FreeAndHeld(0.0, 1e-4).axes[1].felt_mass_kg);
}

// --- stability limits predicted from an identified arm ---

TEST(IdentifyTable, PredictsTheStabilityLimitsOfTheTrueArm) {
  const IdentifyTableParams params{.arm = {.bandwidth_hz = 15.0, .damping_ratio = 1.0, .dead_cycles = 4.0},
                                   .seeds = 3};
  const TableRow row = IdentifyRow({.name = "64 s"}, params),
                 lossy = IdentifyRow({.name = "lossy", .lost = 0.01}, params);
  for (const TableRow& one : {row, lossy}) {
    EXPECT_EQ(one.failed, 0);
    EXPECT_NEAR(one.least_drag_Ns_per_m.mean, one.least_drag_Ns_per_m.truth,
                0.005 * one.least_drag_Ns_per_m.truth);
    EXPECT_NEAR(one.greatest_wall_N_per_m.mean, one.greatest_wall_N_per_m.truth,
                0.02 * one.greatest_wall_N_per_m.truth);
    EXPECT_LT(one.greatest_wall_N_per_m.two_sd, 0.05 * one.greatest_wall_N_per_m.truth);
    EXPECT_NEAR(one.lag_ms.mean, one.lag_ms.truth, 0.02);
  }
  EXPECT_EQ(row.seconds, 64.0);
  // one more millisecond of dead time must lower the stiffest wall by a third, as in the prototype of this
  // study
  hil::ServoArmParams late = params.arm;
  late.dead_cycles += 1.0;
  EXPECT_LT(GreatestWall(late, kPeriod_s), 0.8 * GreatestWall(params.arm, kPeriod_s));
  EXPECT_GT(LeastDrag(late, kPeriod_s), 1.02 * LeastDrag(params.arm, kPeriod_s));
}

// --- the hand's tremor ---

// The sensor's wrench, each period, of a trembling hand that pushes along z.
std::vector<Wrench> TremorOf(double peak_N, double push_N, double seconds) {
  const hil::Tremor tremor(peak_N, 3);
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise(0.0, 0.05);
  std::vector<Wrench> F;
  for (int k = 0; k < static_cast<int>(seconds / kPeriod_s); ++k)
    F.push_back({.f = tremor.ForceAt(kPeriod_s * k) + Vector3(noise(random), noise(random), push_N),
                 .t = Vector3::Zero()});
  return F;
}

TEST(HandTremor, AddsNoDragWithTheShippedIndex) {
  const control::VibrationParams index;
  const std::vector<Wrench> F = TremorOf(1.0, 60.0, 20.0);
  const HandTremor tremor = MeasureTremor(F, index, kPeriod_s);
  // three sinusoids of a third each on three axes; if all are in phase, the RMS value is sqrt(3 / 2)
  EXPECT_GT(tremor.p999_N, 0.5);
  EXPECT_LT(tremor.p999_N, 1.3);
  EXPECT_GE(tremor.tremor_N, tremor.p999_N);
  EXPECT_LE(tremor.drag_factor, 1.02);
  EXPECT_NEAR(tremor.push_N, 60.0, 0.1);
  EXPECT_EQ(tremor.seconds, 20.0);

  // an index that accepts a smaller tremor than the hand's adds drag
  control::VibrationParams half = index;
  half.reference.tremor_N = 0.3 * tremor.tremor_N;
  control::VibrationIndex suspicious(half, kPeriod_s);
  double drag = 0.0;
  for (const Wrench& wrench : F) {
    suspicious.Step(wrench, 0.0);
    drag += suspicious.damping_factor() / static_cast<double>(F.size());
  }
  EXPECT_GT(drag, 1.02);

  EXPECT_NEAR(MeasureTremor(TremorOf(2.0, 60.0, 20.0), index, kPeriod_s).p999_N, 2.0 * tremor.p999_N,
              0.1 * tremor.p999_N);
  EXPECT_EQ(MeasureTremor(TremorOf(1.0, 0.0, 4.0), index, kPeriod_s).tremor_N, 0.0) << "too short";
}

TEST(HandTremor, ARestingSensorIsRefusedAsAHand) {
  IdentifyResult result{.cell = "demo", .valid_for = {}, .axes = {}};
  result.tremor = MeasureTremor(std::vector<Wrench>(10000), {}, kPeriod_s);
  JudgeTremor(result);
  ASSERT_EQ(result.refused.size(), 1u);
  EXPECT_NE(result.refused[0].what.find("nobody holds the handle"), std::string::npos);
  result.refused.clear();
  result.tremor = MeasureTremor(TremorOf(1.0, 60.0, 10.0), {}, kPeriod_s);
  JudgeTremor(result);
  EXPECT_TRUE(result.refused.empty());
  const config::IdentifiedCell written = ToIdentified(result);
  ASSERT_TRUE(written.vibration);
  EXPECT_EQ(written.vibration->tremor_N, result.tremor->tremor_N);
}

// --- the spindle's own forces ---

TEST(Notch, IsAsWideAsTheHarmonicsModulation) {
  std::mt19937_64 random(10);
  std::normal_distribution<double> white(0.0, 0.1);
  const auto width = [&](double modulation_hz, double amplitude_N) {
    std::vector<double> force_N, speed;
    double angle_rad = 0.0;
    for (int k = 0; k < 30000; ++k) {
      const double t = kPeriod_s * k, rate = 26.0 * (1.0 + 0.04 * std::sin(kTwoPi * 0.3 * t));
      speed.push_back(rate);
      force_N.push_back(amplitude_N * std::cos(kTwoPi * modulation_hz * t) * std::sin(3.0 * angle_rad) +
                        white(random));
      angle_rad += rate * kPeriod_s;
    }
    return MeasureNotchWidth(force_N, speed, kPeriod_s);
  };
  EXPECT_NEAR(width(0.0, 3.0), 0.5, 0.26) << "a line on the measured turn, a bin wide";
  EXPECT_NEAR(width(1.0, 3.0), 2.0, 0.6) << "two lines, 1 Hz on both sides of the harmonic";
  EXPECT_EQ(width(0.0, 0.0), 0.0) << "noise alone";
}

}  // namespace
}  // namespace osteon::studies
