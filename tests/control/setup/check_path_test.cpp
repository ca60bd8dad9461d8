#include "control/setup/check_path.h"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinematics/lbr_arm.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::control {
namespace {

using kinematics::JointVector;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kReach_m =
    0.42 + 0.4 + 0.126;  // distance from shoulder to flange of an iiwa 14 with its arm stretched out
const kinematics::ChainParams<7> kChain = kinematics::ChainFrom(kinematics::Iiwa14());

// Joints of the arm stretched out horizontally, 0.36 m above the foot of its base. A1 moves the flange on a
// circle.
JointVector StraightOut(double a1_rad, double a2_rad = kPi / 2.0) {
  JointVector q = JointVector::Zero();
  q[0] = a1_rad;
  q[1] = a2_rad;
  return q;
}

// Surroundings without obstacles. Only a ball of 10 mm radius at the flange is checked.
PathSurroundings FlangeAlone() {
  PathSurroundings around;
  around.balls = {{.name = "the flange", .radius_m = 0.01}};
  return around;
}

TEST(CheckPath, FindsTheNearestApproachOfAnArcToASphere) {
  PathSurroundings around = FlangeAlone();
  around.X_WB.translation() = Vector3(1.0, 2.0, 3.0);
  around.spheres = {{.center_W_m = {1.0 + kReach_m + 0.08, 2.0, 3.36}, .radius_m = 0.03}};
  const auto found = CheckPath<7>(kChain, StraightOut(-1.5), StraightOut(1.5), around);
  ASSERT_TRUE(found) << found.error();
  EXPECT_NEAR(found->min_distance_m, 0.08 - 0.03 - 0.01, around.resolution_m);
  EXPECT_NEAR(found->share, 0.5, 0.02);
  EXPECT_EQ(found->between, "the flange, the bone");
}

TEST(CheckPath, SaysWhereAnArcMeetsASphere) {
  PathSurroundings around = FlangeAlone();
  around.spheres = {{.center_W_m = {kReach_m, 0.0, 0.36}, .radius_m = 0.05}};
  const auto found = CheckPath<7>(kChain, StraightOut(-1.0), StraightOut(1.0), around);
  ASSERT_FALSE(found);
  // sphere, ball and clearance add up to 0.05 + 0.01 + 0.01 m. The flange is that near to the sphere's centre
  // at A1 = -2 asin(0.07 / 2 / 0.946) = -0.074, thus at 46 % of the path
  EXPECT_THAT(found.error(), HasSubstr("at 46 % of the path: found the flange "));
  EXPECT_THAT(found.error(), HasSubstr(" mm clear of the bone, accepted 10.0 mm clear of it"));
}

TEST(CheckPath, RefusesAPathBeneathAPlane) {
  PathSurroundings around = FlangeAlone();
  around.planes = {{.name = "the table", .normal_W = Vector3::UnitZ(), .offset_m = 0.1}};
  // the flange ends at the height 0.36 + 0.946 cos(1.9) = 0.054, so the lower end of its ball is beneath the
  // plane at 0.1
  auto found = CheckPath<7>(kChain, StraightOut(0.0), StraightOut(0.0, 1.9), around);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error(), HasSubstr("at 100 % of the path: found the flange 55.8 mm beneath the table"));
  // A4 moves the flange from a height of -0.013 first 0.9 mm down, then up to 0.88. The path is allowed above
  // a plane at -0.2. With a plane at 0.5 it begins beneath the plane, and then it must not go down
  JointVector from = StraightOut(0.0, 1.2), goal = StraightOut(0.0, 1.2);
  from[3] = -2.0;
  goal[3] = 2.0;
  around.planes[0].offset_m = -0.2;
  found = CheckPath<7>(kChain, from, goal, around);
  ASSERT_TRUE(found) << found.error();
  around.planes[0].offset_m = 0.5;
  EXPECT_FALSE(CheckPath<7>(kChain, from, goal, around));
}

TEST(CheckPath, AnArmThatBeginsBeneathAPlaneMayOnlyRise) {
  PathSurroundings around = FlangeAlone();
  around.planes = {{.name = "the table", .normal_W = Vector3::UnitZ(), .offset_m = 0.0}};
  EXPECT_TRUE(CheckPath<7>(kChain, StraightOut(0.0, 2.0), StraightOut(0.0, 1.0), around));
  // the flange's height is 0.36 + 0.42 cos(A2) + 0.526 cos(A2 - A4): -0.034 at the beginning, 0.017 at the
  // end, and lower in between
  JointVector goal = StraightOut(0.0, 1.2);
  goal[3] = -1.6;
  const auto found = CheckPath<7>(kChain, StraightOut(0.0, 2.0), goal, around);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error(),
              HasSubstr("beneath the table, accepted 43.7 mm beneath, and less from there on"));
}

TEST(CheckPath, RefusesAPathThatBeginsOrEndsInTheBone) {
  PathSurroundings around = FlangeAlone();
  around.spheres = {{.center_W_m = {0.0, -kReach_m, 0.36}, .radius_m = 0.02}};
  auto found = CheckPath<7>(kChain, StraightOut(-kPi / 2.0), StraightOut(0.0), around);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error(), HasSubstr("at 0 % of the path: found the flange 30.0 mm inside the bone"));
  EXPECT_THAT(found.error(), HasSubstr("by hand"));
  found = CheckPath<7>(kChain, StraightOut(0.0), StraightOut(-kPi / 2.0), around);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error(), HasSubstr("at 100 % of the path"));
}

TEST(CheckPath, RefusesEndsBeyondTheLimits) {
  JointVector goal = StraightOut(0.0);
  goal[3] = 119.5 * kPi / 180.0;
  auto found = CheckPath<7>(kChain, StraightOut(0.0), goal, FlangeAlone());
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error(), "the end of the path: found A4 at 119.50 deg, accepted -119.00 … 119.00");
  EXPECT_TRUE(CheckPath<7>(kChain, goal, StraightOut(0.0), FlangeAlone())) << "it may begin in the margin";
  goal[3] = std::nan("");
  EXPECT_FALSE(CheckPath<7>(kChain, goal, StraightOut(0.0), FlangeAlone()));
}

// Oracle: the rule for the distance, evaluated at 3001 samples of the path (a few tenths of a millimetre
// apart) with the closed-form arm. An accepted path may break a bound by the resolution at most; a refused
// path must break one. The rule: the distance must stay above the clearance. If the distance at the beginning
// or at the goal is smaller than the clearance, it must stay above the best distance so far, or above the
// distance at the goal.
TEST(CheckPath, AgreesWithDenseSampling) {
  const kinematics::LbrArm arm(kinematics::Iiwa14());
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int accepted = 0, refused = 0;
  for (int trial = 0; trial < 150; ++trial) {
    PathSurroundings around;
    const Vector3 tip_F(0.05 * unit(random), 0.0, 0.15);
    around.balls = {{.name = "the tip", .center_m = tip_F, .radius_m = 0.01}};
    around.spheres = {{.center_W_m = {0.6 + 0.2 * unit(random), 0.4 * unit(random), 0.3}, .radius_m = 0.1},
                      {.center_W_m = {0.6, 0.4 * unit(random), 0.2}, .radius_m = 0.05}};
    around.planes = {{.name = "the table", .offset_m = 0.1 + 0.2 * unit(random)}};
    JointVector from, goal;
    from << unit(random), 0.8 + 0.4 * unit(random), 0.5 * unit(random), -1.4 + 0.4 * unit(random),
        unit(random), 0.6 * unit(random), unit(random);
    goal << unit(random), 0.8 + 0.4 * unit(random), 0.5 * unit(random), -1.4 + 0.4 * unit(random),
        unit(random), 0.6 * unit(random), unit(random);
    // two distances of the ball at the share s of the path [m]: from the nearest sphere, and above the plane
    const auto distance = [&](double s) {
      const Vector3 p = arm.FlangePose(from + s * (goal - from)) * tip_F;
      double bone_m = 10.0;
      for (const KeepOutSphere& sphere : around.spheres)
        bone_m = std::min(bone_m, (p - sphere.center_W_m).norm() - sphere.radius_m);
      return Eigen::Vector2d(bone_m - 0.01, p.z() - around.planes[0].offset_m - 0.01);
    };
    const Eigen::Vector2d at_goal = distance(1.0), at_start = distance(0.0);
    double worst_m = std::min({at_goal.minCoeff(), at_start[0], 0.0}), nearest_m = 10.0;
    Eigen::Vector2d best = at_start;
    for (int k = 0; k <= 3000; ++k) {
      const Eigen::Vector2d d = distance(k / 3000.0);
      best = best.cwiseMax(d);
      nearest_m = std::min(nearest_m, d.minCoeff());
      const Eigen::Vector2d floor =
          best.cwiseMin(at_goal).cwiseMin(Eigen::Vector2d::Constant(around.clearance_m));
      worst_m = std::min(worst_m, (d - floor).minCoeff());
    }
    const auto found = CheckPath<7>(kChain, from, goal, around);
    if (found) {
      ++accepted;
      EXPECT_GE(worst_m, -around.resolution_m) << "trial " << trial;
      EXPECT_GE(found->min_distance_m, nearest_m - 1e-6);
    } else {
      ++refused;
      EXPECT_LT(worst_m, 0.0) << "trial " << trial << ": " << found.error();
    }
  }
  EXPECT_GT(accepted, 30);
  EXPECT_GT(refused, 30);
}

TEST(CheckPath, ABallOnALinkMovesWithThatLink) {
  PathSurroundings around;
  around.balls = {{.name = "the elbow", .link = 3, .radius_m = 0.08}};
  around.planes = {{.name = "the table", .offset_m = 0.0}};
  // the elbow of the arm stretched out horizontally, at the shoulder's height
  const auto found = CheckPath<7>(kChain, StraightOut(0.0), StraightOut(1.0), around);
  ASSERT_TRUE(found) << found.error();
  EXPECT_NEAR(found->min_distance_m, 0.36 - 0.08, 1e-9);
}

TEST(CheckPath, RefusesSurroundingsOutOfRange) {
  const auto check = [](const PathSurroundings& around) {
    return CheckPath<7>(kChain, StraightOut(0.0), StraightOut(0.1), around);
  };
  PathSurroundings around = FlangeAlone();
  EXPECT_TRUE(check(around)) << "nothing to meet";
  around.resolution_m = 0.0;
  EXPECT_THROW(static_cast<void>(check(around)), std::invalid_argument);
  around = FlangeAlone();
  around.balls[0].link = 7;
  EXPECT_THROW(static_cast<void>(check(around)), std::invalid_argument);
  around = FlangeAlone();
  around.planes = {{.name = "the table", .normal_W = {0, 0, 2}}};
  EXPECT_THROW(static_cast<void>(check(around)), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
