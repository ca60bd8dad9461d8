#include "kinematics/serial_chain.h"

#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/chain_samples.h"
#include "tests/oracles/jacobian_dot.h"

namespace osteon::kinematics {
namespace {

constexpr int kPostures = 100'000;
// some hundred products of numbers around 1, each rounded to 1e-16, with a margin
constexpr double kRounding = 1e-12;

// Largest difference of an element of the position [m] or the rotation matrix.
double Difference(const Pose& X, const KDL::Frame& frame) {
  double worst = 0.0;
  for (int i = 0; i < 3; ++i) {
    worst = std::max(worst, std::abs(X.translation()[i] - frame.p(i)));
    for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(X.linear()(i, j) - frame.M(i, j)));
  }
  return worst;
}

// Largest differences of flange pose, link poses and Jacobian from KDL's over random postures.
struct LargestDifferences {
  double pose{0.0}, link{0.0}, jacobian{0.0};
};

template <int N>
LargestDifferences CompareWithKdl(const ChainParams<N>& params, int postures, std::mt19937_64& random) {
  const SerialChain<N> arm(params);
  const KDL::Chain chain = KdlChain(params);
  KDL::ChainFkSolverPos_recursive forward(chain);
  KDL::ChainJntToJacSolver velocity(chain);
  KDL::JntArray joints(N);
  KDL::Jacobian J_kdl(N);
  LargestDifferences worst;
  for (int n = 0; n < postures; ++n) {
    const JointVectorN<N> q = RandomJoints<N>(random, std::numbers::pi);
    joints.data = q;
    KDL::Frame frame;
    EXPECT_EQ(forward.JntToCart(joints, frame), 0);
    EXPECT_EQ(velocity.JntToJac(joints, J_kdl), 0);
    const auto posture = arm.ComputePosture(q);
    worst.pose =
        std::max({worst.pose, Difference(posture.X_BF, frame), Difference(arm.FlangePose(q), frame)});
    worst.jacobian = std::max(worst.jacobian, (arm.Jacobian(posture) - J_kdl.data).cwiseAbs().maxCoeff());
    const int link = n % N;
    EXPECT_EQ(forward.JntToCart(joints, frame, link + 1), 0);
    worst.link = std::max(worst.link, Difference(arm.LinkPose(posture, link), frame));
  }
  return worst;
}

TEST(SerialChain, IiwaPoseAndJacobianEqualThoseOfKdl) {
  std::mt19937_64 random{20261120};
  const LargestDifferences worst = CompareWithKdl(Iiwa14Chain(), kPostures, random);
  EXPECT_LT(worst.pose, kRounding);
  EXPECT_LT(worst.link, kRounding);
  EXPECT_LT(worst.jacobian, kRounding);
}

TEST(SerialChain, KrPoseAndJacobianEqualThoseOfKdl) {
  std::mt19937_64 random{6};
  const LargestDifferences worst = CompareWithKdl(Kr6R900(), kPostures / 4, random);
  EXPECT_LT(worst.pose, kRounding);
  EXPECT_LT(worst.link, kRounding);
  EXPECT_LT(worst.jacobian, kRounding);
}

TEST(SerialChain, AnyArmsPoseAndJacobianEqualThoseOfKdl) {
  std::mt19937_64 random{7};
  LargestDifferences worst;
  for (int n = 0; n < 200; ++n)
    for (const LargestDifferences& one : {CompareWithKdl(RandomChain<7>(random), 40, random),
                                          CompareWithKdl(RandomChain<6>(random), 40, random)})
      worst = {std::max(worst.pose, one.pose), std::max(worst.link, one.link),
               std::max(worst.jacobian, one.jacobian)};
  EXPECT_LT(worst.pose, kRounding);
  EXPECT_LT(worst.link, kRounding);
  EXPECT_LT(worst.jacobian, kRounding);
}

// Neighbouring axes are parallel, opposite, or deviate from this by smaller and smaller angles. The common
// normal that defines a frame's x then becomes undefined, but this must not affect the results.
TEST(SerialChain, AlmostParallelAxesLoseNoAccuracy) {
  std::mt19937_64 random{8};
  for (const double tilt : {0.0, 1e-16, 1e-13, 1e-9, 1e-5, 1e-2})
    for (const double sign : {1.0, -1.0}) {
      ChainParams<6> params = RandomChain<6>(random);
      for (RevoluteJoint& joint : params.joints) {
        joint.X_PJ.linear().setIdentity();
        joint.axis_J = sign * Vector3(tilt, -0.5 * tilt, 1.0).normalized();
      }
      params.joints[2].axis_J = Vector3(0, tilt, 1).normalized();
      const LargestDifferences worst = CompareWithKdl(params, 200, random);
      EXPECT_LT(std::max({worst.pose, worst.link, worst.jacobian}), kRounding) << tilt << ' ' << sign;
    }
}

TEST(SerialChain, IiwaStandsUprightAtTheCatalogueHeight) {
  const Pose X_BF = SerialChain<7>(Iiwa14Chain()).FlangePose(JointVectorN<7>::Zero());
  EXPECT_NEAR(X_BF.translation().z(), 1.306, 1e-15);
  EXPECT_TRUE(X_BF.linear().isIdentity(1e-15));
}

// The velocity of any point of the flange is that of the flange's origin plus that of the rotation about the
// origin.
TEST(SerialChain, JacobianOfAPointFollowsFromTheFlangesJacobian) {
  std::mt19937_64 random{9};
  const SerialChain<7> arm(RandomChain<7>(random));
  for (int n = 0; n < 100; ++n) {
    const auto posture = arm.ComputePosture(RandomJoints<7>(random, 3.0));
    const Vector3 p_FP(0.1, -0.3, 0.2), p_B = posture.X_BF * p_FP;
    JacobianN<7> expected = arm.Jacobian(posture);
    for (int i = 0; i < 7; ++i) {
      const Vector3 w = expected.col(i).tail<3>();
      expected.col(i).head<3>() += w.cross(posture.X_BF.linear() * p_FP);
    }
    EXPECT_LT((arm.JacobianAt(posture, p_B) - expected).cwiseAbs().maxCoeff(), 1e-14);
  }
}

// Tests JacobianDot, an oracle of chain_dynamics_test.cpp, by central differences along qd with h = 1e-5 s:
// truncation h^2/6 times third derivatives of 100 (up to 2 rad/s, seven joints); rounding 1e-16/h; both below
// 1e-8.
template <int N>
double JacobianDotError(const ChainParams<N>& params, std::mt19937_64& random) {
  const SerialChain<N> arm(params);
  const double h = 1e-5;
  double worst = 0.0;
  for (int n = 0; n < 300; ++n) {
    const JointVectorN<N> q = RandomJoints<N>(random, 3.0), qd = RandomJoints<N>(random, 2.0);
    const Vector3 p_FP = n % 2 == 0 ? Vector3(0, 0, 0) : Vector3(0.1, 0.05, -0.2);
    const auto at = [&](double t) {
      const auto posture = arm.ComputePosture(q + t * qd);
      return arm.JacobianAt(posture, posture.X_BF * p_FP);
    };
    const JacobianN<N> expected = (at(h) - at(-h)) / (2.0 * h);
    const auto posture = arm.ComputePosture(q);
    const JacobianN<N> J_dot = JacobianDot<N>(posture, qd, posture.X_BF * p_FP);
    worst = std::max(worst, (J_dot - expected).cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(SerialChain, JacobianDotIsTheDerivativeOfTheJacobian) {
  std::mt19937_64 random{10};
  EXPECT_LT(JacobianDotError(Iiwa14Chain(), random), 1e-8);
  EXPECT_LT(JacobianDotError(Kr6R900(), random), 1e-8);
  EXPECT_LT(JacobianDotError(RandomChain<6>(random), random), 1e-8);
}

TEST(SerialChain, EqualJointsGiveEqualBits) {
  std::mt19937_64 random{11};
  const ChainParams<7> params = RandomChain<7>(random);
  const SerialChain<7> arm(params), twin(params);
  for (int n = 0; n < 100; ++n) {
    const JointVectorN<7> q = RandomJoints<7>(random, 3.0);
    EXPECT_EQ(arm.FlangePose(q).matrix(), twin.ComputePosture(q).X_BF.matrix());
    EXPECT_EQ(arm.Jacobian(arm.ComputePosture(q)), twin.Jacobian(twin.ComputePosture(q)));
  }
}

TEST(SerialChain, RefusesAnInvalidChainAndNamesJointAndQuantity) {
  struct Case {
    const char* text;
    void (*spoil)(ChainParams<7>&);
  };
  const Case cases[] = {
      {"joint 3: length of its axis: found 2, accepted 1",
       [](ChainParams<7>& c) { c.joints[2].axis_J = Vector3(0, 0, 2); }},
      {"joint 1: rotation: found", [](ChainParams<7>& c) { c.joints[0].X_PJ.linear()(0, 0) = 1.1; }},
      {"joint 1: rotation: found", [](ChainParams<7>& c) { c.joints[0].X_PJ.linear() *= -1.0; }},
      {"joint 5: position: found", [](ChainParams<7>& c) { c.joints[4].X_PJ.translation().x() = NAN; }},
      {"joint 2: upper limit [rad]: found -3", [](ChainParams<7>& c) { c.joints[1].limits.upper_rad = -3; }},
      {"joint 4: velocity limit [rad/s]: found -1",
       [](ChainParams<7>& c) { c.joints[3].limits.velocity_rad_per_s = -1; }},
      {"joint 6: mass [kg]: found -1", [](ChainParams<7>& c) { c.joints[5].link.mass_kg = -1; }},
      {"joint 6: inertia [kg m^2]: found",
       [](ChainParams<7>& c) { c.joints[5].link.I_LLcm_kg_m2(0, 1) += 0.01; }},
      {"joint 6: principal moments of inertia",
       [](ChainParams<7>& c) { c.joints[5].link.I_LLcm_kg_m2 = Vector3(1, 1, 3).asDiagonal(); }},
      {"joint 7: smoothing of its friction [rad/s]: found 0",
       [](ChainParams<7>& c) { c.joints[6].friction.smoothing_rad_per_s = 0; }},
      {"flange: position: found", [](ChainParams<7>& c) { c.X_LF.translation().z() = INFINITY; }},
  };
  for (const Case& one : cases) {
    ChainParams<7> params = Iiwa14Chain();
    one.spoil(params);
    try {
      const SerialChain<7> arm(params);
      ADD_FAILURE() << "accepted: " << one.text;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).rfind(one.text, 0), 0U) << error.what();
    }
  }
}

TEST(SerialChain, DoesNotAllocate) {
  std::mt19937_64 random{12};
  const SerialChain<7> arm(Iiwa14Chain());
  const JointVectorN<7> q = RandomJoints<7>(random, 2.0);
  SerialChain<7>::Posture posture;
  JacobianN<7> J;
  rt::CheckedNoAllocScope no_alloc;
  arm.ComputePosture(q, posture);
  arm.Jacobian(posture, J);
  J += arm.JacobianAt(posture, Vector3(1, 2, 3));
  const double sum = J.sum() + arm.FlangePose(q).matrix().sum() + arm.LinkPose(posture, 3).matrix().sum();
  no_alloc.End();
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace osteon::kinematics
