#include "kinematics/lbr_arm.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::kinematics {
namespace {

constexpr int kPostures = 10'000;

// The iiwa 14 as in robot descriptions: a joint's origin in the frame of the previous joint, and its axis.
// This description is independent of LbrArm's four lengths: the joints' origins are at other places on the
// axes, and only their sums along the chain equal these lengths.
KDL::Chain DescribedArm() {
  struct Row {
    double y, z;
    KDL::Vector axis;
  };
  const KDL::Vector z(0, 0, 1), y(0, 1, 0);
  const std::array<Row, 7> rows{{{0, .1475, z},
                                 {-.010, .2125, y},
                                 {.010, .228, z},
                                 {.0105, .192, -y},
                                 {-.0105, .2075, z},
                                 {-.0707, .1925, y},
                                 {.0707, .091, z}}};
  KDL::Chain chain;
  for (const Row& row : rows) {
    const KDL::Vector origin(0, row.y, row.z);
    chain.addSegment(KDL::Segment(KDL::Joint(origin, row.axis, KDL::Joint::RotAxis), KDL::Frame(origin)));
  }
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), KDL::Frame(KDL::Vector(0, 0, .035))));
  return chain;
}

class LbrArmTest : public ::testing::Test {
 protected:
  JointVector RandomPosture() {
    JointVector q;
    for (int i = 0; i < 7; ++i)
      q[i] = unit_(random_) * arm_.params().limits[static_cast<std::size_t>(i)].upper_rad;
    return q;
  }

  // A random posture with A2, A4 and A6 bent and the wrist not above the shoulder, so that the inverse is
  // well conditioned.
  JointVector RegularPosture() {
    while (true) {
      const JointVector q = RandomPosture();
      const Pose X_BF = arm_.FlangePose(q);
      const Vector3 p_W = X_BF * Vector3(0, 0, -arm_.params().wrist_to_flange_m);
      const bool bent = std::abs(q[1]) > 0.05 && std::abs(q[3]) > 0.05 && std::abs(q[5]) > 0.05;
      if (bent && std::hypot(p_W.x(), p_W.y()) > 0.02) return q;
    }
  }

  const LbrArm arm_{Iiwa14()};
  std::mt19937_64 random_{20240607};
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

// 1e-12: some thirty products of numbers around 1, each rounded to 1e-16, with a margin.
TEST_F(LbrArmTest, PoseAndJacobianEqualThoseOfTheDescribedChain) {
  const KDL::Chain chain = DescribedArm();
  KDL::ChainFkSolverPos_recursive forward(chain);
  KDL::ChainJntToJacSolver velocity(chain);
  KDL::JntArray joints(7);
  KDL::Jacobian J_kdl(7);
  double worst_pose = 0.0, worst_jacobian = 0.0;
  for (int n = 0; n < kPostures; ++n) {
    const JointVector q = RandomPosture();
    joints.data = q;
    KDL::Frame frame;
    ASSERT_EQ(forward.JntToCart(joints, frame), 0);
    ASSERT_EQ(velocity.JntToJac(joints, J_kdl), 0);
    const Pose X_BF = arm_.FlangePose(q);
    for (int i = 0; i < 3; ++i) {
      worst_pose = std::max(worst_pose, std::abs(X_BF.translation()[i] - frame.p(i)));
      for (int j = 0; j < 3; ++j)
        worst_pose = std::max(worst_pose, std::abs(X_BF.linear()(i, j) - frame.M(i, j)));
    }
    worst_jacobian =
        std::max(worst_jacobian, (arm_.JacobianAt(q, Vector3::Zero()) - J_kdl.data).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst_pose, 1e-12);
  EXPECT_LT(worst_jacobian, 1e-12);
}

TEST_F(LbrArmTest, ZeroPostureStandsUprightAtTheCatalogueHeight) {
  const Pose X_BF = arm_.FlangePose(JointVector::Zero());
  EXPECT_NEAR(X_BF.translation().z(), 1.306, 1e-15);
  EXPECT_TRUE(X_BF.linear().isIdentity(1e-15));
}

// Central differences with h = 1e-5: truncation h^2/6 times third derivatives of about 1 m, rounding 1e-16/h;
// both < 1e-10.
TEST_F(LbrArmTest, JacobianIsTheDerivativeOfThePose) {
  const double h = 1e-5;
  for (int n = 0; n < 200; ++n) {
    const JointVector q = RandomPosture();
    const Jacobian J = arm_.JacobianAt(q, Vector3::Zero());
    for (int i = 0; i < 7; ++i) {
      JointVector before = q, after = q;
      before[i] -= h;
      after[i] += h;
      const Pose X_0 = arm_.FlangePose(before), X_1 = arm_.FlangePose(after);
      const Vector3 v = (X_1.translation() - X_0.translation()) / (2.0 * h);
      const Matrix3 spin =
          (X_1.linear() - X_0.linear()) / (2.0 * h) * arm_.FlangePose(q).linear().transpose();
      const Vector3 w(spin(2, 1), spin(0, 2), spin(1, 0));
      EXPECT_LT((J.col(i).head<3>() - v).norm(), 1e-9);
      EXPECT_LT((J.col(i).tail<3>() - w).norm(), 1e-9);
    }
  }
}

// The tolerance is 1e-10, because an elbow bent by 0.05 rad amplifies the rounding of the reach 20 times, and
// the wrist does the same.
TEST_F(LbrArmTest, InverseUndoesForward) {
  for (int n = 0; n < kPostures; ++n) {
    const JointVector q = RegularPosture();
    const Pose X_BF = arm_.FlangePose(q);
    JointVector found = JointVector::Zero();
    ASSERT_TRUE(arm_.Inverse(X_BF, arm_.ArmAngle(q), q, found)) << q.transpose();
    EXPECT_LT((found - q).cwiseAbs().maxCoeff(), 1e-10) << q.transpose();
    EXPECT_LT((arm_.FlangePose(found).matrix() - X_BF.matrix()).cwiseAbs().maxCoeff(), 1e-10)
        << q.transpose();
  }
}

// With a random seed, another of the eight solutions may be nearer: it must give the same pose and arm angle.
TEST_F(LbrArmTest, InverseFromAnySeedGivesThePoseAndTheArmAngle) {
  int other_configuration = 0;
  for (int n = 0; n < kPostures; ++n) {
    const JointVector q = RegularPosture(), seed = RandomPosture();
    const Pose X_BF = arm_.FlangePose(q);
    const double angle = arm_.ArmAngle(q);
    JointVector found;
    ASSERT_TRUE(arm_.Inverse(X_BF, angle, seed, found));
    EXPECT_LT((arm_.FlangePose(found).matrix() - X_BF.matrix()).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT(std::abs(std::remainder(arm_.ArmAngle(found) - angle, 2.0 * std::numbers::pi)), 1e-9);
    for (int i = 0; i < 7; ++i)
      EXPECT_LE(std::abs(found[i]), arm_.params().limits[static_cast<std::size_t>(i)].upper_rad);
    EXPECT_LE((found - seed).norm(), (q - seed).norm() + 1e-9) << "q is a solution: none farther may win";
    if ((found - q).norm() > 0.1) ++other_configuration;
  }
  EXPECT_GT(other_configuration, kPostures / 10);
}

// The eight solutions follow from one: if a bending joint (A2, A4 or A6) changes its sign and its two
// neighbours turn by pi, every link stays in place.
TEST_F(LbrArmTest, InverseFindsAllEightConfigurations) {
  LbrParams params = Iiwa14();
  for (JointLimits& limit : params.limits) limit = {};  // ± pi
  const LbrArm arm(params);
  const JointVector q = (JointVector() << 0.3, 0.7, -0.4, -1.2, 0.5, 0.9, -0.2).finished();
  const Pose X_BF = arm.FlangePose(q);
  for (int mask = 0; mask < 8; ++mask) {
    JointVector flipped = q;
    for (int bit = 0; bit < 3; ++bit) {
      if ((mask >> bit & 1) == 0) continue;
      const int bent = 1 + 2 * bit;
      flipped[bent] = -flipped[bent];
      for (const int turning : {bent - 1, bent + 1})
        flipped[turning] = std::remainder(flipped[turning] + std::numbers::pi, 2.0 * std::numbers::pi);
    }
    JointVector found;
    ASSERT_TRUE(arm.Inverse(X_BF, arm.ArmAngle(q), flipped, found));
    EXPECT_LT((found - flipped).cwiseAbs().maxCoeff(), 1e-12) << "configuration " << mask;
  }
}

TEST_F(LbrArmTest, ArmAngleIsZeroWithTheElbowUpAndPiWithTheElbowHanging) {
  const JointVector up = (JointVector() << 0.4, 0.5, 0.0, -1.4, 0.0, 0.6, 0.0).finished();
  EXPECT_NEAR(arm_.ArmAngle(up), 0.0, 1e-14);
  const JointVector hanging = (JointVector() << 0.4, 1.7, 0.0, 1.0, 0.0, 0.6, 0.0).finished();
  EXPECT_NEAR(std::abs(arm_.ArmAngle(hanging)), std::numbers::pi, 1e-14);
  EXPECT_EQ(arm_.ArmAngle(JointVector::Zero()), 0.0);
}

// The elbow moves on a circle. A change of the arm angle must turn the line from shoulder to elbow about the
// line from shoulder to wrist by the same angle.
TEST_F(LbrArmTest, ArmAngleTurnsTheElbowRightHandedAboutTheShoulderWristLine) {
  const LbrParams& params = arm_.params();
  // Shoulder to elbow, in B [m].
  const auto elbow = [&](const JointVector& q) {
    return Vector3(params.shoulder_to_elbow_m *
                   Vector3(std::cos(q[0]) * std::sin(q[1]), std::sin(q[0]) * std::sin(q[1]), std::cos(q[1])));
  };
  const JointVector q = (JointVector() << 0.2, 0.6, 0.1, -1.3, 0.3, 0.8, 0.1).finished();
  const Pose X_BF = arm_.FlangePose(q);
  const Vector3 p_SW =
      X_BF * Vector3(0, 0, -params.wrist_to_flange_m) - Vector3(0, 0, params.base_to_shoulder_m);
  for (const double turn : {-1.0, -0.3, 0.2, 0.8}) {
    JointVector found;
    ASSERT_TRUE(arm_.Inverse(X_BF, arm_.ArmAngle(q) + turn, q, found));
    const Vector3 expected = Eigen::AngleAxisd(turn, p_SW.normalized()) * elbow(q);
    EXPECT_LT((elbow(found) - expected).norm(), 1e-12);
  }
}

TEST_F(LbrArmTest, UnreachablePoseIsRefusedAndLeavesTheJointsUnchanged) {
  const JointVector seed = (JointVector() << 0, 0.5, 0, -1.4, 0, 1.2, 0).finished();
  const JointVector untouched = JointVector::Constant(42.0);
  Pose far = arm_.FlangePose(seed), near = far, broken = far;
  far.translation() = Vector3(1.2, 0, 0.4);
  near.translation() = Vector3(0, 0, arm_.params().base_to_shoulder_m) +
                       arm_.params().wrist_to_flange_m * near.linear().col(2);
  broken.translation().y() = std::numeric_limits<double>::quiet_NaN();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Pose& X_BF : {far, near, broken}) {
    JointVector q = untouched;
    EXPECT_FALSE(arm_.Inverse(X_BF, 0.0, seed, q));
    EXPECT_EQ(q, untouched);
  }
  JointVector q = untouched;
  EXPECT_FALSE(arm_.Inverse(arm_.FlangePose(seed), nan, seed, q));
  EXPECT_FALSE(arm_.Inverse(arm_.FlangePose(seed), 0.0, JointVector::Constant(nan), q));
  EXPECT_EQ(q, untouched);
}

TEST_F(LbrArmTest, InverseNeverReturnsAPostureBeyondALimit) {
  const JointVector q = (JointVector() << 2.0, 0.7, -1.8, -1.2, 2.1, 0.9, -1.9).finished();
  const Pose X_BF = arm_.FlangePose(q);
  for (int i = 0; i < 7; ++i) {
    LbrParams tight = Iiwa14();
    JointLimits& limit = tight.limits[static_cast<std::size_t>(i)];
    limit.upper_rad = std::abs(q[i]) - 1e-6;
    limit.lower_rad = -limit.upper_rad;
    const LbrArm arm(tight);
    JointVector found = q;
    // a bending joint (A2, A4, A6) has the same magnitude in all eight solutions; a turning joint beyond 90
    // deg has a smaller angle in another solution
    const bool bent = i == 1 || i == 3 || i == 5;
    EXPECT_EQ(arm.Inverse(X_BF, arm_.ArmAngle(q), q, found), !bent) << "joint " << i + 1;
    if (!bent) {
      EXPECT_LE(std::abs(found[i]), limit.upper_rad);
      EXPECT_LT((arm.FlangePose(found).matrix() - X_BF.matrix()).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

// In a singular posture one joint is free: it keeps its position, and the pose is still exact.
TEST_F(LbrArmTest, SingularPosturesKeepTheFreeJoint) {
  const auto posture = [](double q2, double q4, double q6) {
    return (JointVector() << 0.2, q2, 0.3, q4, -0.4, q6, 0.1).finished();
  };
  for (const JointVector& q : {posture(0.0, 0.0, 0.0), posture(0.7, 0.0, 0.5), posture(0.7, -1.0, 0.0),
                               posture(0.0, -1.0, 0.5), posture(0.0, 0.0, 0.5)}) {
    JointVector found;
    ASSERT_TRUE(arm_.Inverse(arm_.FlangePose(q), arm_.ArmAngle(q), q, found)) << q.transpose();
    EXPECT_LT((arm_.FlangePose(found).matrix() - arm_.FlangePose(q).matrix()).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT((found - q).cwiseAbs().maxCoeff(), 1e-6) << q.transpose() << " became " << found.transpose();
  }
}

TEST_F(LbrArmTest, DoesNotAllocate) {
  const JointVector q = RegularPosture();
  JointVector found = q;
  rt::CheckedNoAllocScope no_alloc;
  const bool reached = arm_.Inverse(arm_.FlangePose(q), arm_.ArmAngle(q), q, found);
  const Jacobian J = arm_.JacobianAt(found, Vector3::Zero());
  no_alloc.End();
  EXPECT_TRUE(reached && J.allFinite());
}

}  // namespace
}  // namespace osteon::kinematics
