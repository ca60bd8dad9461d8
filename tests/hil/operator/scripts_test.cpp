#include "hil/operator/scripts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "hil/operator/operator_hand.h"

// Tests the scripts for drilling a hole and for opening a site with a burr.

namespace osteon::hil {
namespace {

// Pose of a site (the place that is cut) with a general orientation.
Pose TiltedSite() {
  Pose X_WC = Pose::Identity();
  X_WC.linear() = ExpRotation({0.7, -0.4, 0.3});
  X_WC.translation() = Vector3(0.5, -0.2, 0.4);
  return X_WC;
}

DrillingScriptParams Drilling(double seconds = 10.0) {
  return {.X_WC = TiltedSite(), .tool_yaw_rad = 0.4, .seconds = seconds};
}

OpeningScriptParams Opening(double seconds = 10.0) {
  return {.X_WC = TiltedSite(), .tool_yaw_rad = 0.4, .seconds = seconds};
}

// Centre of the tool's head in the site's frame C.
Vector3 HeadInSite(const HandScript& script, const HandTarget& target) {
  return TiltedSite().inverse() * (target.X_WT * Vector3(0, 0, -script.head_radius_m()));
}
// Height of the tool's tip along the site's axis [m].
double TipHeight(const HandTarget& target) {
  return (TiltedSite().inverse() * target.X_WT.translation()).z();
}

// Tests properties of every script, with drilling and with opening.
class Scripts : public testing::TestWithParam<const char*> {
 protected:
  static HandScript Make(double seconds = 10.0) {
    if (std::string(GetParam()) == "drilling") return MakeDrillingScript(Drilling(seconds));
    return MakeOpeningScript(Opening(seconds));
  }
};
INSTANTIATE_TEST_SUITE_P(, Scripts, testing::Values("drilling", "opening"),
                         [](const auto& param) { return std::string(param.param); });

TEST_P(Scripts, BeginAboveTheSiteAndEndAboveItOnTheAxis) {
  const HandScript script = Make();
  EXPECT_NEAR(script.duration_s(), 10.0, 1e-12);
  for (const auto& [t, height_m] : {std::pair(0.0, 0.040), std::pair(10.0, 0.030), std::pair(99.0, 0.030)}) {
    const HandTarget target = script.Sample(t);
    EXPECT_LT((HeadInSite(script, target) - Vector3(0, 0, height_m)).norm(), 1e-14) << t;
    EXPECT_TRUE(target.X_WT.linear().col(2).isApprox(-TiltedSite().linear().col(2), 1e-14));
    EXPECT_LT(target.V_WT.v.norm(), 1e-12) << t;
  }
  EXPECT_EQ(script.Sample(0.0).grip, 0.0);
  EXPECT_STREQ(script.PhaseName(10.5), "done");
}

// Compares the velocity with the central difference of the pose. The error is h^2/6 of the third derivative,
// with the step h: below 1e-8 here.
TEST_P(Scripts, VelocityIsTheDerivativeOfThePose) {
  const double h = 1e-5;
  for (const double seconds : {1.0, 10.0}) {
    const HandScript script = Make(seconds);
    for (double t = 0.013 * seconds; t < seconds; t += 0.0129 * seconds) {
      const HandTarget a = script.Sample(t - h), b = script.Sample(t + h), m = script.Sample(t);
      EXPECT_LT(((b.X_WT.translation() - a.X_WT.translation()) / (2 * h) - m.V_WT.v).norm(), 1e-6) << t;
      EXPECT_LT(LogRotation(b.X_WT.linear() * a.X_WT.linear().transpose()).norm(), 1e-12) << t;
    }
  }
}

// The slope of the velocity must not jump when the phase changes. With a blend that is only C1, over the
// distance d in the time T, it would jump by 6 d / T^2, at least 0.1 m/s^2 here. With the quintic, the jerk
// (below 500 m/s^3 in the shortest peck) over the 4 h between the samples changes the slope by less than 2e-2
// m/s^2.
TEST_P(Scripts, TargetsAreTwiceContinuouslyDifferentiable) {
  const HandScript script = Make();
  const double h = 1e-5;
  double boundary = 0.0;
  const auto v = [&](double t) { return script.Sample(t).V_WT.v; };
  for (const HandPhase& phase : script.phases()) {
    if (boundary > 0.0) {
      const Vector3 left = (v(boundary - h) - v(boundary - 2 * h)) / h;
      const Vector3 right = (v(boundary + 2 * h) - v(boundary + h)) / h;
      EXPECT_LT((right - left).norm(), 2e-2) << phase.name;
    }
    boundary += phase.duration_s;
  }
}

TEST_P(Scripts, TargetsStayBelowTheirSpeedLimitForAnyDuration) {
  for (const double seconds : {0.1, 0.3, 1.0, 3.0, 10.0, 600.0}) {
    const HandScript script = Make(seconds);
    EXPECT_NEAR(script.duration_s(), seconds, 1e-9 * seconds);
    for (double u = 0.0; u <= 1.0; u += 1e-3) {
      const HandTarget target = script.Sample(u * seconds);
      const Vector3 v_C = TiltedSite().linear().transpose() * target.V_WT.v;
      ASSERT_LE(std::abs(v_C.z()), 0.2 + 1e-9) << seconds;
      // across the axis, the motion along the loop and the motion that widens the loop are perpendicular, and
      // each is below the bound
      ASSERT_LE(v_C.head<2>().norm(), std::numbers::sqrt2 * 0.2 + 1e-9) << seconds;
      ASSERT_EQ(target.V_WT.w.norm(), 0.0);
    }
  }
}

TEST_P(Scripts, RefuseADurationThatIsNotPositive) {
  EXPECT_THROW((void)Make(0.0), std::invalid_argument);
  EXPECT_THROW((void)Make(std::nan("")), std::invalid_argument);
}

TEST(DrillingScript, PecksDeeperEachTimeAndClearsTheHoleBetween) {
  DrillingScriptParams params = Drilling();
  params.pecks = 3;
  const HandScript script = MakeDrillingScript(params);
  const double beyond_m = params.push_force_N / params.hand_stiffness_N_per_m;
  double end = 0.0, deepest_m = 1.0;
  int outs = 0, pushes = 0;
  for (const HandPhase& phase : script.phases()) {
    end += phase.duration_s;
    const HandTarget target = script.Sample(end - 1e-9);
    EXPECT_LT(HeadInSite(script, target).head<2>().norm(), 1e-14);  // the head moves straight along the axis
    if (phase.name == "approach") {
      EXPECT_NEAR(TipHeight(target), 0.0, 1e-9);
    } else if (phase.name.starts_with("out")) {
      ++outs;
      EXPECT_NEAR(TipHeight(target), params.peck_height_m, 1e-9);
      EXPECT_NEAR(target.force_limit_N, params.approach_force_N, 1e-9);
    } else if (phase.name.starts_with("push") || phase.name == "breakthrough") {
      ++pushes;
      EXPECT_NEAR(target.force_limit_N, params.push_force_N, 1e-9);
      EXPECT_NEAR(TipHeight(target), -params.depth_m * pushes / 3.0 - beyond_m, 1e-9);
      EXPECT_LT(TipHeight(target), deepest_m);
      deepest_m = TipHeight(target);
    } else if (phase.name.starts_with("back")) {
      // the tip is at the depth of the previous peck, and the force is that of the approach
      EXPECT_NEAR(TipHeight(target), -params.depth_m * pushes / 3.0, 1e-9);
      EXPECT_NEAR(target.force_limit_N, params.approach_force_N, 1e-9);
    }
  }
  EXPECT_EQ(pushes, 3);
  EXPECT_EQ(outs, 2);
  EXPECT_NEAR(end, 10.0, 1e-12);
}

TEST(OpeningScript, LoopsWidenToTheCircleWhileTheyDeepen) {
  const OpeningScriptParams params = Opening();
  const HandScript script = MakeOpeningScript(params);
  const double widest_m = params.site_radius_m - params.head_radius_m;
  double radius_before = 0.0, height_before = 1.0, widest_found = 0.0;
  for (double t = 1.5; t <= 8.2; t += 1e-3) {  // from the end of the approach to the end of the last loop
    const Vector3 p_C = HeadInSite(script, script.Sample(t));
    const double radius = p_C.head<2>().norm();
    ASSERT_GE(radius, radius_before - 1e-12) << t;
    ASSERT_LE(p_C.z(), height_before + 1e-12) << t;
    ASSERT_LE(radius, widest_m + 1e-12) << t;  // the edge of the burr must never leave the circle
    radius_before = radius;
    height_before = p_C.z();
    widest_found = std::max(widest_found, radius);
  }
  EXPECT_NEAR(widest_found, widest_m, 1e-12);
  // the target is deeper than the full depth by the distance at which the hand's spring pushes with the full
  // force
  const double beyond_m = params.push_force_N / params.hand_stiffness_N_per_m;
  EXPECT_NEAR(TipHeight(script.Sample(7.5)), -params.depth_m - beyond_m, 1e-12);
  // in each period, the head must go once around
  for (double t = 7.05; t < 7.35; t += 0.1)
    EXPECT_LT((HeadInSite(script, script.Sample(t)) - HeadInSite(script, script.Sample(t + 0.8))).norm(),
              1e-12);
}

TEST(OpeningScript, RefusesALoopAboveTheTargetsMaxSpeed) {
  OpeningScriptParams params = Opening();
  params.site_radius_m =
      0.0308;  // an opening of this radius needs a motion of 30 mm in 0.8 s: 0.236 m/s, too fast
  EXPECT_THROW((void)MakeOpeningScript(params), std::invalid_argument);
  params.loop_period_s = 1.0;
  EXPECT_NO_THROW((void)MakeOpeningScript(params));
  params.site_radius_m = 0.5 * params.head_radius_m;
  EXPECT_THROW((void)MakeOpeningScript(params), std::invalid_argument);
}

TEST(HandScript, RefusesToBeginOrEndOffTheAxis) {
  const HandKey on{}, off{.swing_m = 1e-3};
  EXPECT_NO_THROW(HandScript({}, 0.01, 0.0, 1.0, on, {{"out", 1.0, off}, {"back", 1.0, on}}));
  EXPECT_THROW(HandScript({}, 0.01, 0.0, 1.0, on, {{"out", 1.0, off}}), std::invalid_argument);
  EXPECT_THROW(HandScript({}, 0.01, 0.0, 1.0, off, {{"in", 1.0, on}}), std::invalid_argument);
  EXPECT_THROW(HandScript({}, 0.01, 0.0, 1.0, on, {{"out", 1.0, off}, {"back", 1.0, on}}, 0.0),
               std::invalid_argument);
}

// A burr is held still in the middle of a widening loop. It must feel the hand's spring sideways, and the
// script's force along the axis.
TEST(OpeningScript, HandPressesSidewaysWithItsSpring) {
  const HandScript script = MakeOpeningScript(Opening());
  OperatorHand hand({.damping_Ns_per_m = 0.0, .mass_kg = 0.0}, script);
  hand.Reset();
  Pose X_WT = script.Sample(0.0).X_WT;
  X_WT.translation() = TiltedSite() * Vector3(0, 0, -0.001);
  const Wrench F = hand.Step(7.5, 1e-3, X_WT, {});
  const Vector3 f_C = TiltedSite().linear().transpose() * F.f;
  EXPECT_NEAR(f_C.head<2>().norm(), 2000.0 * 0.0008, 1e-9);
  EXPECT_NEAR(f_C.z(), -4.0, 1e-9);
}

// Physiological tremor: the force that tremor adds along a script must have all its power between 8 and 12
// Hz.
TEST(DrillingScript, TremorLiesBetween8And12Hertz) {
  const HandScript script = MakeDrillingScript(Drilling());
  const double force_N = 0.5;
  OperatorHand steady({.max_force_N = 1e6}, script),
      shaking({.max_force_N = 1e6, .tremor_N = force_N}, script);
  steady.Reset();
  shaking.Reset();
  constexpr int kSteps = 10000;
  std::vector<double>
      along;  // the force in one direction across the axis, where the force limit does not act
  const Vector3 x_W = TiltedSite().linear().col(0);
  for (int k = 0; k < kSteps; ++k) {
    const double t = 1.0 + 8e-4 * k;
    const Pose X_WT = script.Sample(t).X_WT;
    along.push_back(x_W.dot(shaking.Step(t, 8e-4, X_WT, {}).f - steady.Step(t, 8e-4, X_WT, {}).f));
  }
  double inside = 0.0, total = 0.0;
  for (int line = 0; line < 240;
       ++line) {  // spectral lines at multiples of 1/8 Hz up to 30 Hz, with a Hann window
    double re = 0.0, im = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * k / kSteps);
      const double phase = 2.0 * std::numbers::pi * line * k / kSteps;
      re += window * along[static_cast<std::size_t>(k)] * std::cos(phase);
      im += window * along[static_cast<std::size_t>(k)] * std::sin(phase);
    }
    const double power = re * re + im * im, hz = line / 8.0;
    total += power;
    if (hz >= 8.0 && hz <= 12.0) inside += power;
  }
  EXPECT_GT(total, 0.0);
  EXPECT_GT(inside, 0.999 * total);
}

}  // namespace
}  // namespace osteon::hil
