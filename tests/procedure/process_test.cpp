#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "procedure/assessment/process_figures.h"
#include "procedure/assessment/tremor.h"
#include "tests/procedure/reamed_cup.h"

namespace osteon::procedure {
namespace {

constexpr double kPi = std::numbers::pi, kPeriod_s = 1e-3;

// The meter's reading [N] for a sine of this amplitude and frequency along x, beside a constant 40 N along z.
double TremorOf(double amplitude_N, double hz, double spindle_hz, double seconds = 10.0) {
  TremorMeter meter(kPeriod_s);
  for (int i = 0; i < static_cast<int>(seconds / kPeriod_s); ++i)
    meter.Add(Vector3(amplitude_N * std::sin(2.0 * kPi * hz * i * kPeriod_s), 0.0, 40.0),
              2.0 * kPi * spindle_hz);
  return meter.value_N();
}

TEST(Tremor, ASineOfOneNewtonReadsAsItsRootMeanSquare) {
  EXPECT_NEAR(TremorOf(1.0, 10.0, 0.0), 0.707, 0.002);
  EXPECT_NEAR(TremorOf(1.0, 9.73, 0.0), 0.707, 0.005) << "between two lines";
  EXPECT_NEAR(TremorOf(2.0, 7.0, 0.0), 1.414, 0.02);
}

TEST(Tremor, SlowGuidingFastChatterAndTheSpindleAreNoTremor) {
  EXPECT_LT(TremorOf(10.0, 1.0, 0.0), 0.01);
  EXPECT_LT(TremorOf(10.0, 30.0, 0.0), 0.01);
  EXPECT_LT(TremorOf(10.0, 8.34, 4.17), 0.3) << "the second harmonic of 250 rpm";
  EXPECT_NEAR(TremorOf(1.0, 10.4, 4.17), 0.707, 0.05) << "between the harmonics";
}

TEST(Tremor, AShortSessionHasNoTremor) { EXPECT_EQ(TremorOf(1.0, 10.0, 0.0, 1.0), 0.0); }

// A tool that cuts at the planned centre while the hand presses 50 N along the feed.
ProcessSample Cutting(double t_s) {
  return {.t_s = t_s,
          .head_m = {0.0, 0.0, -0.002},
          .cut_head_m = {0.0, 0.0, -0.002},
          .cut_feed = -Vector3::UnitZ(),
          .F_hand_N = {0.0, 0.0, -50.0},
          .cutting = true};
}

TEST(ProcessFigures, AForceAt20DegreesGoesTheWrongWayByItsSine) {
  const SurgicalPlan plan = DemoPlan();
  ProcessSums sums(plan, kPeriod_s);
  for (int i = 0; i <= 1000; ++i) {
    ProcessSample sample = Cutting(i * kPeriod_s);
    sample.F_hand_N = 50.0 * Vector3(std::sin(20.0 * kPi / 180.0), 0.0, -std::cos(20.0 * kPi / 180.0));
    sums.Add(sample, plan.tools.back());
  }
  const ProcessFigures figures = sums.Figures();
  EXPECT_NEAR(figures.wrong_way, 0.342, 5e-4);
  EXPECT_NEAR(figures.force_mean_N, 50.0, 1e-9);
  EXPECT_NEAR(figures.force_peak_N, 50.0, 1e-9);
  EXPECT_NEAR(figures.time_s, 1.0, 1e-9);
  EXPECT_NEAR(figures.cutting_s, 1.001, 1e-9);
}

TEST(ProcessFigures, PathAroundACircleIsItsCircumference) {
  const SurgicalPlan plan = DemoPlan();
  ProcessSums sums(plan, kPeriod_s);
  constexpr double kRadius_m = 5e-3;
  for (int i = 0; i <= 2000; ++i) {
    ProcessSample sample = Cutting(i * kPeriod_s);
    const double angle = 2.0 * kPi * i / 2000;
    sample.head_m = plan.centre_m + kRadius_m * Vector3(std::cos(angle), std::sin(angle), 0.0);
    sums.Add(sample, plan.tools.back());
  }
  EXPECT_NEAR(sums.Figures().path_m, 2.0 * kPi * kRadius_m, 1e-6);
}

TEST(ProcessFigures, PathFarFromTheCupDoesNotCount) {
  const SurgicalPlan plan = DemoPlan();
  ProcessSums sums(plan, kPeriod_s);
  for (int i = 0; i <= 100; ++i) {
    ProcessSample sample = Cutting(i * kPeriod_s);
    sample.head_m.z() = 0.04 + 1e-3 * i;
    sums.Add(sample, plan.tools.back());
  }
  EXPECT_EQ(sums.Figures().path_m, 0.0);
}

TEST(ProcessFigures, OutsideTheCorridorIsTiltedOrAsideOrTooDeep) {
  const SurgicalPlan plan = DemoPlan();
  const PlannedTool& last = plan.tools.back();
  const Vector3 centre_m = plan.CentreOf(last);
  const auto tilted = [](double deg) {
    return Vector3(std::sin(deg * kPi / 180.0), 0.0, -std::cos(deg * kPi / 180.0));
  };
  const auto outside = [&](const Vector3& off_mm, const Vector3& feed) {
    return ExcessOf(plan, last, centre_m + 1e-3 * off_mm, feed).outside();
  };
  EXPECT_FALSE(outside({0.0, 0.0, 0.1}, tilted(7.9)));
  EXPECT_TRUE(outside({0.0, 0.0, 0.1}, tilted(8.1)));
  EXPECT_FALSE(outside({0.99, 0.0, 0.01}, tilted(0.0)));
  EXPECT_TRUE(outside({1.01, 0.0, 0.01}, tilted(0.0)));
  EXPECT_FALSE(outside({1.0 + 10.0 * std::tan(10.0 * kPi / 180.0) - 0.01, 0.0, 10.0}, tilted(0.0)))
      << "the corridor widens outwards";
  EXPECT_TRUE(outside({0.0, 0.0, -0.1}, tilted(0.0)));

  ProcessSums sums(plan, kPeriod_s);
  for (int i = 0; i < 100; ++i) {
    ProcessSample sample = Cutting(i * kPeriod_s);
    sample.head_m = centre_m - Vector3(0.0, 0.0, 2e-3);  // commanded: deeper than the head that cuts
    sample.cut_head_m = centre_m - Vector3(0.0, 0.0, i < 50 ? 1e-3 : -1e-3);
    sample.cutting = i % 2 == 0;
    sums.Add(sample, last);
  }
  EXPECT_NEAR(sums.Figures().outside_s, 25.0 * kPeriod_s, 1e-9);

  SurgicalPlan unguided = plan;
  unguided.guidance = {};
  ProcessSums none(unguided, kPeriod_s);
  for (int i = 0; i < 100; ++i) none.Add(Cutting(i * kPeriod_s), last);
  EXPECT_EQ(none.Figures().outside_s, 0.0) << "a plan without guidance has no corridor";
}

// The energy falls by 0.3 J, and later by 0.1 J: the sum is 0.4 J. The sum ignores rises, in which the
// guidance gives energy back.
TEST(ProcessFigures, GuidanceEnergyIsTheSumOfAllFalls) {
  const SurgicalPlan plan = DemoPlan();
  ProcessSums sums(plan, kPeriod_s);
  double t_s = 0.0;
  const auto add = [&](std::optional<double> E_J) {
    ProcessSample sample = Cutting(t_s += kPeriod_s);
    sample.guidance_E_J = E_J;
    sums.Add(sample, plan.tools.back());
  };
  for (const double E_J : {0.0, -0.1, -0.3, -0.2, -0.1}) add(E_J);
  add(std::nullopt);  // the guidance is off for a while, then begins again
  for (const double E_J : {-0.5, -0.6}) add(E_J);
  EXPECT_NEAR(sums.Figures().guidance_J, 0.4, 1e-12);
}

// At a lateral deviation of free_m the excess is 0. At stop_m the excess is the plan's stop less its free
// range.
TEST(CorridorWidth, LateralExcessIsZeroAtFreeWidthAndFullAtStopWidth) {
  SurgicalPlan plan;
  plan.axis_G = Vector3::UnitZ();
  plan.tools = {{.diameter_m = 0.044, .height_m = 2e-3, .around_m = 0.5e-3}};
  plan.guidance.lateral.free_m = 1e-3;
  plan.guidance.lateral.stop_m = 3e-3;
  plan.guidance.lateral.widening_rad = 0.2;
  for (const double height_m : {0.0, 2e-3, 20e-3}) {
    const Vector3 head_m(0.0, 0.0, height_m);
    const CorridorWidth width = WidthAt(plan, plan.tools[0], head_m);
    const auto excess_m = [&](double aside_m) {
      return ExcessOf(plan, plan.tools[0], head_m + Vector3(aside_m, 0.0, 0.0), -Vector3::UnitZ()).lateral_m;
    };
    EXPECT_NEAR(excess_m(width.free_m), 0.0, 1e-15) << height_m;
    EXPECT_NEAR(excess_m(width.stop_m), 2e-3, 1e-15) << height_m;
  }
}

}  // namespace
}  // namespace osteon::procedure
