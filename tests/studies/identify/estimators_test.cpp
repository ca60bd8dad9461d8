#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "control/excitation/excitation_path.h"
#include "hil/arm/servo_arm.h"
#include "studies/identify/force_fit.h"
#include "studies/identify/force_noise.h"
#include "studies/identify/identify_table.h"
#include "studies/identify/measured_response.h"
#include "studies/identify/servo_fit.h"

// Tests of the measured response and of the fits, on simulated arms whose true parameters are known. Seeds
// are fixed.

namespace osteon::studies {
namespace {

using Complex = std::complex<double>;
constexpr double kTwoPi = 2.0 * std::numbers::pi, kPeriod_s = 1e-3;

// Limits that never restrict the motion.
std::array<kinematics::JointLimits, 7> FastLimits() {
  std::array<kinematics::JointLimits, 7> limits{};
  for (kinematics::JointLimits& limit : limits) limit.velocity_rad_per_s = 1e3;
  return limits;
}

// The true parameters of an arm.
struct Truth {
  double hz{15.0}, damping{1.0};
  double dead_cycles{4.0};
  [[nodiscard]] double lag_s() const { return kPeriod_s * dead_cycles + 2.0 * damping / (kTwoPi * hz); }
};

// Simulates an excited run of the arm, with seed 1.
ExcitedRun Excite(const Truth& truth, const SyntheticRun& run) {
  return Synthesize(
      run, {.bandwidth_hz = truth.hz, .damping_ratio = truth.damping, .dead_cycles = truth.dead_cycles},
      kPeriod_s, 1);
}

// The servo model fitted to the response from command to encoders.
ServoFit FitOf(const ExcitedRun& run) {
  const auto response = MeasureResponse(run, Signal::kCommand, Signal::kPosition);
  EXPECT_TRUE(response) << (response ? "" : response.error());
  const auto fit = FitServo(response->lines, run.period_s);
  EXPECT_TRUE(fit) << (fit ? "" : fit.error());
  return *fit;
}

// --- the sampled response ---

TEST(SampledResponse, EqualsTheSimulatedArmsSteadyOscillation) {
  for (const Truth& truth : {Truth{}, Truth{.hz = 8.0, .damping = 0.7, .dead_cycles = 9},
                             Truth{.hz = 25.0, .damping = 1.6, .dead_cycles = 0}})
    for (const double hz : {0.75, 9.3, 47.0}) {
      hil::ServoArm arm(
          {.bandwidth_hz = truth.hz, .damping_ratio = truth.damping, .dead_cycles = truth.dead_cycles},
          FastLimits(), kPeriod_s, kinematics::JointVector::Zero());
      const ServoModel model{.bandwidth_hz = truth.hz,
                             .damping_ratio = truth.damping,
                             .dead_time_s = kPeriod_s * truth.dead_cycles};
      const Complex H = SampledResponse(model, kPeriod_s, hz);
      kinematics::JointVector command = kinematics::JointVector::Zero();
      for (int k = 0; k < 4000; ++k) {
        const Complex u = std::polar(1.0, kTwoPi * hz * kPeriod_s * k);
        if (k > 3900) {  // long after the start
          EXPECT_NEAR(arm.q()[0], (H * u).real(), 2e-11);
          EXPECT_NEAR(arm.q()[1], (H * u).imag(), 2e-11);
        }
        command[0] = u.real();
        command[1] = u.imag();
        arm.Step(command);
      }
    }
}

// Dead times of a part of a period. Oracle: an arm that steps four times in a period, with its command held
// meanwhile.
TEST(SampledResponse, WithAFractionalDeadTimeEqualsAFinerArms) {
  constexpr double kFine_s = kPeriod_s / 4.0, kHz = 13.0;
  for (const double quarters : {0.0, 1.0, 14.0, 19.0}) {
    hil::ServoArm arm({.bandwidth_hz = 15.0, .damping_ratio = 0.8, .dead_cycles = quarters}, FastLimits(),
                      kFine_s, kinematics::JointVector::Zero());
    const Complex H = SampledResponse(
        {.bandwidth_hz = 15.0, .damping_ratio = 0.8, .dead_time_s = kFine_s * quarters}, kPeriod_s, kHz);
    kinematics::JointVector command = kinematics::JointVector::Zero();
    for (int k = 0; k < 12000; ++k) {
      if (k % 4 == 0) {
        const Complex u = std::polar(1.0, kTwoPi * kHz * kFine_s * k);
        if (k > 11900) {
          EXPECT_NEAR(std::abs(Complex(arm.q()[0], arm.q()[1]) - H * u), 0.0, 2e-11);
        }
        command[0] = u.real();
        command[1] = u.imag();
      }
      arm.Step(command);
    }
  }
}

// --- the servo model's fit; the tolerances are those of the table in docs/identify.md ---

TEST(ServoFit, FindsTheArmFrom64sWithEncoderNoise) {
  const Truth truth;
  const ServoFit fit = FitOf(Excite(truth, {}));
  EXPECT_NEAR(fit.bandwidth_hz.value, 15.0, 0.005 * 15.0);
  EXPECT_NEAR(fit.damping_ratio.value, 1.0, 0.005);
  EXPECT_NEAR(fit.lag_s.value, truth.lag_s(), 0.02e-3);
  EXPECT_NEAR(fit.dead_time_s.value, 4e-3, 0.06e-3);
  EXPECT_LT(fit.chi2, 1.5);
  EXPECT_LT(fit.lag_s.half_width, 0.02e-3);
}

TEST(ServoFit, WithoutNoiseIsExact) {
  for (const Truth& truth : {Truth{}, Truth{.hz = 8.0, .damping = 0.7, .dead_cycles = 9},
                             Truth{.hz = 25.0, .damping = 0.6, .dead_cycles = 3}}) {
    const ServoFit fit = FitOf(Excite(truth, {.draws = 2, .periods = 2, .noise_m = 0.0}));
    EXPECT_NEAR(fit.bandwidth_hz.value, truth.hz, 1e-5 * truth.hz);
    EXPECT_NEAR(fit.damping_ratio.value, truth.damping, 1e-5);
    EXPECT_NEAR(fit.dead_time_s.value, kPeriod_s * truth.dead_cycles, 1e-8);
    EXPECT_LT(fit.residual, 1e-8);
  }
}

TEST(ServoFit, LostMessagesDoNotMatter) {
  const Truth truth;
  const ServoFit fit = FitOf(Excite(truth, {.lost = 0.01}));
  EXPECT_NEAR(fit.bandwidth_hz.value, 15.0, 0.005 * 15.0);
  EXPECT_NEAR(fit.lag_s.value, truth.lag_s(), 0.02e-3);
}

TEST(ServoFit, CountsTheCommandsThatTheArmReceived) {
  const Truth truth;
  const SyntheticRun lossy{.draws = 2, .lost_answers = 0.05};
  EXPECT_NEAR(FitOf(Excite(truth, lossy)).lag_s.value, truth.lag_s(), 0.02e-3);
  SyntheticRun as_sent = lossy;
  as_sent.as_sent = true;
  EXPECT_GT(FitOf(Excite(truth, as_sent)).lag_s.value, truth.lag_s() + 0.03e-3)
      << "each loss holds the command";
}

// --- deliberate errors in the data: each must change the result ---

TEST(PlantedErrors, ADriftDoesNoHarmButSubtractingALineDoes) {
  const Truth truth;
  ExcitedRun run = Excite(truth, {.draws = 2, .noise_m = 1e-7, .drift_m_per_s = 20e-6});
  const ServoFit fit = FitOf(run);
  EXPECT_NEAR(fit.bandwidth_hz.value, 15.0, 0.075);
  // the error: subtracting a fitted straight line from each period's samples takes power from the lowest
  // lines
  for (std::size_t i = 0; i + 4000 <= run.samples.size();) {
    if (!run.samples[i].counted) {
      ++i;
      continue;
    }
    double over = 0.0, under = 0.0, mean = 0.0;
    for (std::size_t k = 0; k < 4000; ++k) mean += run.samples[i + k].y_m / 4000.0;
    for (std::size_t k = 0; k < 4000; ++k) {
      const double t = static_cast<double>(k) - 1999.5;
      over += t * (run.samples[i + k].y_m - mean);
      under += t * t;
    }
    for (std::size_t k = 0; k < 4000; ++k)
      run.samples[i + k].y_m -= over / under * (static_cast<double>(k) - 1999.5);
    i += 4000;
  }
  const ServoFit wrong = FitOf(run);
  EXPECT_GT(std::abs(wrong.bandwidth_hz.value - 15.0) + 15.0 * std::abs(wrong.damping_ratio.value - 1.0),
            0.15);
}

TEST(PlantedErrors, AShiftOfOneTickAddsAMillisecondOfDeadTime) {
  ExcitedRun run = Excite(Truth{}, {.draws = 2, .periods = 2, .noise_m = 0.0});
  for (std::size_t i = run.samples.size() - 1; i > 0; --i) run.samples[i].y_m = run.samples[i - 1].y_m;
  EXPECT_NEAR(FitOf(run).dead_time_s.value, 5e-3, 1e-6);
}

TEST(PlantedErrors, ClosingGapsInsteadOfKeepingThemWidensTheInterval) {
  ExcitedRun run = Excite(Truth{}, {.draws = 2, .noise_m = 0.0, .lost = 0.001});
  const ServoFit right = FitOf(run);
  // the error: missing samples are removed, and the later ones move up
  ExcitedRun closed{.period_s = kPeriod_s, .samples = {}};
  std::vector<ExcitedSample> seen;
  for (const ExcitedSample& sample : run.samples)
    if (sample.seen) seen.push_back(sample);
  for (std::size_t i = 0; i < run.samples.size(); ++i) {
    ExcitedSample sample = run.samples[i];
    const ExcitedSample& moved = seen[std::min(i, seen.size() - 1)];
    sample.u_m = moved.u_m;
    sample.y_m = moved.y_m;
    sample.seen = true;
    closed.samples.push_back(sample);
  }
  EXPECT_LT(right.lag_s.half_width, 1e-6);
  EXPECT_GT(FitOf(closed).lag_s.half_width, 20.0 * right.lag_s.half_width);
}

TEST(PlantedErrors, AForceOfTheWrongSignIsNotFittedAsAMass) {
  std::vector<ResponseLine> lines;
  for (const int harmonic : control::Multisine::Harmonics()) {
    const double w = kTwoPi * control::Multisine::Frequency(harmonic);
    lines.push_back(
        {.hz = w / kTwoPi, .value = -1.2 * w * w * std::polar(1.0, -w * 1.7e-3), .noise_sd = 5.0, .sd = 5.0});
  }
  EXPECT_FALSE(FitToolForce(lines));
  for (ResponseLine& line : lines) line.value = -line.value;
  EXPECT_TRUE(FitToolForce(lines));
}

// --- coverage of the 95 % intervals ---

TEST(ServoFit, IntervalsContainTheTruthIn90To99PercentOfTheSeeds) {
  constexpr int kSeeds = 200;
  const ServoModel truth{.bandwidth_hz = 15.0, .damping_ratio = 1.0, .dead_time_s = 4e-3, .gain = 1.0};
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::array<int, 4> inside{};
  double chi2 = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    std::vector<ResponseLine> lines;
    for (const int harmonic : control::Multisine::Harmonics()) {
      const double hz = control::Multisine::Frequency(harmonic), sd = 5e-5 * std::max(1.0, hz / 5.0);
      lines.push_back(
          {.hz = hz,
           .value = SampledResponse(truth, kPeriod_s, hz) + sd * Complex(noise(random), noise(random)),
           .noise_sd = sd,
           .sd = sd});
    }
    const auto fit = FitServo(lines, kPeriod_s);
    ASSERT_TRUE(fit) << fit.error();
    const auto holds = [](const Estimate& estimate, double value) {
      return std::abs(estimate.value - value) <= estimate.half_width;
    };
    inside[0] += holds(fit->bandwidth_hz, 15.0);
    inside[1] += holds(fit->damping_ratio, 1.0);
    inside[2] += holds(fit->dead_time_s, 4e-3);
    inside[3] += holds(fit->lag_s, truth.lag_s());
    chi2 += fit->chi2 / kSeeds;
  }
  for (const int count : inside) {
    EXPECT_GE(count, 90 * kSeeds / 100);
    EXPECT_LE(count, 99 * kSeeds / 100);
  }
  EXPECT_NEAR(chi2, 1.0, 0.1);
}

// --- too little data, and nonlinear responses ---

TEST(MeasuredResponse, RefusesOneDrawAndOnePeriod) {
  const auto one_draw = MeasureResponse(Excite(Truth{}, {.draws = 1}), Signal::kCommand, Signal::kPosition);
  ASSERT_FALSE(one_draw);
  EXPECT_NE(one_draw.error().find("too little: found 12 s in 1 draws"), std::string::npos)
      << one_draw.error();
  EXPECT_FALSE(
      MeasureResponse(Excite(Truth{}, {.draws = 3, .periods = 1}), Signal::kCommand, Signal::kPosition));
}

TEST(MeasuredResponse, ACubicDistortionRaisesTheOddLinesMost) {
  ExcitedRun run = Excite(Truth{}, {.draws = 2, .periods = 2, .noise_m = 0.0});
  const auto linear = MeasureResponse(run, Signal::kCommand, Signal::kPosition);
  EXPECT_LT(linear->odd_ratio, 1e-6);
  for (ExcitedSample& sample : run.samples) sample.y_m += 4e4 * std::pow(sample.y_m, 3);
  const auto cubic = MeasureResponse(run, Signal::kCommand, Signal::kPosition);
  EXPECT_GT(cubic->odd_ratio, 0.01);
  EXPECT_GT(cubic->odd_ratio, 3.0 * cubic->even_ratio);
}

// --- the force of the tool and of the hand ---

// Response from position to sensor force of a tool mass behind a delay, with a resonance at hz_r unless that
// is 0.
std::vector<ResponseLine> ForceLines(double mass_kg, double delay_s, double hz_r, double damping, double sd) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, sd);
  std::vector<ResponseLine> lines;
  for (const int harmonic : control::Multisine::Harmonics()) {
    const double hz = control::Multisine::Frequency(harmonic), w = kTwoPi * hz, w_r = kTwoPi * hz_r;
    Complex value = mass_kg * w * w * std::polar(1.0, -w * delay_s);
    if (hz_r > 0.0) value *= w_r * w_r / Complex(w_r * w_r - w * w, 2.0 * damping * w_r * w);
    lines.push_back(
        {.hz = hz, .value = value + Complex(noise(random), noise(random)), .noise_sd = sd, .sd = sd});
  }
  return lines;
}

TEST(ToolForce, FindsMassAndDelay) {
  const auto fit = FitToolForce(ForceLines(1.2, 1.7e-3, 0.0, 0.0, 40.0));
  ASSERT_TRUE(fit) << fit.error();
  EXPECT_NEAR(fit->mass_kg.value, 1.2, 0.005 * 1.2);
  EXPECT_NEAR(fit->delay_s.value, 1.7e-3, 0.05e-3);
  EXPECT_FALSE(fit->resonance);
}

TEST(ToolForce, FindsAResonanceFrom20To45Hz) {
  for (const double hz : {20.0, 22.0, 35.0, 45.0}) {
    const auto fit = FitToolForce(ForceLines(1.2, 1.7e-3, hz, 0.03, 40.0));
    ASSERT_TRUE(fit) << fit.error();
    ASSERT_TRUE(fit->resonance) << hz;
    EXPECT_NEAR(fit->resonance->hz.value, hz, 0.01 * hz);
    EXPECT_NEAR(fit->mass_kg.value, 1.2, 0.02 * 1.2);
    EXPECT_NEAR(fit->delay_s.value, 1.7e-3, 0.1e-3);
  }
}

TEST(Hand, IsSeparatedFromTheToolsInertia) {
  std::vector<ResponseLine> lines;
  for (const int harmonic : control::Multisine::Harmonics()) {
    const double hz = control::Multisine::Frequency(harmonic), w = kTwoPi * hz;
    const Complex hand = -Complex(3000.0 - w * w * 1.5, 20.0 * w);
    lines.push_back({.hz = hz,
                     .value = (1.2 * w * w + hand) * std::polar(1.0, -w * 0.5e-3),
                     .noise_sd = 20.0,
                     .sd = 20.0});
  }
  const auto fit = FitHand(lines, 1.2);
  ASSERT_TRUE(fit) << fit.error();
  EXPECT_NEAR(fit->stiffness_N_per_m.value, 3000.0, 30.0);
  EXPECT_NEAR(fit->damping_Ns_per_m.value, 20.0, 0.5);
  EXPECT_NEAR(fit->mass_kg.value, 1.5, 0.02);
  EXPECT_NEAR(fit->delay_s.value, 0.5e-3, 0.05e-3);
}

TEST(ForceNoise, SeparatesWhiteNoiseLinesAndDrift) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> white(0.0, 0.08), step(0.0, 0.02);
  std::vector<double> force_N;
  double drift_N = 0.0;
  for (int k = 0; k < 60000; ++k) {
    if (k % 1000 == 0) drift_N += step(random);
    force_N.push_back(drift_N + white(random) + 0.05 * std::sin(kTwoPi * 50.0 * kPeriod_s * k));
  }
  const ForceNoise noise = MeasureNoise(force_N, kPeriod_s);
  EXPECT_NEAR(noise.white_N, 0.08, 0.004);
  ASSERT_FALSE(noise.lines.empty());
  for (const NoiseLine& line : noise.lines) EXPECT_EQ(line.hz, 50.0);
  EXPECT_NEAR(noise.lines[0].amplitude, 0.05, 0.003);
  EXPECT_GT(noise.drift_N, 0.02);
  EXPECT_DOUBLE_EQ(noise.dead_zone_N(), 3.0 * noise.drift_N);
}

TEST(SpindleHarmonics, AreFoundAtAVaryingSpeed) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> white(0.0, 0.1);
  std::vector<double> force_N, speed, nominal;
  double angle_rad = 0.0;
  const auto speed_at = [](int k) { return 26.0 * (1.0 + 0.04 * std::sin(kTwoPi * 0.3 * kPeriod_s * k)); };
  for (int k = 0; k < 20000; ++k) {
    speed.push_back(speed_at(k));
    nominal.push_back(26.0);
    force_N.push_back(5.0 + 3.0 * std::sin(3.0 * angle_rad) + 0.8 * std::cos(6.0 * angle_rad) +
                      white(random));
    angle_rad += 0.5 * (speed_at(k) + speed_at(k + 1)) * kPeriod_s;
  }
  const auto harmonics = FitSpindleHarmonics(force_N, speed, kPeriod_s);
  ASSERT_EQ(harmonics.size(), 8u);
  EXPECT_NEAR(harmonics[2].amplitude_N, 3.0, 0.02);
  EXPECT_NEAR(harmonics[5].amplitude_N, 0.8, 0.02);
  EXPECT_NEAR(harmonics[3].amplitude_N, 0.0, 0.02);
  EXPECT_LT(FitSpindleHarmonics(force_N, nominal, kPeriod_s)[2].amplitude_N, 2.8)
      << "a nominal speed blurs them";
}

}  // namespace
}  // namespace osteon::studies
