#include "control/guidance/guidance_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "control/laws/twist_parts.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/guidance/guidance_parts.h"

// Tests the guidance field: springs that push the tool back into the corridor of a surgical plan. The
// corridor consists of a funnel, a cone and a depth.

namespace osteon::control {
namespace {

constexpr double kDeg = 0.017453292519943295;  // [rad]

TEST(GuidanceField, IsZeroInsideTheCorridor) {
  const GuidanceParams params = SomeGuidance();
  const GuidanceField field = EvaluateGuidance(params, PoseAt(params, {.height_m = 5e-3}), {});
  EXPECT_TRUE(field.inside);
  EXPECT_FALSE(field.beyond_stop);
  EXPECT_EQ(field.potential_J, 0.0);
  EXPECT_EQ(field.F_T_W.f, Vector3(0, 0, 0));
  EXPECT_EQ(field.F_T_W.t, Vector3(0, 0, 0));
}

// The tool is 1 mm too deep, 4 mm off the axis and tilted by 12°. The cone allows 8°, the funnel 1 mm and its
// widening.
TEST(GuidanceField, MeasuresHowFarTheToolIsOutsideTheCorridor) {
  const GuidanceParams params = SomeGuidance();
  const GuidanceField field = EvaluateGuidance(
      params, PoseAt(params, {.height_m = -1e-3, .aside_m = 4e-3, .tilt_rad = 12 * kDeg}), {});
  EXPECT_NEAR(field.excess.cone_rad, 4 * kDeg, 1e-12);
  EXPECT_NEAR(field.excess.depth_m, 1e-3, 1e-15);
  const double psi = params.widening_rad;
  EXPECT_NEAR(field.excess.lateral_m, (3e-3 + 1e-3 * std::tan(psi)) * std::cos(psi), 1e-15);
  EXPECT_TRUE(field.beyond_stop);
}

TEST(GuidanceField, SpringsEaseInRiseLinearlyAndKeepTheirCap) {
  const GuidanceSpring spring{.stiffness = 5e3, .ease = 0.5e-3, .cap = 40.0};
  EXPECT_EQ(SpringForce(spring, -1.0), 0.0);
  EXPECT_DOUBLE_EQ(SpringForce(spring, 0.25e-3), 0.5 * 5e3 * 0.25e-3 * 0.25e-3 / 0.5e-3);
  EXPECT_DOUBLE_EQ(SpringForce(spring, 2e-3), 5e3 * 1.75e-3);
  EXPECT_DOUBLE_EQ(SpringForce(spring, 1.0), 40.0);
  // the potential is the integral of the force; Simpson's rule is exact for each of the three pieces of the
  // force's curve
  double integral = 0.0;
  const double step = 1e-6;
  for (int i = 0; i < 12000; ++i) {
    const double e = i * step;
    integral +=
        step / 6.0 *
        (SpringForce(spring, e) + 4.0 * SpringForce(spring, e + 0.5 * step) + SpringForce(spring, e + step));
    if (i % 1000 == 999) {
      EXPECT_NEAR(SpringPotential(spring, e + step), integral, 1e-9);
    }
  }
}

// The wrench at rest must be minus the gradient of the potential, for translations and for rotations about
// To. It is compared with a difference quotient along random motions.
TEST(GuidanceField, WrenchIsMinusThePotentialsGradient) {
  const GuidanceParams params = SomeGuidance();
  std::mt19937 random(39);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&] { return Vector3(unit(random), unit(random), unit(random)); };
  int outside = 0;
  for (int i = 0; i < 1000; ++i) {
    Pose X_WT = PoseAt(
        params,
        {.height_m = 6e-3 * unit(random), .aside_m = 8e-3 * unit(random), .tilt_rad = 0.4 * unit(random)});
    X_WT.linear() = X_WT.linear() * ExpRotation(Vector3(0, 0, 3.0 * unit(random)));
    const GuidanceField field = EvaluateGuidance(params, X_WT, {});
    if (field.inside) continue;
    ++outside;
    const Twist along{.v = vector(), .w = 20.0 * vector()};
    const double h = 1e-8;
    const auto potential = [&](double by) {
      Pose X = X_WT;
      X.translation() += by * along.v;
      X.linear() = ExpRotation(by * along.w) * X.linear();
      return EvaluateGuidance(params, X, {}).potential_J;
    };
    const double slope = (potential(h) - potential(-h)) / (2.0 * h);
    EXPECT_NEAR(Power(field.F_T_W, along), -slope, 1e-5 * (1.0 + std::abs(slope))) << "case " << i;
  }
  EXPECT_GT(outside, 500);
}

// The tool is 3 mm too deep. At rest the full spring force acts. A motion deeper adds damping. A motion back
// reduces the force, to zero at 50 mm/s.
TEST(GuidanceField, ResistsMotionOutwardAndFadesWithTheSpeedOfReturn) {
  const GuidanceParams params = SomeGuidance();
  const Pose X_WT = PoseAt(params, {.height_m = -3e-3});
  const Vector3 a = params.axis_W;
  const auto depth_N = [&](double deeper_m_per_s) {
    return EvaluateGuidance(params, X_WT, {.v = -deeper_m_per_s * a}).F_T_W.f.dot(a);
  };
  const double rest_N = 10e3 * 2.75e-3;
  EXPECT_NEAR(depth_N(0.0), rest_N, 1e-9);
  EXPECT_NEAR(depth_N(0.02), rest_N + 2.0, 1e-9);
  EXPECT_NEAR(depth_N(0.25), 1.25 * rest_N, 1e-9) << "the damping is at most a quarter";
  EXPECT_NEAR(depth_N(-0.025), 0.5 * rest_N, 1e-9);
  EXPECT_EQ(depth_N(-0.06), 0.0) << "never pulls";
}

TEST(GuidanceField, IsFiniteForAReversedTool) {
  const GuidanceParams params = SomeGuidance();
  const GuidanceField field =
      EvaluateGuidance(params, PoseAt(params, {.tilt_rad = 3.141592653589793}), {.w = {1.0, 2.0, 3.0}});
  EXPECT_TRUE(field.F_T_W.f.allFinite());
  EXPECT_TRUE(field.F_T_W.t.allFinite());
  EXPECT_TRUE(field.beyond_stop);
}

TEST(GuidanceField, RefusesParametersOutOfRange) {
  const auto refused = [](auto change) {
    GuidanceParams params = SomeGuidance();
    EXPECT_NO_THROW(Validate(params));
    change(params);
    EXPECT_THROW(Validate(params), std::invalid_argument);
  };
  refused([](GuidanceParams& p) { p.lateral.stiffness = 5001.0; });
  refused([](GuidanceParams& p) { p.lateral.cap = 61.0; });
  refused([](GuidanceParams& p) { p.cone.stiffness = 401.0; });
  refused([](GuidanceParams& p) { p.cone.cap = 8.1; });
  refused([](GuidanceParams& p) { p.depth.stiffness = 20001.0; });
  refused([](GuidanceParams& p) { p.depth.cap = 151.0; });
  refused([](GuidanceParams& p) {
    p.depth.cap = 1.0;
  });  // below the force at the end of the ease, so that the force would have a kink
  refused([](GuidanceParams& p) { p.axis_W *= 1.1; });
  refused([](GuidanceParams& p) { p.gain = 1.1; });
  refused([](GuidanceParams& p) { p.cone_stop_rad = 0.5 * p.cone_free_rad; });
  refused([](GuidanceParams& p) { p.lateral_stop_m = 0.5 * p.lateral_free_m; });
}

}  // namespace
}  // namespace osteon::control
