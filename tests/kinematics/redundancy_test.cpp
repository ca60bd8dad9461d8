#include "kinematics/redundancy.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "control/rt/no_alloc_scope.h"
#include "iiwa14.h"

namespace osteon::kinematics {
namespace {

constexpr double kMargin_rad = 0.02;

// The potential of which AwayFromLimits is minus the gradient.
double LimitPotential(const PosturePreferenceParams& params, const JointVectorN<7>& q) {
  double sum = 0.0;
  for (int i = 0; i < 7; ++i) {
    const JointLimits limit = Iiwa14().limits[static_cast<std::size_t>(i)];
    for (const double room : {q[i] - limit.lower_rad - kMargin_rad, limit.upper_rad - kMargin_rad - q[i]}) {
      const double depth = std::max(0.0, 1.0 - room / params.limit_zone_rad);
      sum += params.limit_speed_rad_per_s * params.limit_zone_rad / 3.0 * depth * depth * depth;
    }
  }
  return sum;
}

TEST(Redundancy, AwayFromLimitsIsTheGradientOfItsPotentialAndZeroInMidRange) {
  const PosturePreferenceParams params;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int n = 0; n < 200; ++n) {
    JointVectorN<7> q;
    for (int i = 0; i < 7; ++i) q[i] = (unit(random) > 0.0 ? 0.99 : 0.4) * unit(random) * 2.0;
    const JointVectorN<7> qd = AwayFromLimits<7>(params, Iiwa14().limits, kMargin_rad, q);
    for (int i = 0; i < 7; ++i) {
      constexpr double h = 1e-5;  // of a quadratic gradient: error h^2 / zone^2, some 1e-9
      JointVectorN<7> more = q, less = q;
      more[i] += h;
      less[i] -= h;
      EXPECT_NEAR(qd[i], -(LimitPotential(params, more) - LimitPotential(params, less)) / (2 * h), 1e-8);
    }
  }
  EXPECT_TRUE(AwayFromLimits<7>(params, Iiwa14().limits, kMargin_rad, JointVectorN<7>::Zero()).isZero(0.0));
}

TEST(Redundancy, AtALimitAJointIsLedBackAtTheFullSpeedAndBeyondItNoFaster) {
  const PosturePreferenceParams params;
  JointVectorN<7> q = JointVectorN<7>::Zero();
  q[3] = Iiwa14().limits[3].upper_rad - kMargin_rad;
  JointVectorN<7> qd = AwayFromLimits<7>(params, Iiwa14().limits, kMargin_rad, q);
  EXPECT_DOUBLE_EQ(qd[3], -params.limit_speed_rad_per_s);
  q[3] = Iiwa14().limits[3].lower_rad - 1.0;
  qd = AwayFromLimits<7>(params, Iiwa14().limits, kMargin_rad, q);
  EXPECT_DOUBLE_EQ(qd[3], params.limit_speed_rad_per_s);
  qd[3] = 0.0;
  EXPECT_TRUE(qd.isZero(0.0));
}

TEST(Redundancy, AwayFromSingularityGoesUpTheGradientWithABoundedSpeedThatStartsFromNothing) {
  const PosturePreferenceParams params;
  const rt::NoAllocScope scope;
  JointVectorN<6> gradient;
  gradient << 0.1, -0.05, 0.0, 0.02, 0.0, 0.0;
  EXPECT_TRUE(AwayFromSingularity<6>(params, params.singular_zone_m, gradient).isZero(0.0));
  const JointVectorN<6> at_zero = AwayFromSingularity<6>(params, 0.0, gradient);
  EXPECT_NEAR(at_zero.norm(), params.singular_speed_rad_per_s, 1e-12);
  EXPECT_NEAR(at_zero.dot(gradient), at_zero.norm() * gradient.norm(), 1e-12);
  EXPECT_LT(AwayFromSingularity<6>(params, 0.0, JointVectorN<6>::Constant(1e-9)).norm(), 1e-5)
      << "no direction is made of noise";
  EXPECT_EQ(scope.heap_calls(), 0);
}

}  // namespace
}  // namespace osteon::kinematics
