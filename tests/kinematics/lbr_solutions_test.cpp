#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include "kinematics/lbr_arm.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/iiwa14.h"
#include "tests/kinematics/near_singular.h"

// All eight postures of a pose and an arm angle, compared with the forward kinematics, which lbr_arm_test.cpp
// compares with KDL.

namespace osteon::kinematics {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kConfigurations = LbrSolutions::kConfigurations;

double PoseError(const Pose& a, const Pose& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

double LeastSingularValue(const LbrArm& arm, const JointVector& q) {
  return Eigen::JacobiSVD<Jacobian>(arm.JacobianAt(q, Vector3::Zero())).singularValues()[5];
}

const LbrSolution& SolutionOf(const LbrSolutions& solutions, int configuration) {
  return solutions.configuration[static_cast<std::size_t>(configuration)];
}

// A million poses. Tolerance of the pose: 1e-13 m and rad, some hundred roundings of numbers around 1, the
// same near a singularity. Rounding of the pose moves the joints by up to 1/sigma_min times as much; 1e-9 /
// sigma_min allows for the arm angle's reference, the vertical, which is ill defined if the wrist is nearly
// above the shoulder.
TEST(LbrSolutions, AllEightReachThePoseAndIncludeThePostureThatMadeIt) {
  const LbrArm arm(Iiwa14());
  LbrPostures postures(arm.params(), 20240611);
  double worst_pose = 0.0, worst_joint = 0.0;
  int wrong_validity = 0, unreachable = 0;
  for (int n = 0; n < 1'000'000; ++n) {
    const JointVector q = postures.Next();
    const Pose X_BF = arm.FlangePose(q);
    const LbrSolutions solutions = arm.Solve(X_BF, arm.ArmAngle(q));
    if (!solutions.reachable()) ++unreachable;
    for (const LbrSolution& solution : solutions.configuration) {
      worst_pose = std::max(worst_pose, PoseError(arm.FlangePose(solution.q), X_BF));
      bool within = true;
      for (int i = 0; i < 7; ++i) {
        const JointLimits& limit = arm.params().limits[static_cast<std::size_t>(i)];
        within = within && solution.q[i] >= limit.lower_rad && solution.q[i] <= limit.upper_rad;
      }
      if (within != solution.valid()) ++wrong_validity;
    }
    const double off = (SolutionOf(solutions, LbrArm::Configuration(q)).q - q).cwiseAbs().maxCoeff();
    if (off > 1e-12) worst_joint = std::max(worst_joint, off * LeastSingularValue(arm, q));
  }
  EXPECT_EQ(unreachable, 0);
  EXPECT_EQ(wrong_validity, 0);
  EXPECT_LT(worst_pose, 1e-13);
  EXPECT_LT(worst_joint, 1e-9);
}

TEST(LbrSolutions, EachSolutionHasTheConfigurationOfItsIndex) {
  const LbrArm arm(Iiwa14());
  LbrPostures postures(arm.params(), 1);
  for (int n = 0; n < 1000; ++n) {
    const JointVector q = postures.Next();
    const LbrSolutions solutions = arm.Solve(arm.FlangePose(q), arm.ArmAngle(q));
    for (int k = 0; k < kConfigurations; ++k) EXPECT_EQ(LbrArm::Configuration(SolutionOf(solutions, k).q), k);
  }
}

// All eight solutions have the elbow at the same place: the arm angle does not depend on signs of joints.
TEST(LbrSolutions, AllEightHaveTheRequestedArmAngle) {
  const LbrArm arm(Iiwa14());
  LbrPostures postures(arm.params(), 2);
  for (int n = 0; n < 10'000; ++n) {
    const JointVector q = postures.Next();
    const double psi = kPi * postures.Unit();
    const LbrSolutions solutions = arm.Solve(arm.FlangePose(q), psi);
    for (const LbrSolution& solution : solutions.configuration)
      // 1e-8: if the wrist is 1e-6 beside the vertical through the shoulder, the arm angle's reference loses
      // six digits
      EXPECT_LT(std::abs(std::remainder(arm.ArmAngle(solution.q) - psi, 2.0 * kPi)), 1e-8);
  }
}

TEST(LbrSolutions, ReportsTheJointBeyondItsLimitAndByHowMuch) {
  const JointVector q = (JointVector() << 0.3, 0.7, -0.4, -1.2, 0.5, 0.9, -0.2).finished();
  for (int i = 0; i < 7; ++i) {
    LbrParams tight = Iiwa14();
    JointLimits& limit = tight.limits[static_cast<std::size_t>(i)];
    if (q[i] > 0.0)
      limit.upper_rad = q[i] - 0.05;
    else
      limit.lower_rad = q[i] + 0.05;
    const LbrArm arm(tight);
    const LbrSolution own =
        SolutionOf(arm.Solve(arm.FlangePose(q), arm.ArmAngle(q)), LbrArm::Configuration(q));
    EXPECT_FALSE(own.valid());
    EXPECT_EQ(own.worst_joint, i);
    EXPECT_EQ(own.beyond, 1u << i);
    EXPECT_NEAR(own.beyond_rad, 0.05, 1e-12);
  }
}

TEST(LbrSolutions, NearestIsTheValidSolutionNearestToTheSeed) {
  const LbrArm arm(Iiwa14());
  LbrPostures postures(arm.params(), 3);
  int with = 0, without = 0;
  for (int n = 0; n < 10'000; ++n) {
    const JointVector q = postures.Next(), seed = postures.Next();
    const LbrSolutions solutions = arm.Solve(arm.FlangePose(q), kPi * postures.Unit());
    const LbrSolution* nearest = solutions.Nearest(seed);
    ++(nearest != nullptr ? with : without);
    for (const LbrSolution& solution : solutions.configuration) {
      if (!solution.valid()) continue;
      ASSERT_NE(nearest, nullptr);
      EXPECT_LE((nearest->q - seed).norm(), (solution.q - seed).norm());
    }
    EXPECT_TRUE(nearest == nullptr || nearest->valid());
  }
  EXPECT_GT(with, 1000);
  EXPECT_GT(without, 1000);
}

// The wrist can reach the shell around the shoulder between the radii |d_se - d_ew| and d_se + d_ew, where
// d_se is the length from shoulder to elbow and d_ew that from elbow to wrist. Here the wrist is a known
// distance outside this shell, in any direction.
TEST(LbrSolutions, ReportsTheDistanceOutOfReach) {
  const LbrArm arm(Iiwa14());
  const LbrParams& params = arm.params();
  LbrPostures postures(params, 4);
  const double most = params.shoulder_to_elbow_m + params.elbow_to_wrist_m;
  const double least = params.shoulder_to_elbow_m - params.elbow_to_wrist_m;
  for (int n = 0; n < 1000; ++n) {
    Pose X_BF = arm.FlangePose(postures.Next());
    const Vector3 direction = Vector3(postures.Unit(), postures.Unit(), postures.Unit()).normalized();
    // Solves with the wrist at this distance from the shoulder.
    const auto place = [&](double reach_m) {
      X_BF.translation() = Vector3(0.0, 0.0, params.base_to_shoulder_m) + reach_m * direction +
                           params.wrist_to_flange_m * X_BF.linear().col(2);
      return arm.Solve(X_BF, postures.Unit());
    };
    const double by_m = std::abs(postures.Small());
    EXPECT_NEAR(place(most + by_m).out_of_reach_m, by_m, 1e-15);
    EXPECT_NEAR(place(least - by_m).out_of_reach_m, -by_m, 1e-15);
    EXPECT_TRUE(place(most - by_m).reachable());
    EXPECT_TRUE(place(least + by_m).reachable());
    EXPECT_EQ(place(most + by_m).Nearest(JointVector::Zero()), nullptr);
  }
}

TEST(LbrSolutions, NonFinitePoseOrArmAngleIsNotReachable) {
  const LbrArm arm(Iiwa14());
  const Pose X_BF = arm.FlangePose(JointVector::Constant(0.5));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(arm.Solve(X_BF, nan).out_of_reach_m));
  for (int element = 0; element < 12; ++element) {
    Pose broken = X_BF;
    broken.matrix()(element % 3, element / 3) = nan;
    EXPECT_TRUE(std::isnan(arm.Solve(broken, 0.3).out_of_reach_m)) << element;
    EXPECT_FALSE(arm.Solve(broken, 0.3).reachable());
  }
}

// Exactly singular postures. With the posture as the seed, the posture is among the eight solutions. Every
// seed gives the pose to 2e-12, because a posture within 1e-12 of a singularity is treated as singular. A
// straight elbow is found only to 2e-7: its sine is the square root of the reach's rounding.
TEST(LbrSolutions, SolvesSingularPosturesWithEverySeed) {
  const LbrArm arm(Iiwa14());
  LbrPostures postures(arm.params(), 5);
  for (int n = 0; n < 7000; ++n) {
    const int which = n % 7 + 1;  // any of upper arm vertical, elbow straight, wrist straight together
    JointVector q;
    do q = postures.Next();
    while (std::abs(q[1]) < 0.05 || std::abs(q[3]) < 0.05 || std::abs(q[5]) < 0.05);
    for (int bit = 0; bit < 3; ++bit)
      if ((which >> bit & 1) != 0) q[1 + 2 * bit] = 0.0;
    const Pose X_BF = arm.FlangePose(q);
    double least = std::numeric_limits<double>::infinity();
    for (const LbrSolution& solution : arm.Solve(X_BF, arm.ArmAngle(q), q).configuration)
      least = std::min(least, (solution.q - q).cwiseAbs().maxCoeff());
    EXPECT_LT(least, (which & 2) != 0 ? 2e-7 : 1e-9) << q.transpose();
    const JointVector seed = postures.Next();
    for (const LbrSolution& solution : arm.Solve(X_BF, arm.ArmAngle(q), seed).configuration)
      EXPECT_LT(PoseError(arm.FlangePose(solution.q), X_BF), 2e-12) << q.transpose();
  }
}

// If a straight elbow is bent slightly to one side, the arm angle stays the same. If it is bent to the other
// side, the arm angle changes by pi.
TEST(LbrSolutions, ArmAngleKeepsItsValueOrTurnsByPiBesideAStraightElbow) {
  const LbrArm arm(Iiwa14());
  JointVector q = (JointVector() << 0.3, 0.7, -0.4, 0.0, 0.5, 0.9, -0.2).finished();
  const double at_straight = arm.ArmAngle(q);
  for (const double bend : {1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 1e-15}) {
    q[3] = bend;
    EXPECT_NEAR(arm.ArmAngle(q), at_straight, bend) << bend;
    q[3] = -bend;
    EXPECT_NEAR(std::abs(std::remainder(arm.ArmAngle(q) - at_straight, 2.0 * kPi)), kPi, bend) << bend;
  }
}

// Links of equal length fold until the wrist is in the shoulder: the direction from shoulder to wrist is
// undefined, but every solution gives the pose.
TEST(LbrSolutions, FoldedArmReachesTheShoulder) {
  LbrParams params = Iiwa14();
  params.elbow_to_wrist_m = params.shoulder_to_elbow_m;
  params.limits.fill({});
  const LbrArm arm(params);
  JointVector q = (JointVector() << 0.3, 0.7, -0.4, kPi, 0.5, 0.9, -0.2).finished();
  const Pose X_BF = arm.FlangePose(q);
  const LbrSolutions solutions = arm.Solve(X_BF, 0.4);
  ASSERT_TRUE(solutions.reachable());
  for (const LbrSolution& solution : solutions.configuration)
    EXPECT_LT(PoseError(arm.FlangePose(solution.q), X_BF), 1e-12);
}

TEST(LbrArm, RefusesInvalidParameters) {
  const auto message = [](const LbrParams& params) -> std::string {
    try {
      LbrArm{params};
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(Iiwa14()), "");
  EXPECT_NE(message(LbrParams{}).find("shoulder_to_elbow_m"), std::string::npos);
  LbrParams params = Iiwa14();
  params.elbow_to_wrist_m = -0.4;
  EXPECT_NE(message(params).find("elbow_to_wrist_m: found -0.4,"), std::string::npos);
  params = Iiwa14();
  params.limits[2].upper_rad = 3.5;
  EXPECT_NE(message(params).find("upper position limit of A3"), std::string::npos);
  params = Iiwa14();
  params.limits[6].lower_rad = params.limits[6].upper_rad;
  EXPECT_NE(message(params).find("A7"), std::string::npos);
}

TEST(LbrSolutions, DoesNotAllocate) {
  const LbrArm arm(Iiwa14());
  const JointVector q = JointVector::Constant(0.4);
  const Pose X_BF = arm.FlangePose(q);
  rt::CheckedNoAllocScope no_alloc;
  const LbrSolutions solutions = arm.Solve(X_BF, arm.ArmAngle(q));
  const LbrSolution* nearest = solutions.Nearest(q);
  no_alloc.End();
  EXPECT_NE(nearest, nullptr);
}

}  // namespace
}  // namespace osteon::kinematics
