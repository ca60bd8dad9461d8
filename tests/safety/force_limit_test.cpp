// Two bounds on a coupling at its force limit: on the energy that the coupling can give back, and on the
// tool's motion into bone.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "safety/force_limit_reaction.h"
#include "safety/stored_energy_limit.h"

namespace osteon::safety {
namespace {

constexpr double kStiffness_N_per_m = 20e3;

// The force [N] of a one-dimensional spring at the displacement d_m, scaled by the stored-energy limit.
double Force(StoredEnergyLimit& limit, double d_m) {
  return limit.Step(d_m, 0.5 * kStiffness_N_per_m * d_m * d_m) * kStiffness_N_per_m * d_m;
}

// Presses the spring to a depth in steps of 1 um and releases it; the bound is 0.25 J.
TEST(StoredEnergyLimit, GivesBackNoMoreThanItsBoundFromAnyDepth) {
  for (const double depth_m : {0.002, 0.005, 0.02, 0.1}) {
    StoredEnergyLimit limit(0.25);
    double put_in_J = 0.0, given_back_J = 0.0, peak_N = 0.0;
    const double step_m = 1e-6;
    const int steps = static_cast<int>(depth_m / step_m);
    double before_N = 0.0;
    for (int i = 1; i <= steps; ++i) {
      const double force_N = Force(limit, i * step_m);
      put_in_J += 0.5 * (before_N + force_N) * step_m;
      peak_N = std::max(peak_N, force_N);
      before_N = force_N;
    }
    for (int i = steps - 1; i >= 0; --i) {
      const double force_N = Force(limit, i * step_m);
      given_back_J += 0.5 * (before_N + force_N) * step_m;
      before_N = force_N;
    }
    EXPECT_LE(given_back_J, 0.25 * (1.0 + 1e-6)) << depth_m;
    EXPECT_LE(peak_N, std::sqrt(2.0 * 0.25 * kStiffness_N_per_m) * (1.0 + 1e-9)) << depth_m;
    if (depth_m >= 0.005) {
      EXPECT_NEAR(given_back_J, 0.25, 1e-3) << "and all of the bound";
    }
    EXPECT_GE(put_in_J, given_back_J - 1e-9);
  }
}

TEST(StoredEnergyLimit, GeneratesNoEnergyOnARandomPath) {
  std::mt19937 random(7);
  std::normal_distribution<double> step(0.0, 2e-5);
  StoredEnergyLimit limit(0.1);
  double d_m = 0.0, before_N = 0.0, given_J = 0.0, most_J = 0.0;
  for (int i = 0; i < 200'000; ++i) {
    const double next_m = std::max(0.0, d_m + step(random));
    const double force_N = Force(limit, next_m);
    given_J -= 0.5 * (before_N + force_N) * (next_m - d_m);
    most_J = std::max(most_J, given_J);
    d_m = next_m;
    before_N = force_N;
  }
  EXPECT_LE(most_J, 1e-6) << "what comes out was put in before";
}

TEST(StoredEnergyLimit, DoesNotScaleWithoutABoundNorOutOfBone) {
  StoredEnergyLimit limit(std::numeric_limits<double>::infinity());
  EXPECT_EQ(limit.Step(0.1, 1000.0), 1.0);
  StoredEnergyLimit tight(0.01);
  EXPECT_EQ(tight.Step(0.0, 0.0), 1.0);
  EXPECT_LT(tight.Step(0.01, 1.0), 1.0);
  EXPECT_EQ(tight.Step(0.0, 0.0), 1.0) << "out of bone nothing has slipped";
}

// The input for a tool at a depth in bone: `share` of the coupling's force is rendered, and the cut face
// advances at advance_m_per_s.
ForceLimitInput At(double depth_m, double share, double advance_m_per_s = 0.0) {
  return {.displacement_W = Vector3(0.0, 0.0, depth_m),
          .rendered_scale = share,
          .advance_m_per_s = advance_m_per_s};
}

TEST(ForceLimitReaction, KeepsTheToolWithinItsZoneBeyondTheForceLimit) {
  // into bone along -z; the force limit is reached at 4 mm
  ForceLimitReaction reaction({.slow_zone_m = 0.5e-3}, 3.0, 1e-3);
  double depth_m = 0.0;
  Vector3 v = Vector3::Zero();
  for (int i = 0; i < 3000; ++i) {
    reaction.Step(At(depth_m, depth_m > 0.004 ? 0.004 / depth_m : 1.0));
    Vector3 wanted(0.02, 0.0, -0.05);  // x: along the face; -z: into bone
    const bool limited = reaction.Limit(v, wanted);
    EXPECT_EQ(limited, wanted.z() != -0.05);
    EXPECT_EQ(wanted.x(), 0.02) << "nothing is taken along the face";
    v = wanted;
    depth_m += -v.z() * 1e-3;
  }
  EXPECT_GT(depth_m, 0.004);
  EXPECT_LT(depth_m, 0.00451);
}

TEST(ForceLimitReaction, LetsTheToolAdvanceAsFastAsTheMaterialGivesWay) {
  ForceLimitReaction reaction({.advance_factor = 1.1}, 3.0, 1e-3);
  reaction.Step(At(0.006, 0.5, 2e-3));
  Vector3 v(0.0, 0.0, -0.05);
  EXPECT_TRUE(reaction.Limit(Vector3::Zero(), v));
  EXPECT_NEAR(v.z(), -0.9 * 2e-3, 1e-12) << "far beyond its zone it falls back";
  reaction.Step(At(0.0045, 0.004 / 0.0045, 2e-3));
  v = Vector3(0.0, 0.0, -0.05);
  EXPECT_TRUE(reaction.Limit(Vector3::Zero(), v));
  EXPECT_NEAR(v.z(), -2e-3, 1e-9) << "at its zone's end";
  Vector3 out(0.0, 0.0, 0.05);
  EXPECT_FALSE(reaction.Limit(Vector3::Zero(), out)) << "out of bone the tool is free";
  Vector3 fast(0.0, 0.0, -0.2);
  EXPECT_TRUE(reaction.Limit(Vector3(0.0, 0.0, -0.2), fast));
  EXPECT_NEAR(fast.z(), -(0.2 - 3.0e-3), 1e-12) << "no harder than a stop";
}

TEST(ForceLimitReaction, OnlySlowLimitsTheMotionAndOnlyStopAsksForAStop) {
  for (const OnForceLimit kind : {OnForceLimit::kYield, OnForceLimit::kSlow, OnForceLimit::kStop}) {
    ForceLimitReaction reaction({.reaction = kind, .stop_after_s = 0.05, .max_tool_in_bone_m = 0.01}, 3.0,
                                1e-3);
    bool stopped = false;
    for (int i = 1; i <= 60; ++i) {
      reaction.Step(At(0.006, 0.5));
      if (!stopped && reaction.must_stop()) {
        stopped = true;
        EXPECT_EQ(i, 50);
      }
    }
    EXPECT_EQ(stopped, kind == OnForceLimit::kStop);
    Vector3 v(0.0, 0.0, -0.05);
    EXPECT_EQ(reaction.Limit(Vector3::Zero(), v), kind == OnForceLimit::kSlow);
    EXPECT_FALSE(reaction.too_deep());
    reaction.Step(At(0.0101, 1.0));
    EXPECT_TRUE(reaction.too_deep()) << "whatever the reaction, at the limit or not";
    EXPECT_FALSE(reaction.saturated());
    reaction.Step(At(0.006, 0.5));
    EXPECT_FALSE(reaction.must_stop()) << "its time begins anew";
  }
}

TEST(ForceLimitReaction, RefusesValuesOutOfRange) {
  EXPECT_THROW(ForceLimitReaction({.advance_factor = 0.9}, 3.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(ForceLimitReaction({.slow_zone_m = 0.0}, 3.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(ForceLimitReaction({.stop_after_s = std::nan("")}, 3.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(ForceLimitReaction({.max_tool_in_bone_m = 0.0}, 3.0, 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::safety
