#include "kinematics/arm_angle_intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/iiwa14.h"
#include "tests/kinematics/near_singular.h"

// The intervals of valid arm angles, compared with the closed-form inverse at many sampled arm angles.

namespace osteon::kinematics {
namespace {

constexpr double kPi = std::numbers::pi;

const LbrSolution& At(const LbrSolutions& solutions, int configuration) {
  return solutions.configuration[static_cast<std::size_t>(configuration)];
}

// Distance of an arm angle to the nearest end of an interval, around the circle [rad]; infinite if there is
// no interval.
double DistanceToEnds(const ArmAngleIntervals& found, double psi_rad) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < found.count; ++i) {
    const ArmAngleInterval& a = found.interval[static_cast<std::size_t>(i)];
    for (const double end : {a.from_rad, a.to_rad})
      smallest = std::min(smallest, std::abs(std::remainder(psi_rad - end, 2.0 * kPi)));
  }
  return smallest;
}

// Smallest distance of a joint to one of its limits.
double DistanceToLimits(const LbrParams& params, const JointVector& q) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 7; ++i) {
    const JointLimits& limit = params.limits[static_cast<std::size_t>(i)];
    smallest = std::min({smallest, std::abs(q[i] - limit.lower_rad), std::abs(q[i] - limit.upper_rad)});
  }
  return smallest;
}

// 2000 poses, every tenth near a singularity, in all eight configurations, at 90 arm angles each. An angle
// must be in an interval exactly if the posture at this angle is valid. The test skips angles within 1e-8 of
// an interval's end, because there the result depends on rounding.
TEST(ArmAngleIntervals, AgreeWithDenseSampling) {
  const LbrArm arm(Iiwa14());
  LbrPostures postures(arm.params(), 7);
  int inside = 0, outside = 0, several = 0;
  for (int n = 0; n < 2000; ++n) {
    const Pose X_BF = arm.FlangePose(postures.Next());
    std::array<ArmAngleIntervals, 8> found;
    for (int k = 0; k < 8; ++k) {
      found[static_cast<std::size_t>(k)] = FindArmAngleIntervals(arm, X_BF, k);
      if (found[static_cast<std::size_t>(k)].count > 1) ++several;
    }
    const double start = kPi * postures.Unit();
    for (int step = 0; step < 90; ++step) {
      const double psi = start + 2.0 * kPi * step / 90.0;
      const LbrSolutions solutions = arm.Solve(X_BF, psi);
      for (int k = 0; k < 8; ++k) {
        const ArmAngleIntervals& intervals = found[static_cast<std::size_t>(k)];
        if (DistanceToEnds(intervals, psi) < 1e-8) continue;
        ++(At(solutions, k).valid() ? inside : outside);
        ASSERT_EQ(intervals.Contains(psi), At(solutions, k).valid())
            << "pose " << n << " configuration " << k << " arm angle " << psi;
      }
    }
  }
  EXPECT_GT(inside, 10'000);
  EXPECT_GT(outside, 10'000);
  EXPECT_GT(several, 100) << "circles with more than one interval must be among them";
}

// At an end of an interval some joint is within 1e-9 rad of its limit; 1e-6 rad outside the end the posture
// is invalid, 1e-6 rad inside the end it is valid.
TEST(ArmAngleIntervals, EndWhereAJointReachesItsLimit) {
  const LbrArm arm(Iiwa14());
  LbrPostures postures(arm.params(), 8);
  int ends = 0;
  for (int n = 0; n < 5000; ++n) {
    const JointVector q = postures.Next();
    const Pose X_BF = arm.FlangePose(q);
    const int k = LbrArm::Configuration(q);
    const ArmAngleIntervals found = FindArmAngleIntervals(arm, X_BF, k);
    EXPECT_TRUE(found.Contains(arm.ArmAngle(q)) || DistanceToEnds(found, arm.ArmAngle(q)) < 1e-8);
    for (int i = 0; i < found.count; ++i) {
      const ArmAngleInterval& a = found.interval[static_cast<std::size_t>(i)];
      ASSERT_GE(a.from_rad, -kPi);
      ASSERT_LT(a.from_rad, kPi);
      ASSERT_GT(a.to_rad, a.from_rad);
      ASSERT_LE(a.to_rad, a.from_rad + 2.0 * kPi);
      const double previous_end_rad =
          found.interval[static_cast<std::size_t>((i + found.count - 1) % found.count)].to_rad;
      const double gap = a.from_rad - previous_end_rad + (i == 0 ? 2.0 * kPi : 0.0);
      ASSERT_TRUE(gap > 0.0 || (found.count == 1 && gap == 0.0));
      if (gap < 1e-4 || a.to_rad - a.from_rad < 1e-4) continue;  // too narrow to check both sides
      for (const auto& [end, outwards] : {std::pair{a.from_rad, -1.0}, std::pair{previous_end_rad, 1.0}}) {
        ++ends;
        const JointVector q_end = At(arm.Solve(X_BF, end), k).q;
        EXPECT_FALSE(At(arm.Solve(X_BF, end + 1e-6 * outwards), k).valid());
        EXPECT_TRUE(At(arm.Solve(X_BF, end - 1e-6 * outwards), k).valid());
        // a joint that jumps by pi at a singular angle need not be at a limit there
        const JointVector q_in = At(arm.Solve(X_BF, end - 1e-6 * outwards), k).q;
        const JointVector q_out = At(arm.Solve(X_BF, end + 1e-6 * outwards), k).q;
        if ((q_in - q_out).cwiseAbs().maxCoeff() > 1e-2) continue;
        EXPECT_LT(DistanceToLimits(arm.params(), q_end), 1e-9) << "pose " << n << " end " << end;
      }
    }
  }
  EXPECT_GT(ends, 2000);
}

// If the arm stands straight up with the flange level, the axes of A1, A3, A5 and A7 coincide, and the elbow
// has no circle to move on. At every arm angle A1 and A5 keep the seed's zero, A3 equals the arm angle, and
// A7 equals minus the arm angle.
TEST(ArmAngleIntervals, FreeJointsOfAStraightArmKeepTheirSeed) {
  const LbrArm arm(Iiwa14());
  const Pose X_BF = arm.FlangePose(JointVector::Zero());
  const ArmAngleIntervals found = FindArmAngleIntervals(arm, X_BF, 0);
  ASSERT_EQ(found.count, 1);
  const double limit = arm.params().limits[2].upper_rad;
  EXPECT_NEAR(found.interval[0].from_rad, -limit, 1e-9);
  EXPECT_NEAR(found.interval[0].to_rad, limit, 1e-9);
  for (double psi = -3.1; psi < 3.1; psi += 0.01)
    EXPECT_EQ(found.Contains(psi), At(arm.Solve(X_BF, psi), 0).valid()) << psi;
}

TEST(ArmAngleIntervals, AreAFullTurnWithoutLimits) {
  LbrParams params = Iiwa14();
  params.limits.fill({});
  const LbrArm arm(params);
  LbrPostures postures(params, 9);
  for (int n = 0; n < 1000; ++n) {
    const Pose X_BF = arm.FlangePose(postures.Next());
    for (int k = 0; k < 8; ++k) {
      const ArmAngleIntervals found = FindArmAngleIntervals(arm, X_BF, k);
      ASSERT_EQ(found.count, 1);
      EXPECT_EQ(found.interval[0].to_rad - found.interval[0].from_rad, 2.0 * kPi);
    }
  }
}

// The limits here are not symmetric about zero, and their ranges are 20 to 180 deg wide. They give more
// interval ends than the limits of an LBR.
TEST(ArmAngleIntervals, AgreeWithSamplingForUnsymmetricLimits) {
  LbrPostures draw(Iiwa14(), 10);
  int checked = 0, valid = 0;
  for (int n = 0; n < 300; ++n) {
    LbrParams params = Iiwa14();
    const JointVector q = draw.Next();
    for (int i = 0; i < 7; ++i) {
      JointLimits& limit = params.limits[static_cast<std::size_t>(i)];
      limit.lower_rad = std::max(-kPi, q[i] - 0.17 - 1.4 * std::abs(draw.Unit()));
      limit.upper_rad = std::min(kPi, q[i] + 0.17 + 1.4 * std::abs(draw.Unit()));
    }
    const LbrArm arm(params);
    const Pose X_BF = arm.FlangePose(q);
    for (int k = 0; k < 8; ++k) {
      const ArmAngleIntervals found = FindArmAngleIntervals(arm, X_BF, k);
      for (int step = 0; step < 90; ++step) {
        const double psi = -kPi + 2.0 * kPi * (step + 0.37) / 90.0;
        if (DistanceToEnds(found, psi) < 1e-8) continue;
        const bool expected = At(arm.Solve(X_BF, psi), k).valid();
        ASSERT_EQ(found.Contains(psi), expected) << "pose " << n << " configuration " << k << " at " << psi;
        ++checked;
        if (expected) ++valid;
      }
    }
  }
  EXPECT_GT(valid, checked / 100);
}

TEST(ArmAngleIntervals, AreEmptyOutOfReach) {
  const LbrArm arm(Iiwa14());
  Pose X_BF = arm.FlangePose(JointVector::Zero());
  X_BF.translation().z() += 0.1;
  const ArmAngleIntervals found = FindArmAngleIntervals(arm, X_BF, 0);
  EXPECT_EQ(found.count, 0);
  EXPECT_NEAR(found.out_of_reach_m, 0.1, 1e-15);
  EXPECT_FALSE(found.Contains(0.0));
}

TEST(ArmAngleIntervals, DoesNotAllocate) {
  const LbrArm arm(Iiwa14());
  const Pose X_BF = arm.FlangePose(JointVector::Constant(0.4));
  rt::CheckedNoAllocScope no_alloc;
  const ArmAngleIntervals found = FindArmAngleIntervals(arm, X_BF, 0);
  no_alloc.End();
  EXPECT_GT(found.count, 0);
}

}  // namespace
}  // namespace osteon::kinematics
