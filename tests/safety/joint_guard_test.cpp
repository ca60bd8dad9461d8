#include "safety/joint_guard.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::safety {
namespace {

using Guard = JointGuard<7>;
using JointVector = Guard::Joints;
constexpr double kDt_s = 0.001;

// Seven equal joints: ±2 rad, 1.5 rad/s, of which the guard allows 90 %.
JointGuardParams Params() {
  JointGuardParams params;
  params.limits.fill({.lower_rad = -2.0,
                      .upper_rad = 2.0,
                      .velocity_rad_per_s = 1.5,
                      .acceleration_rad_per_s2 = 10.0,
                      .torque_Nm = 100.0});
  return params;
}

TEST(JointGuard, ScalesTheWholeStepByTheFastestJoint) {
  const Guard guard(Params());
  JointVector wanted;
  wanted << 0.01, -0.005, 0.001, 0.0, 0.0, 0.002, -0.003;  // A1 requests 10 rad/s; 1.35 are allowed
  const Guard::Result result = guard.Limit(JointVector::Zero(), wanted, kDt_s);
  EXPECT_NEAR(result.share, 0.135, 1e-12);
  EXPECT_TRUE(result.step.isApprox(0.135 * wanted, 1e-12));
  EXPECT_FALSE(result.jump);
  EXPECT_FALSE(result.violated);
}

TEST(JointGuard, ApproachToAPositionLimitIsMonotoneAndEndsBeforeIt) {
  const Guard guard(Params());
  for (const double sign : {1.0, -1.0}) {
    JointVector q = JointVector::Zero(), wanted = JointVector::Zero();
    q[3] = sign * 1.5;
    wanted[3] = sign * 1.35 * kDt_s;
    double last_step = 1.0;
    for (int i = 0; i < 3000; ++i) {
      const JointVector step = guard.Limit(q, wanted, kDt_s).step;
      ASSERT_GE(sign * step[3], 0.0) << "never back";
      ASSERT_LE(sign * step[3], last_step) << "slower and slower: no chatter";
      last_step = sign * step[3];
      q += step;
      ASSERT_LE(sign * q[3], 2.0 - Params().position_margin_rad + 1e-12);
    }
    EXPECT_GT(sign * q[3], 2.0 - Params().position_margin_rad - 1e-3) << "and gets there";
    wanted[3] = -sign * 1e-3;
    EXPECT_EQ(guard.Limit(q, wanted, kDt_s).share, 1.0) << "the way back is free";
  }
}

// A KR's A2 has the range -190 … 45 deg: each direction ends at its own limit.
TEST(JointGuard, EachDirectionEndsAtItsOwnLimit) {
  JointGuardParams params = Params();
  params.limits[1].lower_rad = -3.3;
  params.limits[1].upper_rad = 0.8;
  const Guard guard(params);
  for (const double sign : {1.0, -1.0}) {
    JointVector q = JointVector::Zero(), wanted = JointVector::Zero();
    wanted[1] = sign * 1.35 * kDt_s;
    for (int i = 0; i < 6000; ++i) q += guard.Limit(q, wanted, kDt_s).step;
    EXPECT_NEAR(q[1], sign > 0 ? 0.8 - params.position_margin_rad : -3.3 + params.position_margin_rad, 1e-3);
    EXPECT_FALSE(guard.Limit(q, wanted, kDt_s).violated);
  }
  JointVector q = JointVector::Zero();
  q[1] = 0.81;
  EXPECT_TRUE(guard.Limit(q, JointVector::Zero(), kDt_s).violated);
  q[1] = -3.29;
  EXPECT_FALSE(guard.Limit(q, JointVector::Zero(), kDt_s).violated);
}

// Such a step occurs if the inverse kinematics changes to another branch.
TEST(JointGuard, AStepOfRadiansIsAJumpAndIsNotMade) {
  const Guard guard(Params());
  JointVector wanted = JointVector::Zero();
  wanted[6] = 3.0;
  const Guard::Result result = guard.Limit(JointVector::Zero(), wanted, kDt_s);
  EXPECT_TRUE(result.jump);
  EXPECT_TRUE(result.step.isZero(0.0));
  wanted[6] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(guard.Limit(JointVector::Zero(), wanted, kDt_s).jump);
}

TEST(JointGuard, AJointOutsideItsRangeIsAViolation) {
  JointVector q = JointVector::Zero();
  q[1] = -2.01;
  EXPECT_TRUE(Guard(Params()).Limit(q, JointVector::Zero(), kDt_s).violated);
}

TEST(JointGuard, RefusesLimitsThatAreNotSet) {
  EXPECT_THROW(Guard(JointGuardParams{}), std::invalid_argument) << "no speed, no acceleration";
  JointGuardParams params = Params();
  params.position_margin_rad = 2.5;
  EXPECT_THROW(Guard{params}, std::invalid_argument);
}

TEST(JointGuard, TheGuardOfASixAxisArmIgnoresTheSeventhLimit) {
  JointGuardParams params = Params();
  params.limits[6] = {};
  const JointGuard<6> guard(params);
  const JointGuard<6>::Joints wanted = JointGuard<6>::Joints::Constant(2.0 * 1.5 * kDt_s);
  const JointGuard<6>::Result result = guard.Limit(JointGuard<6>::Joints::Zero(), wanted, kDt_s);
  EXPECT_NEAR(result.share, 0.5 * params.speed_share, 1e-12);
  EXPECT_THROW(JointGuard<7>{params}, std::invalid_argument);
}

TEST(JointGuard, DoesNotAllocate) {
  const Guard guard(Params());
  const JointVector q = JointVector::Constant(0.3), wanted = JointVector::Constant(0.01);
  rt::CheckedNoAllocScope no_alloc;
  const Guard::Result result = guard.Limit(q, wanted, kDt_s);
  no_alloc.End();
  EXPECT_LT(result.share, 1.0);
}

}  // namespace
}  // namespace osteon::safety
