#include "tests/oracles/numerical_inverse.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/iiwa14.h"
#include "tests/kinematics/kr_arms.h"

// The numerical inverse, which other tests use as an oracle, is compared here with the forward kinematics and
// with closed forms.

namespace osteon::kinematics {
namespace {

// A six-axis arm whose wrist has an offset, as in painting robots.
ChainParams<6> OffsetWrist() {
  ChainParams<6> chain = ChainFrom(Kr6R900Params());
  chain.joints[4].X_PJ.translation().x() = 0.05;
  return chain;
}

// Seven joints with an offset at each, as in a Franka or a Sawyer arm.
ChainParams<7> OffsetArm() {
  const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ();
  const std::array<Vector3, 7> axis{z, y, z, -y, z, y, z};
  const std::array<Vector3, 7> origin{Vector3(0, 0, .36),    Vector3(.03, 0, 0),  Vector3(.05, 0, .2),
                                      Vector3(-.05, 0, .22), Vector3(.03, 0, .2), Vector3(.02, 0, .2),
                                      Vector3(.088, 0, .1)};
  ChainParams<7> chain;
  for (std::size_t i = 0; i < 7; ++i) {
    chain.joints[i].axis_J = axis[i];
    chain.joints[i].X_PJ.translation() = origin[i];
    chain.joints[i].limits = Iiwa14().limits[i];
  }
  return chain;
}

template <int N>
JointVectorN<N> RandomWithinLimits(const ChainParams<N>& params, std::mt19937_64& random) {
  JointVectorN<N> q;
  for (int i = 0; i < N; ++i) {
    const JointLimits& limit = params.joints[static_cast<std::size_t>(i)].limits;
    q[i] = std::uniform_real_distribution<double>(limit.lower_rad, limit.upper_rad)(random);
  }
  return q;
}

template <int N>
bool KeepsLimits(const ChainParams<N>& params, const JointVectorN<N>& q) {
  for (int i = 0; i < N; ++i) {
    const JointLimits& limit = params.joints[static_cast<std::size_t>(i)].limits;
    if (!(q[i] >= limit.lower_rad && q[i] <= limit.upper_rad)) return false;
  }
  return true;
}

// The posture is within the limits, and the reported errors and `reached` are true for it.
template <int N>
void ExpectConsistentResult(const SerialChain<N>& chain, const Pose& X_BF,
                            const NumericalInverseResult<N>& result, const NumericalInverseParams& params) {
  EXPECT_TRUE(KeepsLimits<N>(chain.params(), result.q));
  const Pose X_FD = chain.FlangePose(result.q).inverse() * X_BF;
  EXPECT_NEAR(X_FD.translation().norm(), result.error_m, 1e-14);
  EXPECT_NEAR(LogRotation(X_FD.linear()).norm(), result.error_rad, 1e-14);
  EXPECT_EQ(result.reached(),
            result.error_m <= params.tolerance_m && result.error_rad <= params.tolerance_rad);
  EXPECT_LE(result.restarts, params.max_restarts);
  EXPECT_LE(result.iterations, (1 + params.max_restarts) * params.max_iterations);
}

// Random poses and random seeds within the limits: 99 of 100 poses must be reached; 2999 of 3000 were
// measured.
template <int N>
void ExpectReachesFromAnySeed(const ChainParams<N>& params) {
  const SerialChain<N> chain(params);
  std::mt19937_64 random(11);
  int reached = 0;
  for (int n = 0; n < 1000; ++n) {
    const Pose X_BF = chain.FlangePose(RandomWithinLimits<N>(params, random));
    const auto result = NumericalInverse<N>(chain, X_BF, RandomWithinLimits<N>(params, random));
    ExpectConsistentResult<N>(chain, X_BF, result, {});
    if (result.reached()) ++reached;
  }
  EXPECT_GE(reached, 990);
}

TEST(NumericalInverse, ReachesWithAnOffsetWrist) { ExpectReachesFromAnySeed<6>(OffsetWrist()); }
TEST(NumericalInverse, ReachesWithOffsetLinks) { ExpectReachesFromAnySeed<7>(OffsetArm()); }

// From 0.1 rad away one attempt and few steps suffice: errors fall quadratically, 1e-1, 1e-2, 1e-4, 1e-8.
TEST(NumericalInverse, ConvergesInFewStepsFromNearby) {
  const SerialChain<7> chain(OffsetArm());
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> near(-0.1, 0.1);
  NumericalInverseParams once;
  once.max_restarts = 0;
  int steps = 0;
  for (int n = 0; n < 1000; ++n) {
    const JointVectorN<7> q = RandomWithinLimits<7>(chain.params(), random);
    JointVectorN<7> seed = q;
    for (int i = 0; i < 7; ++i) seed[i] += near(random);
    const auto result = NumericalInverse<7>(chain, chain.FlangePose(q), seed, once);
    EXPECT_TRUE(result.reached()) << Name(result.stop) << ' ' << result.error_m;
    steps += result.iterations;
  }
  EXPECT_LT(steps, 6 * 1000);
}

// On an LBR, the result equals the closed form at its arm angle.
TEST(NumericalInverse, AgreesWithTheClosedFormOfAnLbr) {
  const LbrArm arm(Iiwa14());
  ChainParams<7> params = OffsetArm();
  const std::array<double, 7> z{.36, 0, 0, .42, 0, .4, 0};
  for (std::size_t i = 0; i < 7; ++i) params.joints[i].X_PJ.translation() = Vector3(0, 0, z[i]);
  params.X_LF.translation().z() = .126;
  const SerialChain<7> chain(params);
  std::mt19937_64 random(13);
  int compared = 0;
  for (int n = 0; n < 300; ++n) {
    const Pose X_BF = chain.FlangePose(RandomWithinLimits<7>(params, random));
    const auto result = NumericalInverse<7>(chain, X_BF, RandomWithinLimits<7>(params, random));
    if (!result.reached()) continue;
    const LbrSolutions solutions = arm.Solve(X_BF, arm.ArmAngle(result.q));
    const LbrSolution& own =
        solutions.configuration[static_cast<std::size_t>(LbrArm::Configuration(result.q))];
    // away from a singularity, the pose's error of 1e-9 over the smallest singular value is at most 1e-6
    const bool regular =
        std::abs(result.q[1]) > 0.1 && std::abs(result.q[3]) > 0.1 && std::abs(result.q[5]) > 0.1;
    if (!regular) continue;
    EXPECT_LT((own.q - result.q).cwiseAbs().maxCoeff(), 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 200);
}

// Half a metre out of reach, the arm stretches toward the pose as far as the closed form predicts.
TEST(NumericalInverse, StopsAtTheNearestPostureIfOutOfReach) {
  const OrthoParallelArm closed(Kr6R900Params());
  const SerialChain<6> chain(ChainFrom(Kr6R900Params()));
  Pose X_BF = Pose::Identity();
  X_BF.linear() = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3::UnitY()).toRotationMatrix();
  X_BF.translation() = Vector3(1.5, 0.0, 0.4);
  const double missing_m = closed.Solve(X_BF).out_of_reach_m;
  const auto result = NumericalInverse<6>(chain, X_BF, (JointVectorN<6>() << 0, -1, 1, 0, 0.3, 0).finished());
  EXPECT_EQ(result.stop, InverseStop::kLocalMinimum) << Name(result.stop);
  ExpectConsistentResult<6>(chain, X_BF, result, {});
  EXPECT_NEAR(result.error_m, missing_m, 1e-6);
  EXPECT_LT(result.error_rad, 1e-6);
}

TEST(NumericalInverse, ReportsThatAJointLimitHoldsItBack) {
  ChainParams<6> params = ChainFrom(Kr6R900Params());
  const JointVectorN<6> q = (JointVectorN<6>() << 0.3, -1.2, 0.9, -0.4, 0.8, 0.9).finished();
  const Pose X_BF = SerialChain<6>(params).FlangePose(q);
  for (RevoluteJoint& joint : params.joints) joint.limits = {.lower_rad = -1.5, .upper_rad = 1.5};
  params.joints[0].limits.upper_rad = 0.2;  // A1 cannot turn to the pose
  const SerialChain<6> chain(params);
  NumericalInverseParams once;
  once.max_restarts = 0;
  JointVectorN<6> seed = q;
  seed[0] = 0.1;
  const auto result = NumericalInverse<6>(chain, X_BF, seed, once);
  EXPECT_EQ(result.stop, InverseStop::kHeldByLimits) << Name(result.stop);
  EXPECT_EQ(result.q[0], 0.2);
  EXPECT_GT(result.error_m + result.error_rad, 1e-3);
}

TEST(NumericalInverse, RefusesANonFinitePoseOrSeed) {
  const SerialChain<7> chain(OffsetArm());
  Pose X_BF = chain.FlangePose(JointVectorN<7>::Constant(0.3));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(NumericalInverse<7>(chain, X_BF, JointVectorN<7>::Constant(nan)).stop, InverseStop::kNotFinite);
  X_BF.matrix()(1, 2) = nan;
  EXPECT_EQ(NumericalInverse<7>(chain, X_BF, JointVectorN<7>::Zero()).stop, InverseStop::kNotFinite);
}

TEST(NumericalInverse, EqualInputsGiveEqualBitsAndNothingIsAllocated) {
  const SerialChain<7> chain(OffsetArm());
  std::mt19937_64 random(14);
  const Pose X_BF = chain.FlangePose(RandomWithinLimits<7>(chain.params(), random));
  const JointVectorN<7> seed = RandomWithinLimits<7>(chain.params(), random);
  rt::CheckedNoAllocScope no_alloc;
  const auto once = NumericalInverse<7>(chain, X_BF, seed), again = NumericalInverse<7>(chain, X_BF, seed);
  no_alloc.End();
  EXPECT_EQ(once.q, again.q);
  EXPECT_EQ(once.iterations, again.iterations);
}

}  // namespace
}  // namespace osteon::kinematics
