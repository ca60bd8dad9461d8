#include "control/laws/gain_ramp.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

// Tests the ramp that moves the acting gains to the requested gains without creating energy.

namespace osteon::control {
namespace {

constexpr double kDt_s = 0.001;

// The default gains.
Gains Own() { return GainsOf({}, {}); }

TEST(GainRamp, ReachesEveryTargetAtABoundedRateAndThenRests) {
  GainRamp ramp(Own(), kDt_s);
  EXPECT_FALSE(ramp.Step(false));
  Gains target = Own();
  target.mass_kg = Vector3(1.0, 6.0, 3.0);
  target.damping_Nms_per_rad.y = 4.0;
  target.dead_zone_N = 2.0;
  target.max_stiffness_N_per_m = 5e3;
  ramp.SetTarget(target);
  double last = Own().mass_kg.x;
  int ticks = 0;
  while (ramp.Step(true)) {
    EXPECT_NEAR(last - ramp.now().mass_kg.x, 2.0 * kDt_s, 1e-12) << "in a second";
    last = ramp.now().mass_kg.x;
    ASSERT_LE(++ticks, 1001);
  }
  EXPECT_GE(ticks, 999);
  EXPECT_EQ(Vector3(ramp.now().mass_kg), Vector3(1.0, 6.0, 3.0));
  EXPECT_EQ(ramp.now().damping_Nms_per_rad.y, 4.0);
  EXPECT_EQ(ramp.now().dead_zone_N, 2.0);
  EXPECT_EQ(ramp.now().max_stiffness_N_per_m, 5e3) << "softer also while pressed";
}

TEST(GainRamp, StiffnessRisesOnlyWhileNothingPresses) {
  GainRamp ramp(Own(), kDt_s);
  Gains softer = Own(), stiffer = Own();
  softer.max_stiffness_N_per_m = 1e3;
  ramp.SetTarget(softer);
  for (int i = 0; i < 1100; ++i) ramp.Step(true);
  ASSERT_EQ(ramp.now().max_stiffness_N_per_m, 1e3);
  stiffer.mass_kg.x = 5.0;
  ramp.SetTarget(stiffer);
  for (int i = 0; i < 2000; ++i) ramp.Step(true);
  EXPECT_EQ(ramp.now().max_stiffness_N_per_m, 1e3);
  EXPECT_EQ(ramp.now().mass_kg.x, 5.0) << "the others go on";
  for (int i = 0; i < 1100; ++i) ramp.Step(false);
  EXPECT_EQ(ramp.now().max_stiffness_N_per_m, 20e3) << "made up for later";
}

// A hand moves at random into and out of a wall (x > 0), while stiffnesses are requested at random times. The
// work of the wall's spring is computed exactly for each tick. The hand must never get more energy out of the
// wall than it put in.
TEST(GainRamp, StiffnessNeverMakesEnergy) {
  for (int seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    GainRamp ramp(Own(), kDt_s);
    double x = -0.001, v = 0.0, out_J = 0.0, moved_J = 0.0;
    bool pressed = false;
    int rises_pressed = 0;
    for (int i = 0; i < 50'000; ++i) {
      if (unit(random) < 0.002) {
        Gains target = Own();
        target.max_stiffness_N_per_m = 500.0 + 19'500.0 * unit(random);
        ramp.SetTarget(target);
      }
      const double before = ramp.now().max_stiffness_N_per_m;
      ramp.Step(pressed);
      const double k = ramp.now().max_stiffness_N_per_m;
      if (pressed && k > before) ++rises_pressed;
      v = 0.995 * v + 0.002 * normal(random) - 0.05 * kDt_s * x / 0.001;
      const double x_next = x + kDt_s * v;
      const double d = std::max(0.0, x), d_next = std::max(0.0, x_next);
      const double work = 0.5 * k * (d * d - d_next * d_next);
      out_J += work;
      moved_J += std::abs(work);
      ASSERT_LE(out_J, 1e-12) << "seed " << seed << " tick " << i;
      x = x_next;
      pressed = d_next > 0.0;
    }
    EXPECT_EQ(rises_pressed, 0);
    EXPECT_GT(moved_J, 1e-3) << "it was pressed";
  }
}

// A body moves without a force while its mass and inertia change at random. Its kinetic energy must not rise.
TEST(GainRamp, AChangeOfMassNeverRaisesKineticEnergy) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0.1, 1.0);
  AdmittanceParams law;
  law.centre_T_m = {0.0, 0.1, -0.2};
  CouplingParams coupling;
  GainRamp ramp(GainsOf(law, coupling), kDt_s);
  const Matrix3 R = ExpRotation({0.3, 0.2, -0.6});
  Twist V{.v = {0.2, -0.1, 0.15}, .w = {0.5, 0.3, -0.8}};
  const auto energy = [&] {
    Eigen::Matrix<double, 6, 1> V_T;
    V_T << R.transpose() * V.v, R.transpose() * V.w;
    return 0.5 * V_T.dot(MassMatrix(law) * V_T);
  };
  double last = energy();
  for (int i = 0; i < 20'000; ++i) {
    if (i % 377 == 0) {
      Gains target = ramp.now();
      for (double* value : {&target.mass_kg.x, &target.mass_kg.y, &target.mass_kg.z, &target.inertia_kg_m2.x,
                            &target.inertia_kg_m2.y, &target.inertia_kg_m2.z})
        *value = 10.0 * unit(random);
      ramp.SetTarget(target);
    }
    ramp.Step(false);
    const AdmittanceParams before = law;
    ApplyGains(ramp.now(), law, coupling);
    V = AfterMassChange(before, law, R, V);
    ASSERT_LE(energy(), last * (1.0 + 1e-12)) << i;
    last = energy();
  }
}

TEST(GainRamp, VisitGainsVisitsEveryGainOnce) {
  Gains gains;
  std::size_t count = 0;
  VisitGains(gains, [&](const char*, const char*, const char*, double& value) {
    EXPECT_EQ(value, 0.0);
    value = static_cast<double>(++count);
  });
  EXPECT_EQ(count, kGainCount);
  EXPECT_EQ(sizeof(Gains), kGainCount * sizeof(double)) << "none is left out";
}

TEST(GainRamp, DoesNotAllocate) {
  GainRamp ramp(Own(), kDt_s);
  Gains target = Own();
  target.mass_kg.x = 1.0;
  rt::CheckedNoAllocScope no_alloc;
  ramp.SetTarget(target);
  ramp.Step(false);
}

}  // namespace
}  // namespace osteon::control
