#include "kinematics/redundancy.h"

#include <algorithm>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "chain_samples.h"
#include "iiwa14.h"
#include "kinematics/differential_inverse.h"
#include "kinematics/lbr_arm.h"
#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::kinematics {
namespace {

constexpr double kMargin_rad = 0.02;  // distance kept from the limits

// The potential whose negative gradient is AwayFromLimits.
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
      constexpr double h = 1e-5;  // for a quadratic gradient: error h^2 / zone^2, some 1e-9
      JointVectorN<7> more = q, less = q;
      more[i] += h;
      less[i] -= h;
      EXPECT_NEAR(qd[i], -(LimitPotential(params, more) - LimitPotential(params, less)) / (2 * h), 1e-8);
    }
  }
  EXPECT_TRUE(AwayFromLimits<7>(params, Iiwa14().limits, kMargin_rad, JointVectorN<7>::Zero()).isZero(0.0));
}

TEST(Redundancy, AJointAtOrBeyondItsLimitIsLedBackAtTheFullSpeed) {
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

TEST(Redundancy, AwayFromSingularityClimbsTheGradientWithASpeedFromZeroToItsBound) {
  const PosturePreferenceParams params;
  rt::CheckedNoAllocScope no_alloc;
  JointVectorN<6> gradient;
  gradient << 0.1, -0.05, 0.0, 0.02, 0.0, 0.0;
  EXPECT_TRUE(AwayFromSingularity<6>(params, params.singular_zone_m, gradient).isZero(0.0));
  const JointVectorN<6> at_zero = AwayFromSingularity<6>(params, 0.0, gradient);
  EXPECT_NEAR(at_zero.norm(), params.singular_speed_rad_per_s, 1e-12);
  EXPECT_NEAR(at_zero.dot(gradient), at_zero.norm() * gradient.norm(), 1e-12);
  EXPECT_LT(AwayFromSingularity<6>(params, 0.0, JointVectorN<6>::Constant(1e-9)).norm(), 1e-5)
      << "no direction is made of noise";
}

// An iiwa with weak A3 and A4 that presses 200 N along a tool of 0.2 m, and 35 N across the tool. The share
// of this load that the arm holds depends on the elbow's position.
struct Pressing {
  Pressing() {
    ChainParams<7> params = Iiwa14Chain();
    for (std::size_t i = 0; i < 7; ++i) params.joints[i].limits = Iiwa14().limits[i];
    chain.emplace(params);
    wanted.load = {.axial_N = 200.0, .lateral_N = 35.0};
    wanted.p_F = {0.0, 0.0, 0.2};
    wanted.torque_limit_Nm << 320.0, 320.0, 80.0, 80.0, 110.0, 40.0, 40.0;
  }
  std::optional<SerialChain<7>> chain;
  LoadTarget<7> wanted;
};

// Preferred joint velocities at q, with null direction n [rad/s].
JointVectorN<7> LoadGradientMotion(const PosturePreferenceParams& params, const Pressing& pressing,
                                   const JointVectorN<7>& q, const JointVectorN<7>& n) {
  const double held = HeldLoad<7>(*pressing.chain, pressing.wanted, q).value;
  return LoadGradientMotion<7>(params, *pressing.chain, pressing.wanted, {.q = q, .n = n, .held = held}).qd;
}

// The flange does not move while the elbow follows the preference. The motion must end in a posture in which
// the arm holds nearly `load_zone` times the load, or in which no neighbouring arm angle holds more.
TEST(Redundancy, ElbowMovesToWhereTheArmHoldsMost) {
  const Pressing pressing;
  const LbrArm lbr(Iiwa14());
  DifferentialInverseParams<7> params;
  params.limits = Iiwa14().limits;
  const DifferentialInverse<7> motion(params);
  const PosturePreferenceParams preference;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int climbed = 0, at_zone = 0, at_top = 0;
  while (climbed < 15) {
    MotionInput<7> in;
    in.q << unit(random), 0.9 * unit(random), unit(random), 1.0 + 0.7 * unit(random), unit(random),
        1.0 + 0.5 * unit(random), unit(random);
    const double held_at_start = HeldLoad<7>(*pressing.chain, pressing.wanted, in.q).value;
    if (held_at_start > 1.1) continue;
    ++climbed;
    const Pose X_BF = lbr.FlangePose(in.q);
    in.dt_s = 0.001;
    MotionOutput<7> out;
    for (int tick = 0; tick < 15'000; ++tick) {
      in.J = lbr.JacobianAt(in.q, Vector3::Zero());
      // corrects each tick's third-order error, so that the flange keeps its pose over the whole motion
      const Pose X_now = lbr.FlangePose(in.q);
      in.V_BT = {.v = 10.0 * (X_BF.translation() - X_now.translation()),
                 .w = 10.0 * (X_now.linear() * LogRotation(X_now.linear().transpose() * X_BF.linear()))};
      in.qd_null = LoadGradientMotion(preference, pressing, in.q, out.null_direction);
      out = motion.Step(in);
      in.q += in.dt_s * out.qd;
      in.qd_before = out.qd;
      in.share_before = out.share;
    }
    EXPECT_LT((lbr.FlangePose(in.q).matrix() - X_BF.matrix()).cwiseAbs().maxCoeff(), 1e-4);
    const double held = HeldLoad<7>(*pressing.chain, pressing.wanted, in.q).value;
    EXPECT_GT(held, held_at_start - 1e-6);
    if (held > preference.load_zone - 0.12) {
      ++at_zone;  // the preference already fades out a little below load_zone, hence 0.12
      continue;
    }
    // otherwise the posture must be a maximum; 8 % allows for the gradient's averaging over ±0.02 rad near an
    // edge of the capability
    double around = held;
    for (const double turn : {-0.1, -0.05, 0.05, 0.1}) {
      JointVector neighbour;
      if (lbr.Inverse(X_BF, lbr.ArmAngle(in.q) + turn, in.q, neighbour) &&
          (neighbour - in.q).cwiseAbs().maxCoeff() < 0.5)
        around = std::max(around, HeldLoad<7>(*pressing.chain, pressing.wanted, neighbour).value);
    }
    EXPECT_LT(around, 1.08 * held) << in.q.transpose();
    if (around < 1.08 * held) ++at_top;
  }
  EXPECT_GT(at_zone, 3);
  EXPECT_GT(at_top, 3);
}

TEST(Redundancy, NoPreferenceIfTheArmHoldsEnoughOrHasNoLoad) {
  Pressing pressing;
  const PosturePreferenceParams params;
  JointVectorN<7> q, n = JointVectorN<7>::Zero();
  q << 0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2;
  n << 0.5, -0.1, -0.6, 0.0, 0.4, 0.1, -0.45;
  n.normalize();
  const auto preferred_speed = [&] { return LoadGradientMotion(params, pressing, q, n).norm(); };
  const double k = HeldLoad<7>(*pressing.chain, pressing.wanted, q).value;
  const ToolLoad asked = pressing.wanted.load;
  const auto scale_load = [&](double share) {
    pressing.wanted.load = {.axial_N = share * asked.axial_N, .lateral_N = share * asked.lateral_N};
  };
  scale_load(k / (1.001 * params.load_zone));
  EXPECT_EQ(preferred_speed(), 0.0) << "the arm holds the zone's multiple";
  scale_load(k / (0.95 * params.load_zone));
  EXPECT_GT(preferred_speed(), 0.0);
  const double shallow = preferred_speed();
  scale_load(k);
  EXPECT_GT(preferred_speed(), shallow) << "the less it holds";
  EXPECT_LT(preferred_speed(), params.load_speed_rad_per_s);
  scale_load(0.0);
  EXPECT_EQ(preferred_speed(), 0.0) << "no load";
}

TEST(Redundancy, LoadGradientMotionDoesNotAllocate) {
  const Pressing pressing;
  const PosturePreferenceParams params;
  JointVectorN<7> q = JointVectorN<7>::Constant(0.4), n = JointVectorN<7>::Constant(0.3);
  rt::CheckedNoAllocScope no_alloc;
  EXPECT_TRUE(LoadGradientMotion(params, pressing, q, n).allFinite());
}

}  // namespace
}  // namespace osteon::kinematics
