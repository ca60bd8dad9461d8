#include "safety/workspace.h"

#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::safety {
namespace {

constexpr double kDt_s = 0.001;
const WorkspaceParams kParams{.sphere_center_W_m = {0.5, 0.0, 0.5},
                              .sphere_radius_m = 0.3,
                              .plane_normal_W = {0.0, 0.0, 1.0},
                              .plane_offset_m = 0.4,
                              .deceleration_m_per_s2 = 2.0};

TEST(Workspace, TheDistanceIsThatToTheNearerBound) {
  const Workspace workspace(kParams);
  EXPECT_NEAR(workspace.Distance({0.5, 0.0, 0.5}), 0.1, 1e-15) << "the plane is nearer";
  EXPECT_NEAR(workspace.Distance({0.75, 0.0, 0.5}), 0.05, 1e-15) << "the sphere is nearer";
  EXPECT_FALSE(workspace.Violated({0.5, 0.0, 0.4}));
  EXPECT_TRUE(workspace.Violated({0.5, 0.0, 0.399}));
  EXPECT_TRUE(workspace.Violated({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.5}));
}

TEST(Workspace, AToolThatIsPushedOutwardsStaysInsideAndBrakesAtTheGivenDeceleration) {
  const Workspace workspace(kParams);
  for (const Vector3& direction : {Vector3(0, 0, -1), Vector3(1, 0, 0), Vector3(0.6, 0.64, -0.48)}) {
    Vector3 p = kParams.sphere_center_W_m, v = Vector3::Zero();
    double speed_before = 0.0;
    for (int i = 0; i < 5000; ++i) {
      v = workspace.Limit(p, 0.25 * direction, kDt_s).v_WT;
      p += kDt_s * v;
      ASSERT_GE(workspace.Distance(p), -1e-12);
      if (i > 0) {
        ASSERT_LE(speed_before - v.norm(), 2.0 * kDt_s * 1.001) << "no harder than the stop's deceleration";
      }
      speed_before = v.norm();
    }
    EXPECT_LT(workspace.Distance(p), 1e-3) << "and reaches the bound";
  }
}

TEST(Workspace, TheToolSlidesAlongABound) {
  const Workspace workspace(kParams);
  const Workspace::Result result = workspace.Limit({0.5, 0.0, 0.4}, {0.1, 0.0, -0.1}, kDt_s);
  EXPECT_TRUE(result.acted);
  EXPECT_NEAR(result.v_WT.x(), 0.1, 1e-12);
  EXPECT_EQ(result.v_WT.z(), 0.0);
  EXPECT_FALSE(workspace.Limit({0.5, 0.0, 0.4}, {0.1, 0.0, 0.1}, kDt_s).acted) << "inwards is free";
}

// A random walk with random requests, including the edge between the sphere and the plane.
TEST(Workspace, NoSequenceOfRequestedVelocitiesLeavesIt) {
  const Workspace workspace(kParams);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  Vector3 p = kParams.sphere_center_W_m;
  Vector3 requested_v = Vector3::Zero();
  for (int i = 0; i < 200'000; ++i) {
    if (i % 500 == 0) requested_v = Vector3(normal(random), normal(random), normal(random) - 0.5);
    p += kDt_s * workspace.Limit(p, requested_v, kDt_s).v_WT;
    ASSERT_GE(workspace.Distance(p), -1e-12) << "step " << i;
  }
}

TEST(Workspace, RefusesParametersOutOfRangeAndStopsAtARequestThatIsNotFinite) {
  EXPECT_THROW(Workspace({.sphere_radius_m = 0.0}), std::invalid_argument);
  EXPECT_THROW(Workspace({.plane_normal_W = {0.0, 0.0, 2.0}}), std::invalid_argument);
  EXPECT_THROW(Workspace({.deceleration_m_per_s2 = -1.0}), std::invalid_argument);
  EXPECT_TRUE(Workspace(kParams)
                  .Limit({0.5, 0, 0.5}, {std::numeric_limits<double>::infinity(), 0, 0}, kDt_s)
                  .v_WT.isZero(0.0));
}

TEST(Workspace, DoesNotAllocate) {
  const Workspace workspace(kParams);
  rt::CheckedNoAllocScope no_alloc;
  const Workspace::Result result = workspace.Limit({0.5, 0.0, 0.401}, {0.1, 0.0, -0.1}, kDt_s);
  no_alloc.End();
  EXPECT_TRUE(result.acted);
}

}  // namespace
}  // namespace osteon::safety
