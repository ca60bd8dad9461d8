#include "kinematics/force_capability.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "kinematics/best_arm_angle.h"
#include "kinematics/serial_chain.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/chain_samples.h"
#include "tests/kinematics/iiwa14.h"

// The closed forms are compared with their definition: the joint torques of single wrenches, computed by
// matrix products, over random arms and dense samples of directions.

namespace osteon::kinematics {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-12;  // relative: some ten products and one quotient of doubles

// The inputs of a capability: Jacobian, gravity torques, torque limits, and the tool's axis.
template <int N>
struct ArmSample {
  JacobianN<N> J;
  JointVectorN<N> g, tau_max;
  Vector3 axis;
};

// A random sample of an arm's size: levers up to 1 m, drives of 40 to 320 N·m.
template <int N>
ArmSample<N> DrawArmSample(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  ArmSample<N> d;
  for (int i = 0; i < N; ++i) {
    for (int row = 0; row < 6; ++row) d.J(row, i) = uniform(random);
    d.tau_max[i] = 180.0 + 140.0 * uniform(random);
    d.g[i] = 0.9 * d.tau_max[i] * uniform(random);
  }
  d.axis = Vector3(uniform(random), uniform(random), uniform(random)).normalized();
  return d;
}

// The capability that counts a drive's relief by gravity. TorqueMargin() gives this value exactly.
template <int N>
ForceCapability<N> CapabilityWithGravityHelp(const ArmSample<N>& d) {
  return {d.J, d.g, d.tau_max, GravityHelp::kCounted};
}

// Distance of the most loaded drive from its limit while the arm holds F [N·m]; negative beyond.
template <int N>
double TorqueMargin(const ArmSample<N>& d, const Wrench& F) {
  Eigen::Matrix<double, 6, 1> wrench;
  wrench << F.f, F.t;
  const JointVectorN<N> tau = d.g + d.J.transpose() * wrench;
  return (d.tau_max - tau.cwiseAbs()).minCoeff();
}

// The direction at `angle` from the axis, turned about the axis by `turn` [rad].
Vector3 DirectionAtAngle(const Vector3& axis, double angle, double turn) {
  const Vector3 side = axis.unitOrthogonal(), other = axis.cross(side);
  return std::cos(angle) * axis + std::sin(angle) * (std::cos(turn) * side + std::sin(turn) * other);
}

template <typename T>
class ForceCapabilityOf : public ::testing::Test {};
using Sizes = ::testing::Types<std::integral_constant<int, 6>, std::integral_constant<int, 7>>;
TYPED_TEST_SUITE(ForceCapabilityOf, Sizes);

TYPED_TEST(ForceCapabilityOf, LargestForcePutsOneDriveAtItsLimitAndNoneBeyond) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(11);
  for (int n = 0; n < 2000; ++n) {
    const ArmSample<N> d = DrawArmSample<N>(random);
    const CapabilityLimit most = CapabilityWithGravityHelp(d).Force(d.axis);
    ASSERT_GT(most.value, 0.0);
    ASSERT_NEAR(TorqueMargin(d, {.f = most.value * d.axis, .t = Vector3::Zero()}), 0.0, 320.0 * kRounding);
    const JointVectorN<N> tau = d.g + d.J.template topRows<3>().transpose() * (most.value * d.axis);
    ASSERT_NEAR(std::abs(tau[most.joint]), d.tau_max[most.joint], 320.0 * kRounding) << "the one it names";
  }
}

TYPED_TEST(ForceCapabilityOf, LargestWrenchPutsOneDriveAtItsLimitAndNoneBeyond) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(12);
  for (int n = 0; n < 2000; ++n) {
    const ArmSample<N> d = DrawArmSample<N>(random), other = DrawArmSample<N>(random);
    const Wrench F{.f = 30.0 * d.axis, .t = 5.0 * other.axis};
    const double s = CapabilityWithGravityHelp(d).Factor(F).value;
    ASSERT_NEAR(TorqueMargin(d, {.f = s * F.f, .t = s * F.t}), 0.0, 320.0 * kRounding);
  }
}

TYPED_TEST(ForceCapabilityOf, LateralForceIsHeldInEveryDirectionBesideTheAxialForce) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(14);
  for (int n = 0; n < 100; ++n) {
    const ArmSample<N> d = DrawArmSample<N>(random);
    const ForceCapability<N> arm = CapabilityWithGravityHelp(d);
    const double axial_N = 0.5 * arm.Force(d.axis).value * (n % 3);  // none, half or all of it
    const double guaranteed = arm.LateralForce(d.axis, axial_N).value;
    double least_room = HUGE_VAL, least_room_beyond = HUGE_VAL;
    for (double turn = 0.0; turn < 2.0 * kPi; turn += kPi / 1800.0) {
      const Vector3 u = DirectionAtAngle(d.axis, 0.5 * kPi, turn);
      least_room =
          std::min(least_room, TorqueMargin(d, {.f = axial_N * d.axis + guaranteed * u, .t = {0, 0, 0}}));
      least_room_beyond = std::min(
          least_room_beyond,
          TorqueMargin(d, {.f = axial_N * d.axis + (1.0001 * guaranteed + 1e-3) * u, .t = {0, 0, 0}}));
    }
    ASSERT_GE(least_room, -320.0 * kRounding);
    ASSERT_LT(least_room_beyond, 0.0);
  }
}

TYPED_TEST(ForceCapabilityOf, FactorOfALoadIsTheLargestThatHoldsEveryWrenchOfTheLoad) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(15);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int n = 0; n < 200; ++n) {
    const ArmSample<N> d = DrawArmSample<N>(random);
    const ToolLoad load{.axial_N = n % 2 == 0 ? 200.0 : -150.0, .lateral_N = 40.0, .torque_Nm = 6.0};
    const CapabilityLimit k = CapabilityWithGravityHelp(d).Factor(d.axis, load);
    // the worst wrench of the load for each drive; among them, the most loaded drive must be exactly at its
    // limit
    double smallest = HUGE_VAL;
    for (int i = 0; i < N; ++i)
      for (const double sign : {1.0, -1.0})
        for (const double axial : {0.0, load.axial_N}) {
          const Vector3 Jv = d.J.template block<3, 1>(0, i), Jw = d.J.template block<3, 1>(3, i);
          const Vector3 across = sign * (Jv - Jv.dot(d.axis) * d.axis).normalized();
          const Wrench worst{.f = k.value * (axial * d.axis + load.lateral_N * across),
                             .t = k.value * load.torque_Nm * sign * Jw.normalized()};
          smallest = std::min(smallest, TorqueMargin(d, worst));
        }
    ASSERT_NEAR(smallest, 0.0, 320.0 * kRounding);
    // the arm holds every other wrench of the load
    for (int m = 0; m < 50; ++m) {
      const Vector3 t = Vector3(uniform(random), uniform(random), uniform(random)).normalized();
      const Vector3 across = DirectionAtAngle(d.axis, 0.5 * kPi, kPi * uniform(random));
      const double share = std::abs(uniform(random));
      const Wrench F{
          .f = k.value * (share * load.axial_N * d.axis + uniform(random) * load.lateral_N * across),
          .t = k.value * uniform(random) * load.torque_Nm * t};
      ASSERT_GE(TorqueMargin(d, F), -320.0 * kRounding);
    }
  }
}

TYPED_TEST(ForceCapabilityOf, ForceIsHeldWithAnyTorqueUpToTheBound) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(16);
  for (int n = 0; n < 500; ++n) {
    ArmSample<N> d = DrawArmSample<N>(random);
    d.g *= 0.3;
    const double f = CapabilityWithGravityHelp(d).Force(d.axis, 20.0).value;
    double smallest = HUGE_VAL;
    for (int i = 0; i < N; ++i)
      for (const double sign : {1.0, -1.0})
        smallest = std::min(
            smallest, TorqueMargin(d, {.f = f * d.axis,
                                       .t = 20.0 * sign * d.J.template block<3, 1>(3, i).normalized()}));
    ASSERT_GE(smallest, -320.0 * kRounding);
    if (f > 0.0) {
      ASSERT_NEAR(smallest, 0.0, 320.0 * kRounding);
    }
    ASSERT_LE(f, CapabilityWithGravityHelp(d).Force(d.axis).value);
    ASSERT_LE(CapabilityWithGravityHelp(d).LateralForce(d.axis, 0.0, 20.0).value,
              CapabilityWithGravityHelp(d).LateralForce(d.axis).value);
  }
}

TYPED_TEST(ForceCapabilityOf, WithoutGravityHelpForceIsEqualBothWaysAndNeverLarger) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(17);
  bool helps = false;
  for (int n = 0; n < 500; ++n) {
    const ArmSample<N> d = DrawArmSample<N>(random);
    const ForceCapability<N> cautious(d.J, d.g, d.tau_max, GravityHelp::kNotCounted);
    const double there = cautious.Force(d.axis).value, back = cautious.Force(-d.axis).value;
    EXPECT_NEAR(there, back, there * kRounding);
    const double exact = std::min(CapabilityWithGravityHelp(d).Force(d.axis).value,
                                  CapabilityWithGravityHelp(d).Force(-d.axis).value);
    ASSERT_LE(there, CapabilityWithGravityHelp(d).Force(d.axis).value * (1.0 + kRounding));
    ASSERT_NEAR(there, exact, exact * kRounding) << "the lesser of the two ways";
    helps = helps || CapabilityWithGravityHelp(d).Force(d.axis).value > 1.05 * there;
  }
  EXPECT_TRUE(helps) << "gravity must help somewhere, or the two are one";
}

TYPED_TEST(ForceCapabilityOf, HoldableShareKeepsTorqueLimitsAndIsOneForAWrenchThatFits) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(18);
  int cut = 0;
  for (int n = 0; n < 2000; ++n) {
    const ArmSample<N> d = DrawArmSample<N>(random), other = DrawArmSample<N>(random);
    const Wrench F{.f = 150.0 * d.axis, .t = 10.0 * other.axis};
    const double s = CapabilityWithGravityHelp(d).HoldableShare(F);
    ASSERT_GE(TorqueMargin(d, {.f = s * F.f, .t = s * F.t}), -320.0 * kRounding);
    if (s < 1.0) ++cut;
    if (TorqueMargin(d, F) > 1e-9) {
      ASSERT_EQ(s, 1.0);
    }
  }
  EXPECT_GT(cut, 100);
  EXPECT_LT(cut, 2000);
}

TYPED_TEST(ForceCapabilityOf, ForceInALostDirectionIsCappedAndNamesNoJoint) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(19);
  ArmSample<N> d = DrawArmSample<N>(random);
  d.axis = Vector3::UnitX();
  d.J.row(0).setZero();  // now no joint moves the point along x
  const ForceCapability<N> arm = CapabilityWithGravityHelp(d);
  EXPECT_EQ(arm.Force(d.axis).value, kForceCap_N);
  EXPECT_EQ(arm.Force(d.axis).joint, -1);
  EXPECT_EQ(arm.Factor({.f = 2.0 * d.axis, .t = {0, 0, 0}}).value, 0.5 * kForceCap_N);
  EXPECT_LT(arm.LateralForce(d.axis).value, kForceCap_N) << "across it there are limits";
}

TYPED_TEST(ForceCapabilityOf, AnArmThatCannotHoldItselfHoldsNothing) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(20);
  ArmSample<N> d = DrawArmSample<N>(random);
  d.g[2] = -1.01 * d.tau_max[2];
  for (const GravityHelp help : {GravityHelp::kCounted, GravityHelp::kNotCounted}) {
    const ForceCapability<N> arm(d.J, d.g, d.tau_max, help);
    EXPECT_EQ(arm.Force(d.axis).value, 0.0);
    EXPECT_EQ(arm.LateralForce(d.axis).value, 0.0);
    EXPECT_EQ(arm.Factor(d.axis, {.axial_N = 1.0}).value, 0.0);
    EXPECT_EQ(arm.HoldableShare({.f = d.axis, .t = {0, 0, 0}}), 0.0);
  }
}

TYPED_TEST(ForceCapabilityOf, NonFiniteInputGivesZeroAndAHugeWrenchIsScaled) {
  constexpr int N = TypeParam::value;
  std::mt19937_64 random(21);
  const ArmSample<N> d = DrawArmSample<N>(random);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    ArmSample<N> spoilt = d;
    spoilt.J(1, 3) = bad;
    EXPECT_EQ(CapabilityWithGravityHelp(spoilt).HoldableShare({.f = d.axis, .t = {0, 0, 0}}), 0.0);
    spoilt = d;
    spoilt.g[1] = bad;
    EXPECT_EQ(CapabilityWithGravityHelp(spoilt).HoldableShare({.f = d.axis, .t = {0, 0, 0}}), 0.0);
    EXPECT_EQ(CapabilityWithGravityHelp(d).HoldableShare({.f = {0, bad, 0}, .t = {0, 0, 0}}), 0.0);
    EXPECT_EQ(CapabilityWithGravityHelp(d).Force({0, bad, 0}).value, 0.0);
    EXPECT_EQ(CapabilityWithGravityHelp(d).Force(d.axis, bad).value, 0.0);
  }
  constexpr double kHuge = std::numeric_limits<double>::max();
  for (const double sign : {1.0, -1.0}) {
    const double s = CapabilityWithGravityHelp(d).HoldableShare(
        {.f = {kHuge, sign * kHuge, kHuge}, .t = {kHuge, kHuge, sign * kHuge}});
    EXPECT_GE(s, 0.0);
    EXPECT_LE(s, 1e-290);
  }
}

TEST(ForceCapability, DoesNotAllocate) {
  std::mt19937_64 random(22);
  const ArmSample<7> d = DrawArmSample<7>(random);
  double sum = 0.0;
  {
    rt::CheckedNoAllocScope no_alloc;
    const ForceCapability<7> arm = CapabilityWithGravityHelp(d);
    sum += arm.Force(d.axis, 1.0).value + arm.Factor({.f = d.axis, .t = d.axis}).value +
           arm.LateralForce(d.axis, 10.0).value +
           arm.Factor(d.axis, {.axial_N = 100.0, .lateral_N = 30.0}).value +
           arm.HoldableShare({.f = d.axis, .t = d.axis});
  }
  EXPECT_GT(sum, 0.0);
}

// The iiwa 14 with its joints anywhere within their limits, and a tool along the flange's axis.
class Iiwa14Force : public ::testing::Test {
 protected:
  JointVectorN<7> AnyPosture() {
    JointVectorN<7> q;
    for (int i = 0; i < 7; ++i) {
      const JointLimits& limits = body_.joints[static_cast<std::size_t>(i)].limits;
      q[i] = std::uniform_real_distribution<double>(limits.lower_rad, limits.upper_rad)(random_);
      torque_limit_[i] = limits.torque_Nm;
    }
    return q;
  }
  // capability at the apex of a tool of length_m, and the tool's axis
  ForceCapability<7> At(const JointVectorN<7>& q, double length_m, GravityHelp help, Vector3& axis_B) const {
    const SerialChain<7>::Posture posture = chain_.ComputePosture(q);
    axis_B = posture.X_BF.linear().col(2);
    return {chain_.JacobianAt(posture, posture.X_BF * Vector3(0.0, 0.0, length_m)), chain_.Gravity(q),
            torque_limit_, help};
  }

  const ChainParams<7> body_ = Iiwa14Chain();
  const SerialChain<7> chain_{body_};
  JointVectorN<7> torque_limit_ = JointVectorN<7>::Zero();
  std::mt19937_64 random_{23};
};

// A6's axis is perpendicular to the tool, (0.126 + L) m from the apex of a tool of length L. Its 40 N·m
// therefore hold 177, 123 and 94 N at L = 0.1, 0.2 and 0.3 m. Every other joint holds more, in any posture.
// The arm is weightless: masses beyond A6 would take torque.
TEST_F(Iiwa14Force, A6LimitsTheLateralForceToItsTorqueOverItsLever) {
  const SerialChain<7> weightless(body_, Vector3::Zero());
  for (const double length_m : {0.10, 0.20, 0.30})
    for (int n = 0; n < 1000; ++n) {
      const JointVectorN<7> q = AnyPosture();
      const SerialChain<7>::Posture posture = weightless.ComputePosture(q);
      const ForceCapability<7> arm(weightless.JacobianAt(posture, posture.X_BF * Vector3(0.0, 0.0, length_m)),
                                   weightless.Gravity(q), torque_limit_, GravityHelp::kNotCounted);
      const CapabilityLimit lateral = arm.LateralForce(posture.X_BF.linear().col(2));
      ASSERT_NEAR(lateral.value, 40.0 / (0.126 + length_m), 1e-9);
      ASSERT_EQ(lateral.joint, 5);
    }
}

// 400 N is twice the cell's limit. Some postures hold 400 N only because gravity relieves a drive. Without
// counting that relief, one percent fewer postures do, because the drives at the shoulder carry some 60 N·m
// of the arm's own weight.
TEST_F(Iiwa14Force, AxialForceIs400NewtonInAlmostEveryPosture) {
  constexpr int kPostures = 20'000;
  int exact = 0, cautious = 0;
  for (int n = 0; n < kPostures; ++n) {
    const JointVectorN<7> q = AnyPosture();
    Vector3 axis_B;
    if (At(q, 0.2, GravityHelp::kCounted, axis_B).Force(axis_B).value >= 400.0) ++exact;
    if (At(q, 0.2, GravityHelp::kNotCounted, axis_B).Force(axis_B).value >= 400.0) ++cautious;
  }
  EXPECT_GE(exact, 0.95 * kPostures);
  EXPECT_GE(cautious, 0.94 * kPostures);
  EXPECT_LT(cautious, exact);
}

// The oracle samples 3600 arm angles in every configuration.
TEST_F(Iiwa14Force, BestArmAngleHoldsAsMuchAsAnySampledArmAngle) {
  const LbrArm arm(Iiwa14());
  constexpr int kFine = 3600;
  int better_than_own = 0, poses = 0;
  for (int n = 0; n < 40; ++n) {
    const JointVectorN<7> q_own = AnyPosture();
    const auto force = [&](const JointVectorN<7>& q) {
      Vector3 axis_B;
      return At(q, 0.18, GravityHelp::kNotCounted, axis_B).Force(axis_B).value;
    };
    const Pose X_BF = arm.FlangePose(q_own);
    const BestArmAngle best = FindBestArmAngle(arm, X_BF, force);
    ASSERT_TRUE(best.found);
    ++poses;
    // best.q is a posture of the pose, with the stated arm angle and value
    ASSERT_LT((arm.FlangePose(best.q).matrix() - X_BF.matrix()).norm(), 1e-9);
    ASSERT_NEAR(std::remainder(arm.ArmAngle(best.q) - best.arm_angle_rad, 2.0 * kPi), 0.0, 1e-6);
    ASSERT_EQ(force(best.q), best.value);
    double most = 0.0;
    for (int k = 0; k < kFine; ++k)
      for (const LbrSolution& solution : arm.Solve(X_BF, 2.0 * kPi * k / kFine).configuration)
        if (solution.valid()) most = std::max(most, force(solution.q));
    // 2 %: a maximum narrower than 10 deg may hide between the samples
    ASSERT_GE(best.value, 0.98 * most) << "pose " << n;
    if (best.value > 1.1 * force(q_own)) ++better_than_own;
  }
  EXPECT_GT(better_than_own, poses / 2) << "the arm angle must matter, or nothing is proven";
}

// One joint's limits leave a range of arm angles of a third of a degree. Evenly spaced samples of the circle
// miss it.
TEST_F(Iiwa14Force, BestArmAngleFindsANarrowSelfMotion) {
  LbrParams params = Iiwa14();
  JointVectorN<7> q;
  q << 0.3, 0.6, 0.4, -1.3, 0.5, 0.9, -0.2;
  params.limits[2].lower_rad = q[2] - 0.003;
  params.limits[2].upper_rad = q[2] + 0.003;
  const LbrArm arm(params);
  const Pose X_BF = arm.FlangePose(q);
  const auto value = [](const JointVectorN<7>& posture) { return posture[0]; };
  const BestArmAngle best = FindBestArmAngle(arm, X_BF, value);
  ASSERT_TRUE(best.found);
  EXPECT_LT((arm.FlangePose(best.q).matrix() - X_BF.matrix()).norm(), 1e-9);
  EXPECT_NEAR(best.q[2], q[2], 0.003 + 1e-9);
  EXPECT_GE(best.value, q[0]) << "the posture that made the pose is one of them";
  params.limits[3] = {.lower_rad = 1.0, .upper_rad = 1.1};
  EXPECT_FALSE(FindBestArmAngle(LbrArm(params), X_BF, value).found);
  Pose X_far = X_BF;
  X_far.translation() *= 3.0;
  EXPECT_FALSE(FindBestArmAngle(arm, X_far, value).found);
}

}  // namespace
}  // namespace osteon::kinematics
