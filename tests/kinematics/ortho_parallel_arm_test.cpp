#include "kinematics/ortho_parallel_arm.h"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include "kinematics/serial_chain.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/kr_arms.h"

// All eight postures of a pose, compared with the forward kinematics of the chain made of the same
// parameters, which ortho_parallel_params_test.cpp compares with KDL and a robot description.

namespace osteon::kinematics {
namespace {

using Joints = JointVectorN<6>;
constexpr double kPi = std::numbers::pi, kTurn = 2.0 * kPi;

double PoseError(const Pose& a, const Pose& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

// Largest difference of two postures, modulo full turns.
double JointDifference(const Joints& a, const Joints& b) {
  double worst = 0.0;
  for (int i = 0; i < 6; ++i) worst = std::max(worst, std::abs(std::remainder(a[i] - b[i], kTurn)));
  return worst;
}

// Random postures within the limits. Every tenth is 1e-6 to 1e-2 rad from a singularity: wrist straight,
// elbow straight, wrist above A1, all three.
class Postures {
 public:
  Postures(const OrthoParallelParams& params, std::uint64_t seed) : params_(params), random_(seed) {}

  Joints Next() {
    while (true) {
      Joints q;
      for (int i = 0; i < 6; ++i) {
        const JointLimits& limit = params_.limits[static_cast<std::size_t>(i)];
        q[i] = limit.lower_rad + (limit.upper_rad - limit.lower_rad) * unit_(random_);
      }
      if (count_++ % 10 != 0) return q;
      const int kind = count_ / 10 % 4;
      if (kind == 0 || kind == 3) SetTheta(q, 4, Small());
      if (kind == 1 || kind == 3) SetTheta(q, 2, Small() - std::atan2(params_.a2_m, params_.c3_m));
      if (kind == 2 || kind == 3) PutWristAboveA1(q);
      if (Within(q)) return q;
    }
  }

  // Uniform in -1 … 1.
  double Unit() { return 2.0 * unit_(random_) - 1.0; }
  // Either sign, with a log-uniform magnitude in 1e-6 … 1e-2.
  double Small() {
    const double size = std::pow(10.0, -6.0 + 4.0 * unit_(random_));
    return unit_(random_) < 0.5 ? -size : size;
  }

 private:
  void SetTheta(Joints& q, int i, double theta) const {
    const auto joint = static_cast<std::size_t>(i);
    q[i] = params_.sign[joint] * (theta + params_.offset_rad[joint]);
  }
  // solves a1 + c2 sin(theta2) + k sin(theta2 + gamma) = small for theta2
  void PutWristAboveA1(Joints& q) {
    const double gamma =
        params_.sign[2] * q[2] - params_.offset_rad[2] + std::atan2(params_.a2_m, params_.c3_m);
    const double k = std::hypot(params_.a2_m, params_.c3_m);
    const double sine = k * std::sin(gamma), cosine = params_.c2_m + k * std::cos(gamma);
    const double ratio = (Small() - params_.a1_m) / std::hypot(sine, cosine);
    if (std::abs(ratio) < 1.0) SetTheta(q, 1, std::asin(ratio) - std::atan2(sine, cosine));
  }
  [[nodiscard]] bool Within(const Joints& q) const {
    for (int i = 0; i < 6; ++i) {
      const JointLimits& limit = params_.limits[static_cast<std::size_t>(i)];
      if (q[i] < limit.lower_rad || q[i] > limit.upper_rad) return false;
    }
    return true;
  }

  OrthoParallelParams params_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
  int count_{0};
};

// Each solution gives the pose to 1e-13, and one solution is the posture that made the pose, to 1e-9 /
// sigma_min. A valid solution is within the limits; an invalid one has a joint of which no equivalent, full
// turns away, is within its limits.
void CheckSolutionsOfRandomPoses(const OrthoParallelParams& params, int poses) {
  const OrthoParallelArm arm(params);
  const SerialChain<6> chain(ChainFrom(params));
  Postures postures(params, 20240612);
  double worst_pose = 0.0, worst_joint = 0.0;
  int wrong_validity = 0, unreachable = 0, missing = 0;
  for (int n = 0; n < poses; ++n) {
    const Joints q = postures.Next();
    const Pose X_BF = chain.FlangePose(q);
    const OrthoParallelSolutions solutions = arm.Solve(X_BF);
    if (!solutions.reachable()) ++unreachable;
    for (const OrthoParallelSolution& solution : solutions.configuration) {
      if (!solution.exists) continue;
      worst_pose = std::max(worst_pose, PoseError(chain.FlangePose(solution.q), X_BF));
      bool within = true;
      for (int i = 0; i < 6; ++i) {
        const JointLimits& limit = params.limits[static_cast<std::size_t>(i)];
        const double q_i = solution.q[i];
        if (solution.valid()) {
          within = within && q_i >= limit.lower_rad && q_i <= limit.upper_rad;
        } else {
          bool any = false;
          for (const double equivalent : {q_i - kTurn, q_i, q_i + kTurn})
            any = any || (equivalent >= limit.lower_rad && equivalent <= limit.upper_rad);
          within = within && any;
        }
      }
      if (within != solution.valid()) ++wrong_validity;
    }
    const auto own = solutions.configuration[static_cast<std::size_t>(arm.Configuration(q))];
    if (!own.exists) ++missing;
    const double off = JointDifference(own.q, q);
    if (off > 1e-12) {
      const double sigma =
          Eigen::JacobiSVD<JacobianN<6>>(chain.Jacobian(chain.ComputePosture(q))).singularValues()[5];
      worst_joint = std::max(worst_joint, off * sigma);
    }
  }
  EXPECT_EQ(unreachable, 0);
  EXPECT_EQ(missing, 0);
  EXPECT_EQ(wrong_validity, 0);
  EXPECT_LT(worst_pose, 1e-13);
  EXPECT_LT(worst_joint, 1e-9);
}

TEST(OrthoParallelArm, SolutionsOfAKr6ReachThePoseAndIncludeThePostureThatMadeIt) {
  CheckSolutionsOfRandomPoses(Kr6R900Params(), 500'000);
}
TEST(OrthoParallelArm, SolutionsOfAKr16ReachThePoseAndIncludeThePostureThatMadeIt) {
  CheckSolutionsOfRandomPoses(Kr16Params(), 500'000);
}
TEST(OrthoParallelArm, SolutionsOfACrookedArmReachThePoseAndIncludeThePostureThatMadeIt) {
  CheckSolutionsOfRandomPoses(CrookedArmParams(), 20'000);
}

TEST(OrthoParallelArm, EachSolutionHasTheConfigurationOfItsIndex) {
  const OrthoParallelArm arm(Kr16Params());
  const SerialChain<6> chain(ChainFrom(Kr16Params()));
  Postures postures(Kr16Params(), 3);
  for (int n = 0; n < 1000; ++n) {
    const OrthoParallelSolutions solutions = arm.Solve(chain.FlangePose(postures.Next()));
    for (int k = 0; k < 8; ++k) {
      const OrthoParallelSolution& solution = solutions.configuration[static_cast<std::size_t>(k)];
      if (solution.exists) {
        EXPECT_EQ(arm.Configuration(solution.q), k);
      }
    }
  }
}

// A6 turns almost twice round: the inverse returns a value beyond half a turn if the seed has it.
TEST(OrthoParallelArm, InverseSeededWithAPostureReturnsThePosture) {
  for (const OrthoParallelParams& params : {Kr6R900Params(), Kr16Params()}) {
    const OrthoParallelArm arm(params);
    const SerialChain<6> chain(ChainFrom(params));
    Postures postures(params, 4);
    int beyond_half_a_turn = 0;
    for (int n = 0; n < 20'000; ++n) {
      const Joints q = postures.Next();
      if (std::abs(q[5]) > kPi) ++beyond_half_a_turn;
      Joints found;
      ASSERT_TRUE(arm.Inverse(chain.FlangePose(q), q, found)) << q.transpose();
      // 1e-2: rounding may cost this much if three singularities are within 1e-6 at once; a full turn is 600
      // times as much
      EXPECT_LT(PoseError(chain.FlangePose(found), chain.FlangePose(q)), 1e-13);
      EXPECT_LT((found - q).cwiseAbs().maxCoeff(), 1e-2) << q.transpose();
    }
    EXPECT_GT(beyond_half_a_turn, 5000);
  }
}

// Brute force over all equivalents, full turns apart, of every solution.
TEST(OrthoParallelArm, NearestIsTheNearestOfAllEquivalents) {
  const OrthoParallelParams params = Kr16Params();
  const OrthoParallelArm arm(params);
  const SerialChain<6> chain(ChainFrom(params));
  Postures postures(params, 5);
  for (int n = 0; n < 2000; ++n) {
    const Joints seed = postures.Next();
    const OrthoParallelSolutions solutions = arm.Solve(chain.FlangePose(postures.Next()));
    double least = std::numeric_limits<double>::infinity();
    for (const OrthoParallelSolution& solution : solutions.configuration) {
      if (!solution.exists) continue;
      double distance = 0.0;  // joints are independent: take the nearest equivalent of each joint
      for (int i = 0; i < 6; ++i) {
        const JointLimits& limit = params.limits[static_cast<std::size_t>(i)];
        double nearest = std::numeric_limits<double>::infinity();
        for (int turns = -2; turns <= 2; ++turns) {
          const double equivalent = solution.q[i] + kTurn * turns;
          if (equivalent >= limit.lower_rad && equivalent <= limit.upper_rad)
            nearest = std::min(nearest, std::abs(equivalent - seed[i]));
        }
        distance += nearest * nearest;
      }
      least = std::min(least, std::sqrt(distance));
    }
    Joints found = seed;
    const bool any = arm.Nearest(solutions, seed, found);
    ASSERT_EQ(any, std::isfinite(least));
    if (any) {
      EXPECT_NEAR((found - seed).norm(), least, 1e-12);
      for (int i = 0; i < 6; ++i) {
        EXPECT_GE(found[i], params.limits[static_cast<std::size_t>(i)].lower_rad);
        EXPECT_LE(found[i], params.limits[static_cast<std::size_t>(i)].upper_rad);
      }
    }
  }
}

// The wrist lies outside the torus that the two links sweep, or in the torus's hole, by a known distance. The
// hole is out of reach only if A2 is on A1's axis (a1 = 0). Otherwise the arm reaches the hole with A1 turned
// by half a turn.
TEST(OrthoParallelArm, ReportsTheDistanceOutOfReach) {
  OrthoParallelParams params = Kr6R900Params();
  Postures postures(params, 6);
  const double k = std::hypot(params.a2_m, params.c3_m);
  for (const double a1_m : {0.025, 0.0}) {
    params.a1_m = a1_m;
    const OrthoParallelArm arm(params);
    for (int n = 0; n < 500; ++n) {
      // direction from A2 to the wrist: forwards, in the vertical plane of a random A1
      const double azimuth = kPi * postures.Unit(), elevation = 0.5 * kPi * postures.Unit();
      Pose X_BF = Pose(Eigen::AngleAxisd(kPi * postures.Unit(), Vector3(1, 2, 3).normalized()));
      const auto place = [&](double reach_m) {
        const double x = a1_m + reach_m * std::cos(elevation),
                     z = params.c1_m + reach_m * std::sin(elevation);
        X_BF.translation() =
            Vector3(x * std::cos(azimuth), x * std::sin(azimuth), z) + params.c4_m * X_BF.linear().col(2);
        return arm.Solve(X_BF);
      };
      const double by_m = std::abs(postures.Small());
      const OrthoParallelSolutions far = place(params.c2_m + k + by_m);
      EXPECT_NEAR(far.out_of_reach_m, by_m, 1e-15);
      for (const OrthoParallelSolution& solution : far.configuration) EXPECT_FALSE(solution.valid());
      EXPECT_TRUE(place(params.c2_m + k - by_m).reachable());
      EXPECT_TRUE(place(params.c2_m - k + by_m).reachable());
      if (a1_m == 0.0) {
        EXPECT_NEAR(place(params.c2_m - k - by_m).out_of_reach_m, -by_m, 1e-15);
      }
    }
  }
}

TEST(OrthoParallelArm, AnArmPlaneBesideA1DoesNotReachPointsNearA1) {
  const OrthoParallelParams params = CrookedArmParams();
  const OrthoParallelArm arm(params);
  Pose X_BF = Pose::Identity();
  X_BF.translation() = Vector3(0.0, params.b_m - 0.01, params.c1_m + 0.9 + params.c4_m);
  EXPECT_NEAR(arm.Solve(X_BF).out_of_reach_m, -0.01, 1e-15);
  X_BF.translation().y() = params.b_m + 0.01;
  EXPECT_TRUE(arm.Solve(X_BF).reachable());
}

TEST(OrthoParallelArm, NonFinitePoseOrSeedIsNotReachable) {
  const OrthoParallelArm arm(Kr6R900Params());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Pose X_BF = SerialChain<6>(ChainFrom(Kr6R900Params())).FlangePose(Joints::Constant(0.3));
  Joints q = Joints::Constant(42.0);
  for (int element = 0; element < 12; ++element) {
    Pose broken = X_BF;
    broken.matrix()(element % 3, element / 3) = nan;
    EXPECT_TRUE(std::isnan(arm.Solve(broken).out_of_reach_m)) << element;
    EXPECT_FALSE(arm.Inverse(broken, Joints::Zero(), q));
  }
  EXPECT_FALSE(arm.Inverse(X_BF, Joints::Constant(nan), q));
  EXPECT_EQ(q, Joints::Constant(42.0));
}

// Exactly singular postures: with the posture as the seed, Inverse returns it; every seed gives the pose, to
// 2e-12, because a posture within 1e-12 counts as singular. A straight elbow is found only to 2e-7, the
// square root of the reach's rounding.
TEST(OrthoParallelArm, SolvesSingularPosturesWithEverySeed) {
  OrthoParallelParams params = Kr16Params();
  const OrthoParallelArm arm(params);
  const SerialChain<6> chain(ChainFrom(params));
  Postures postures(params, 7);
  int elbow = 0;
  for (int n = 0; n < 6000; ++n) {
    Joints q;
    do q = postures.Next();
    while (std::abs(q[4]) < 0.05 || std::abs(std::sin(q[2] + std::atan2(params.a2_m, params.c3_m))) < 0.05 ||
           std::abs(std::hypot((chain.FlangePose(q) * Vector3(0, 0, -params.c4_m)).x(),
                               (chain.FlangePose(q) * Vector3(0, 0, -params.c4_m)).y())) < 0.05);
    const bool straight_elbow = n % 3 == 1;
    if (n % 3 != 1) q[4] = 0.0;
    if (straight_elbow) q[2] = -std::atan2(params.a2_m, params.c3_m), ++elbow;
    if (n % 3 == 2) {  // wrist above A1, to rounding
      const double gamma = q[2] + std::atan2(params.a2_m, params.c3_m),
                   k = std::hypot(params.a2_m, params.c3_m);
      const double sine = k * std::sin(gamma), cosine = params.c2_m + k * std::cos(gamma);
      const double ratio = -params.a1_m / std::hypot(sine, cosine);
      if (!(std::abs(ratio) < 0.95)) continue;
      q[1] = std::asin(ratio) - std::atan2(sine, cosine) - 0.5 * kPi;
      if (q[1] < params.limits[1].lower_rad || q[1] > params.limits[1].upper_rad) continue;
    }
    const Pose X_BF = chain.FlangePose(q);
    Joints found;
    ASSERT_TRUE(arm.Inverse(X_BF, q, found)) << q.transpose();
    EXPECT_LT((found - q).cwiseAbs().maxCoeff(), straight_elbow ? 2e-7 : 1e-9)
        << q.transpose() << " became " << found.transpose();
    for (const OrthoParallelSolution& solution : arm.Solve(X_BF, postures.Next()).configuration)
      if (solution.exists) {
        EXPECT_LT(PoseError(chain.FlangePose(solution.q), X_BF), 2e-12) << q.transpose();
      }
  }
  EXPECT_EQ(elbow, 2000);
}

TEST(OrthoParallelArm, ReportsTheJointBeyondItsLimitAndByHowMuch) {
  const Joints q = (Joints() << 0.3, -1.2, 0.9, -0.4, 0.5, 0.9).finished();
  const SerialChain<6> chain(ChainFrom(Kr6R900Params()));
  for (int i = 0; i < 6; ++i) {
    OrthoParallelParams tight = Kr6R900Params();
    JointLimits& limit = tight.limits[static_cast<std::size_t>(i)];
    limit.lower_rad = std::max(limit.lower_rad, -2.9);  // then no equivalent angle is within the limits
    limit.upper_rad = q[i] - 0.05;
    const OrthoParallelArm arm(tight);
    const OrthoParallelSolution own =
        arm.Solve(chain.FlangePose(q)).configuration[static_cast<std::size_t>(arm.Configuration(q))];
    EXPECT_FALSE(own.valid());
    EXPECT_EQ(own.worst_joint, i);
    EXPECT_EQ(own.beyond, 1u << i);
    EXPECT_NEAR(own.beyond_rad, 0.05, 1e-12);
  }
}

TEST(OrthoParallelArm, RefusesInvalidParameters) {
  const auto message = [](const OrthoParallelParams& params) -> std::string {
    try {
      OrthoParallelArm{params};
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(Kr6R900Params()), "");
  EXPECT_NE(message(OrthoParallelParams{}).find("c2_m"), std::string::npos);
  OrthoParallelParams params = Kr6R900Params();
  params.sign[3] = 0.5;
  EXPECT_NE(message(params).find("sign of A4: found 0.5"), std::string::npos);
  params = Kr6R900Params();
  params.limits[5].upper_rad = 7.0;
  EXPECT_NE(message(params).find("upper position limit of A6"), std::string::npos);
}

TEST(OrthoParallelArm, DoesNotAllocate) {
  const OrthoParallelArm arm(Kr6R900Params());
  const Joints q = (Joints() << 0.3, -1.2, 0.9, -0.4, 0.5, 0.9).finished();
  const Pose X_BF = SerialChain<6>(ChainFrom(Kr6R900Params())).FlangePose(q);
  Joints found;
  rt::CheckedNoAllocScope no_alloc;
  const bool reached = arm.Inverse(X_BF, q, found);
  no_alloc.End();
  EXPECT_TRUE(reached);
}

}  // namespace
}  // namespace osteon::kinematics
