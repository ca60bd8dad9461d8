#include <numbers>

#include <gtest/gtest.h>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

#include "control/rt/no_alloc_scope.h"
#include "kinematics/serial_chain.h"
#include "tests/kinematics/chain_samples.h"

namespace osteon::kinematics {
namespace {

constexpr double kRelative = 1e-9;  // of the largest torque: asked for; rounding gives 1e-13

// The worst share by which torques differ from KDL's over random states, with a wrench on the flange in every
// other.
template <int N>
double InverseDynamicsError(const ChainParams<N>& params, int states, std::mt19937_64& random) {
  const Vector3 gravity_B(1.0, -2.0, -9.0);  // of an arm that is mounted askew
  const SerialChain<N> arm(params, gravity_B);
  const KDL::Chain chain = KdlChain(params);
  KDL::ChainIdSolver_RNE inverse(chain, KDL::Vector(gravity_B.x(), gravity_B.y(), gravity_B.z()));
  KDL::JntArray q(N), qd(N), qdd(N), tau(N);
  double worst = 0.0;
  for (int n = 0; n < states; ++n) {
    q.data = RandomJoints<N>(random, std::numbers::pi);
    qd.data = RandomJoints<N>(random, 3.0);
    qdd.data = RandomJoints<N>(random, 10.0);
    Wrench F;
    if (n % 2 == 1)
      F = {.f = RandomJoints<6>(random, 200.0).head<3>(), .t = RandomJoints<6>(random, 20.0).head<3>()};
    // KDL wants each segment's wrench in the segment's frame
    const Matrix3 R_BF = arm.FlangePose(q.data).linear();
    const Vector3 f = R_BF.transpose() * F.f, t = R_BF.transpose() * F.t;
    KDL::Wrenches wrenches(chain.getNrOfSegments(), KDL::Wrench::Zero());
    wrenches.back() = KDL::Wrench(KDL::Vector(f.x(), f.y(), f.z()), KDL::Vector(t.x(), t.y(), t.z()));
    EXPECT_EQ(inverse.CartToJnt(q, qd, qdd, wrenches, tau), 0);
    const JointVectorN<N> found = n % 2 == 1 ? arm.InverseDynamics(q.data, qd.data, qdd.data, F)
                                             : arm.InverseDynamics(q.data, qd.data, qdd.data);
    worst = std::max(worst, (found - tau.data).cwiseAbs().maxCoeff() / tau.data.cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(ChainDynamics, InverseDynamicsEqualsKdl) {
  std::mt19937_64 random{21};
  EXPECT_LT(InverseDynamicsError(Iiwa14(), 20'000, random), kRelative);
  for (int n = 0; n < 20; ++n) {
    EXPECT_LT(InverseDynamicsError(RandomChain<6>(random), 100, random), kRelative);
    EXPECT_LT(InverseDynamicsError(RandomChain<7>(random), 100, random), kRelative);
  }
}

template <int N>
double GravityCoriolisError(const ChainParams<N>& params, int states, std::mt19937_64& random) {
  const SerialChain<N> arm(params);
  const KDL::Chain chain = KdlChain(params);
  KDL::ChainDynParam dynamics(chain, KDL::Vector(0, 0, -9.81));
  KDL::JntArray q(N), qd(N), tau(N);
  double worst = 0.0;
  for (int n = 0; n < states; ++n) {
    q.data = RandomJoints<N>(random, std::numbers::pi);
    qd.data = RandomJoints<N>(random, 3.0);
    EXPECT_EQ(dynamics.JntToGravity(q, tau), 0);
    worst = std::max(worst,
                     (arm.Gravity(q.data) - tau.data).cwiseAbs().maxCoeff() / tau.data.cwiseAbs().maxCoeff());
    EXPECT_EQ(dynamics.JntToCoriolis(q, qd, tau), 0);
    worst = std::max(worst, (arm.Coriolis(q.data, qd.data) - tau.data).cwiseAbs().maxCoeff() /
                                tau.data.cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(ChainDynamics, GravityAndCoriolisEqualKdl) {
  std::mt19937_64 random{22};
  EXPECT_LT(GravityCoriolisError(Iiwa14(), 10'000, random), kRelative);
  EXPECT_LT(GravityCoriolisError(RandomChain<6>(random), 500, random), kRelative);
}

}  // namespace
}  // namespace osteon::kinematics
