#include "simulation/tools/motion_player.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "tests/simulation/engine/engine_bench.h"

namespace osteon::simulation {
namespace {

constexpr double kTau = 2.0 * std::numbers::pi;

// A hand at time t in s: a slow path with a turn, and a tremor of 0.2 mm at 11 Hz.
MotionSample Trembling(double t) {
  const Vector3 r(0.3 * std::sin(kTau * 0.4 * t), 0.2 * t, 0.01 * std::sin(kTau * 9.0 * t));
  return {.time_s = t,
          .p_GT_m = Vector3(0.02 * std::sin(kTau * 0.3 * t), 2e-4 * std::sin(kTau * 11.0 * t), -0.01 * t),
          .R_GT = Eigen::Quaterniond(ExpRotation(r)),
          .spindle_rad_per_s = t < 0.5 ? 0.0 : 26.0};
}

std::vector<MotionSample> TremblingSamples(double step_s, double seconds) {
  std::vector<MotionSample> samples;
  for (int k = 0; k <= static_cast<int>(std::lround(seconds / step_s)); ++k)
    samples.push_back(Trembling(k * step_s));
  return samples;
}

// Largest distance in m of a curve through samples every step_s from the exact motion, away from the ends:
// there the natural spline is of second order only.
double CurveError(double step_s) {
  const MotionCurve curve(TremblingSamples(step_s, 2.0));
  double worst_m = 0.0;
  for (double t = 0.2; t < 1.8; t += 1.3e-4)
    worst_m = std::max(worst_m, (curve.X_GT(t).translation() - Trembling(t).p_GT_m).norm());
  return worst_m;
}

TEST(MotionCurve, GoesThroughItsSamples) {
  const auto samples = TremblingSamples(0.01, 1.0);
  const MotionCurve curve(samples);
  for (const MotionSample& s : samples) {
    EXPECT_LT((curve.X_GT(s.time_s).translation() - s.p_GT_m).norm(), 1e-15);
    EXPECT_LT(s.R_GT.angularDistance(Eigen::Quaterniond(curve.X_GT(s.time_s).linear())), 1e-7);
  }
  EXPECT_EQ(curve.X_GT(-1.0).translation(), samples.front().p_GT_m);
  EXPECT_LT((curve.X_GT(99.0).translation() - samples.back().p_GT_m).norm(), 1e-15);
}

// Half the step must give a sixteenth of the error.
TEST(MotionCurve, ErrorShrinksWithTheFourthPowerOfTheStep) {
  const double coarse_m = CurveError(0.01), fine_m = CurveError(0.005);
  EXPECT_LT(coarse_m, 5e-6);
  EXPECT_GT(coarse_m / fine_m, 12.0);
  EXPECT_LT(coarse_m / fine_m, 22.0);
}

TEST(MotionCurve, IgnoresTheSignOfQuaternions) {
  auto samples = TremblingSamples(0.01, 1.0);
  const MotionCurve plain(samples);
  for (std::size_t i = 0; i < samples.size(); i += 3) samples[i].R_GT.coeffs() *= -1.0;
  const MotionCurve flipped(samples);
  for (double t = 0.0; t < 1.0; t += 0.0037)
    EXPECT_LT((plain.X_GT(t).matrix() - flipped.X_GT(t).matrix()).norm(), 1e-13);
}

TEST(MotionCurve, IsTwiceContinuouslyDifferentiable) {
  // the most uneven knots that a spline must handle: steps of 1 ms beside steps of 50 ms
  const std::vector<MotionSample> samples{Trembling(0.0), Trembling(0.05), Trembling(0.051), Trembling(0.052),
                                          Trembling(0.1)};
  const MotionCurve curve(samples);
  const double h = 1e-5;
  for (const double t : {0.05, 0.051, 0.052}) {
    const auto acceleration = [&](double at) {
      return Vector3((curve.X_GT(at + h).translation() - 2.0 * curve.X_GT(at).translation() +
                      curve.X_GT(at - h).translation()) /
                     (h * h));
    };
    // The acceleration changes over 4 h only by the cubic's third derivative. A kink in the velocity would
    // change it by at least 1e-3 / h.
    EXPECT_LT((acceleration(t + 2 * h) - acceleration(t - 2 * h)).norm(), 0.5) << t;
  }
}

TEST(FitMotion, StaysWithinItsToleranceOfEveryRecordedSample) {
  const auto recorded = TremblingSamples(1e-3, 3.0);
  const FittedMotion fitted = FitMotion(recorded, {.tolerance_m = 2e-6, .tolerance_rad = 2e-5});
  const MotionCurve curve(fitted.samples);
  double worst_m = 0.0, worst_rad = 0.0;
  for (const MotionSample& s : recorded) {
    worst_m = std::max(worst_m, (curve.X_GT(s.time_s).translation() - s.p_GT_m).norm());
    worst_rad =
        std::max(worst_rad, s.R_GT.angularDistance(Eigen::Quaterniond(curve.X_GT(s.time_s).linear())));
    EXPECT_NEAR(curve.SpindleAt(s.time_s), s.spindle_rad_per_s, 1e-4);  // the stored rpm is rounded
  }
  EXPECT_LE(worst_m, 2e-6);
  EXPECT_LE(worst_rad, 2e-5);
  EXPECT_NEAR(fitted.position_error_m, worst_m, 1e-12);
  EXPECT_NEAR(fitted.rotation_error_rad, worst_rad, 1e-8);
  EXPECT_LT(fitted.samples.size(), 400u);  // the recording has 3001
}

// The tool stops abruptly at 0.5 s: samples must be dense there, and only there.
TEST(FitMotion, KeepsDenseSamplesAroundAnImpact) {
  std::vector<MotionSample> recorded;
  for (int k = 0; k <= 1000; ++k)
    recorded.push_back({.time_s = 1e-3 * k, .p_GT_m = Vector3(0, 0, k < 500 ? -1e-4 * k : -0.05)});
  const FittedMotion fitted = FitMotion(recorded);
  EXPECT_LE(fitted.position_error_m, 2e-6);
  std::size_t near = 0;
  for (const MotionSample& s : fitted.samples) near += std::abs(s.time_s - 0.5) < 0.02 ? 1 : 0;
  EXPECT_GT(near, 5u);
  EXPECT_LT(fitted.samples.size(), 80u);
}

TEST(MotionPlayer, PlaysTheSameCurveAtAnyRate) {
  ToolMotion motion;
  motion.samples = TremblingSamples(0.01, 1.0);
  Pose X_WG = Pose::Identity();
  X_WG.linear() = ExpRotation({0.1, 0.2, 0.3});
  X_WG.translation() = Vector3(0.6, 0.0, 0.2);
  const MotionCurve curve(motion.samples);
  for (const double rate_hz : {90.0, 500.0, 1000.0}) {
    const MotionPlayer player(motion, rate_hz, X_WG);
    ASSERT_EQ(player.frame_count(), static_cast<std::size_t>(rate_hz) + 1) << rate_hz;
    for (std::size_t k = 0; k < player.frame_count(); k += 7) {
      const FrameInput frame = player.Frame(k);
      const double t = static_cast<double>(k) / rate_hz;
      EXPECT_LT((Pose(frame.X_WT).matrix() - (X_WG * curve.X_GT(t)).matrix()).norm(), 1e-14);
      EXPECT_EQ(frame.dt_s, 1.0 / rate_hz);
      EXPECT_NEAR(static_cast<double>(frame.stamp), t * 1e9, 0.5);
      EXPECT_EQ(frame.spindle_rad_per_s, t < 0.5 - 1e-9 ? 0.0 : 26.0) << t;
    }
  }
  EXPECT_THROW(MotionPlayer(motion, 0.0), std::invalid_argument);
  EXPECT_THROW(MotionPlayer(motion, std::nan("")), std::invalid_argument);
}

class PlayedMotion : public Engine {};
OSTEON_ON_EVERY_ENGINE(PlayedMotion);

// A ball moves 1 mm into a slab and 3 mm across it. Played at 250 and at 1000 frames a second, the proxy must
// follow and the cuts must be equal.
TEST_P(PlayedMotion, CutsTheSameAtEveryFrameRate) {
  ToolMotion motion;
  const auto at = [&](double t, const Vector3& apex, double spindle_rad_per_s) {
    motion.samples.push_back({.time_s = t,
                              .p_GT_m = apex,
                              .R_GT = Eigen::Quaterniond(Down(apex).linear()),
                              .spindle_rad_per_s = spindle_rad_per_s});
  };
  for (int k = 0; k <= 10; ++k) at(0.02 * k, {0, 0, 1e-3 - 2e-4 * k}, 3000.0);
  for (int k = 1; k <= 10; ++k) at(0.2 + 0.02 * k, {3e-4 * k, 0, -1e-3}, 3000.0);
  double removed_mm3[2];
  for (const int i : {0, 1}) {
    auto engine = Make(Slab(0.016, 0.005, true, kSoft), BallTool(0.004), {.law = RemovalLaw::kImmediate});
    const MotionPlayer player(motion, i == 0 ? 250.0 : 1000.0);
    ContactModel last;
    for (std::size_t k = 0; k < player.frame_count(); ++k) {
      last = engine->Step(player.Frame(k));
      ASSERT_EQ(last.status, EngineStatus::kOk);
    }
    removed_mm3[i] = 1e9 * last.removed_volume_m3;
    // the proxy ends at the motion's end, except for one frame's overlap and the rest of the slide
    EXPECT_LT((Pose(last.X_WP).translation() - Vector3(3e-3, 0, -1e-3)).norm(), 0.25e-3);
  }
  // swept volume: a cap of 1 mm depth, and the segment's area times 3 mm; a mass point is 0.125 mm³
  const double R = 4.0, h = 1.0,
               area = R * R * std::acos(1.0 - h / R) - (R - h) * std::sqrt(2 * R * h - h * h);
  const double swept_mm3 = std::numbers::pi * h * h * (R - h / 3.0) + 3.0 * area;
  EXPECT_NEAR(removed_mm3[0], swept_mm3, 0.06 * swept_mm3);
  EXPECT_NEAR(removed_mm3[1], removed_mm3[0], 0.06 * swept_mm3);
}

}  // namespace
}  // namespace osteon::simulation
