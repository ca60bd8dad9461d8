#include <numbers>

#include <gtest/gtest.h>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

#include "kinematics/payload.h"
#include "kinematics/serial_chain.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/chain_samples.h"
#include "tests/kinematics/mujoco_arm.h"
#include "tests/oracles/jacobian_dot.h"

namespace osteon::kinematics {
namespace {

constexpr double kRelative = 1e-9;  // permitted error as a share of the largest torque; rounding gives 1e-13

// Largest relative difference of torques from KDL's over random states. Every other state has a wrench on the
// flange.
template <int N>
double InverseDynamicsError(const ChainParams<N>& params, int states, std::mt19937_64& random) {
  const Vector3 gravity_B(1.0, -2.0, -9.0);  // the arm is mounted at an angle
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
    // KDL expects each segment's wrench in the segment's own frame
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
  EXPECT_LT(InverseDynamicsError(Iiwa14Chain(), 20'000, random), kRelative);
  for (int n = 0; n < 20; ++n) {
    EXPECT_LT(InverseDynamicsError(RandomChain<6>(random), 100, random), kRelative);
    EXPECT_LT(InverseDynamicsError(RandomChain<7>(random), 100, random), kRelative);
  }
}

// Largest relative difference of gravity and Coriolis torques from KDL's over random states.
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
  EXPECT_LT(GravityCoriolisError(Iiwa14Chain(), 10'000, random), kRelative);
  EXPECT_LT(GravityCoriolisError(RandomChain<6>(random), 500, random), kRelative);
}

// Largest relative differences of the mass matrix from KDL's and MuJoCo's, and of inverse and forward
// dynamics from MuJoCo's. MuJoCo computes in other frames and with spatial accelerations.
template <int N>
struct MassErrors {
  double kdl{0.0}, mujoco{0.0}, mujoco_inverse{0.0}, mujoco_forward{0.0};
};

template <int N>
MassErrors<N> CompareWithKdlAndMujoco(const ChainParams<N>& params, int states, std::mt19937_64& random) {
  const Vector3 gravity_B(0.5, 1.0, -9.5);
  const SerialChain<N> arm(params, gravity_B);
  MujocoArm<N> mujoco(params, gravity_B);
  const KDL::Chain chain = KdlChain(params);
  KDL::ChainDynParam dynamics(chain, KDL::Vector(0, 0, -9.81));
  KDL::JntArray joints(N);
  KDL::JntSpaceInertiaMatrix M_kdl(N);
  const auto relative_difference = [](const auto& found, const auto& expected) {
    return (found - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
  };
  MassErrors<N> worst;
  for (int n = 0; n < states; ++n) {
    const JointVectorN<N> q = RandomJoints<N>(random, std::numbers::pi), qd = RandomJoints<N>(random, 3.0),
                          qdd = RandomJoints<N>(random, 10.0), tau = RandomJoints<N>(random, 100.0);
    joints.data = q;
    EXPECT_EQ(dynamics.JntToMass(joints, M_kdl), 0);
    const JointMatrixN<N> M = arm.MassMatrix(q), M_expected = M_kdl.data;
    EXPECT_EQ(M, JointMatrixN<N>(M.transpose()));
    worst.kdl = std::max(worst.kdl, relative_difference(M, M_expected));
    worst.mujoco = std::max(worst.mujoco, relative_difference(M, mujoco.MassMatrix(q)));
    worst.mujoco_inverse =
        std::max(worst.mujoco_inverse,
                 relative_difference(arm.InverseDynamics(q, qd, qdd), mujoco.InverseDynamics(q, qd, qdd)));
    worst.mujoco_forward =
        std::max(worst.mujoco_forward,
                 relative_difference(arm.ForwardDynamics(q, qd, tau), mujoco.ForwardDynamics(q, qd, tau)));
  }
  return worst;
}

TEST(ChainDynamics, MassMatrixAndMotionEqualKdlAndMujoco) {
  std::mt19937_64 random{23};
  const auto check = [](const auto& worst) {
    EXPECT_LT(worst.kdl, kRelative);
    EXPECT_LT(worst.mujoco, kRelative);
    EXPECT_LT(worst.mujoco_inverse, kRelative);
    EXPECT_LT(worst.mujoco_forward, kRelative);
  };
  check(CompareWithKdlAndMujoco(Iiwa14Chain(), 10'000, random));
  for (int n = 0; n < 10; ++n) {
    check(CompareWithKdlAndMujoco(RandomChain<6>(random), 200, random));
    check(CompareWithKdlAndMujoco(RandomChain<7>(random), 200, random));
  }
}

// Largest error of accelerations that forward dynamics recovers from the torques of inverse dynamics, as a
// share of 10 rad/s^2. The two methods share no recursion.
template <int N>
double InversePairError(const ChainParams<N>& params, int states, std::mt19937_64& random) {
  const SerialChain<N> arm(params);
  double worst = 0.0;
  for (int n = 0; n < states; ++n) {
    const JointVectorN<N> q = RandomJoints<N>(random, std::numbers::pi), qd = RandomJoints<N>(random, 3.0),
                          qdd = RandomJoints<N>(random, 10.0);
    const Wrench F{.f = RandomJoints<6>(random, 200.0).template head<3>(),
                   .t = RandomJoints<6>(random, 20.0).template head<3>()};
    const JointVectorN<N> recovered_qdd = arm.ForwardDynamics(q, qd, arm.InverseDynamics(q, qd, qdd, F), F);
    worst = std::max(worst, (recovered_qdd - qdd).cwiseAbs().maxCoeff() / 10.0);
  }
  return worst;
}

TEST(ChainDynamics, ForwardDynamicsUndoesInverseDynamics) {
  std::mt19937_64 random{24};
  EXPECT_LT(InversePairError(Iiwa14Chain(), 20'000, random), kRelative);
  for (int n = 0; n < 20; ++n) {
    EXPECT_LT(InversePairError(RandomChain<6>(random), 100, random), kRelative);
    EXPECT_LT(InversePairError(RandomChain<7>(random), 100, random), kRelative);
  }
}

// The power balance that control laws rely on: qd·Ṁ qd = 2 qd·(Coriolis torques). The test computes Ṁ, the
// rate of the mass matrix M, by central differences with step h = 1e-5. Their errors are h^2/6 (truncation)
// and 1e-16/h (rounding) times M of a few kg m^2: below 1e-8.
TEST(ChainDynamics, CoriolisTorquesBalanceTheMassMatrixRate) {
  std::mt19937_64 random{25};
  for (const ChainParams<7>& params : {Iiwa14Chain(), RandomChain<7>(random)}) {
    const SerialChain<7> arm(params);
    for (int n = 0; n < 200; ++n) {
      const JointVectorN<7> q = RandomJoints<7>(random, 3.0), qd = RandomJoints<7>(random, 2.0);
      const double h = 1e-5;
      const JointMatrixN<7> M_dot = (arm.MassMatrix(q + h * qd) - arm.MassMatrix(q - h * qd)) / (2.0 * h);
      EXPECT_NEAR(qd.dot(M_dot * qd - 2.0 * arm.Coriolis(q, qd)), 0.0, 1e-7 * qd.squaredNorm());
    }
  }
}

// The arm falls freely for half a second from a raised posture: potential energy becomes kinetic energy. The
// classical Runge-Kutta method is of fourth order: half the step gives a sixteenth of the error.
TEST(ChainDynamics, FreeMotionKeepsItsEnergyToTheIntegratorsOrder) {
  const ChainParams<7> params = Iiwa14Chain();
  const SerialChain<7> arm(params);
  const auto energy = [&](const JointVectorN<7>& q, const JointVectorN<7>& qd) {
    const auto posture = arm.ComputePosture(q);
    double sum = 0.5 * qd.dot(arm.MassMatrix(q) * qd);
    for (int i = 0; i < 7; ++i) {
      const LinkInertia& link = params.joints[static_cast<std::size_t>(i)].link;
      sum += 9.81 * link.mass_kg * (arm.LinkPose(posture, i) * link.p_LLcm_m).z();
    }
    return sum;
  };
  // Change of the total energy over 0.5 s, integrated in this many steps [J].
  const auto error = [&](int steps) {
    JointVectorN<7> q = (JointVectorN<7>() << 0.3, 0.5, -0.2, -0.9, 0.4, 0.6, 0.1).finished();
    JointVectorN<7> qd = (JointVectorN<7>() << 0.2, -0.3, 0.5, 0.1, -0.4, 0.3, 1.0).finished();
    const double before = energy(q, qd), dt = 0.5 / steps;
    const auto rate = [&](const JointVectorN<7>& q_at, const JointVectorN<7>& qd_at) {
      return arm.ForwardDynamics(q_at, qd_at, JointVectorN<7>::Zero());
    };
    for (int n = 0; n < steps; ++n) {
      const JointVectorN<7> v1 = qd, a1 = rate(q, v1);
      const JointVectorN<7> v2 = qd + 0.5 * dt * a1, a2 = rate(q + 0.5 * dt * v1, v2);
      const JointVectorN<7> v3 = qd + 0.5 * dt * a2, a3 = rate(q + 0.5 * dt * v2, v3);
      const JointVectorN<7> v4 = qd + dt * a3, a4 = rate(q + dt * v3, v4);
      q += dt / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
      qd += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    return std::abs(energy(q, qd) - before);
  };
  const double coarse = error(800), fine = error(1600), finest = error(3200);
  EXPECT_GT(coarse / fine, 12.0) << coarse << ' ' << fine << ' ' << finest;
  EXPECT_GT(fine / finest, 12.0) << coarse << ' ' << fine << ' ' << finest;
  EXPECT_LT(finest, 1e-6) << "J";
}

TEST(ChainDynamics, FrictionOpposesMotionAndSaturates) {
  ChainParams<7> params = Iiwa14Chain();
  params.joints[2].friction = {.viscous_Nms_per_rad = 0.5, .coulomb_Nm = 2.0, .smoothing_rad_per_s = 0.01};
  const SerialChain<7> arm(params);
  JointVectorN<7> qd = JointVectorN<7>::Zero();
  EXPECT_EQ(arm.Friction(qd), qd);
  qd[2] = 1.0;
  EXPECT_NEAR(arm.Friction(qd)[2], 2.5, 1e-12);
  EXPECT_NEAR(arm.Friction(-qd)[2], -2.5, 1e-12);
  qd[2] = 0.01;
  EXPECT_NEAR(arm.Friction(qd)[2], 0.005 + 2.0 * std::tanh(1.0), 1e-12);
  EXPECT_EQ(arm.Friction(qd)[3], 0.0);
}

// A hand's wrench acts on an arm at rest in free space. The flange's first acceleration must be the one that
// the mobility predicts.
TEST(ChainDynamics, MobilityIsTheAccelerationForAWrench) {
  std::mt19937_64 random{26};
  const SerialChain<7> arm(RandomChain<7>(random), Vector3::Zero());
  for (int n = 0; n < 100; ++n) {
    const JointVectorN<7> q = RandomJoints<7>(random, 3.0), rest = JointVectorN<7>::Zero();
    const auto posture = arm.ComputePosture(q);
    const Eigen::Matrix<double, 6, 1> F = RandomJoints<6>(random, 50.0);
    const JointVectorN<7> qdd = arm.ForwardDynamics(q, rest, rest, {.f = F.head<3>(), .t = F.tail<3>()});
    const Eigen::Matrix<double, 6, 1> expected = arm.Jacobian(posture) * qdd;
    const Vector3 p_B = posture.X_BF.translation(), f_B = F.head<3>();
    EXPECT_LT((arm.Mobility(q, p_B) * F - expected).norm(), 1e-10 * expected.norm());
    // the same wrench, taken about another point of the flange
    const Vector3 r_B = posture.X_BF.linear() * Vector3(0.02, 0.1, 0.3);
    Eigen::Matrix<double, 6, 1> moved_F = F, moved_A = expected;
    moved_F.tail<3>() -= r_B.cross(f_B);
    moved_A.head<3>() += Vector3(expected.tail<3>()).cross(r_B);
    EXPECT_LT((arm.Mobility(q, p_B + r_B) * moved_F - moved_A).norm(), 1e-10 * moved_A.norm());
  }
}

// The torques of the loaded arm must equal those of the bare arm plus J^T F. F is the wrench on the flange
// that accelerates the payload's mass and inertia and supports the payload's weight.
TEST(ChainDynamics, PayloadActsOnTheFlangeAsItsWeightAndInertia) {
  std::mt19937_64 random{27};
  for (int n = 0; n < 50; ++n) {
    const ChainParams<6> bare_params = RandomChain<6>(random);
    LinkInertia payload = RandomChain<6>(random).joints[0].link;
    const SerialChain<6> bare(bare_params), loaded(WithPayload(bare_params, payload));
    const JointVectorN<6> q = RandomJoints<6>(random, 3.0), qd = RandomJoints<6>(random, 2.0),
                          qdd = RandomJoints<6>(random, 5.0);
    const auto posture = bare.ComputePosture(q);
    const JacobianN<6> J = bare.Jacobian(posture),
                       J_dot = JacobianDot<6>(posture, qd, posture.X_BF.translation());
    const Eigen::Matrix<double, 6, 1> V = J * qd, A = J * qdd + J_dot * qd;
    const Matrix3 R = posture.X_BF.linear(), I = R * payload.I_LLcm_kg_m2 * R.transpose();
    const Vector3 w = V.tail<3>(), wd = A.tail<3>(), c = R * payload.p_LLcm_m;
    const Vector3 a = A.head<3>() + wd.cross(c) + w.cross(w.cross(c)) + Vector3(0, 0, 9.81);
    Eigen::Matrix<double, 6, 1> F;
    F.head<3>() = payload.mass_kg * a;
    F.tail<3>() = I * wd + w.cross(I * w) + c.cross(F.head<3>());
    const JointVectorN<6> expected = bare.InverseDynamics(q, qd, qdd) + J.transpose() * F;
    EXPECT_LT((loaded.InverseDynamics(q, qd, qdd) - expected).norm(), 1e-12 * expected.norm());
  }
}

TEST(ChainDynamics, WithPayloadRefusesNegativeMassAndIgnoresPayloadOrArmWithoutMass) {
  LinkInertia payload{.mass_kg = 1.0};
  EXPECT_EQ(WithPayload(Kr6R900(), payload).joints.back().link.mass_kg, 0.0);
  EXPECT_EQ(WithPayload(Iiwa14Chain(), LinkInertia{}).joints.back().link.mass_kg,
            Iiwa14Chain().joints.back().link.mass_kg);
  payload.mass_kg = -1.0;
  EXPECT_THROW(static_cast<void>(WithPayload(Iiwa14Chain(), payload)), std::invalid_argument);
}

TEST(ChainDynamics, DoesNotAllocate) {
  std::mt19937_64 random{28};
  const SerialChain<7> arm(Iiwa14Chain());
  const JointVectorN<7> q = RandomJoints<7>(random, 2.0), qd = RandomJoints<7>(random, 1.0);
  const Wrench F{.f = {1, 2, 3}, .t = {4, 5, 6}};
  rt::CheckedNoAllocScope no_alloc;
  JointVectorN<7> sum = arm.InverseDynamics(q, qd, q) + arm.InverseDynamics(q, qd, q, F) + arm.Gravity(q) +
                        arm.Coriolis(q, qd) + arm.Friction(qd) + arm.ForwardDynamics(q, qd, q) +
                        arm.ForwardDynamics(q, qd, q, F);
  sum += arm.MassMatrix(q) * qd;
  const double total = sum.sum() + arm.Mobility(q, F.f).sum();
  no_alloc.End();
  EXPECT_TRUE(std::isfinite(total));
}

}  // namespace
}  // namespace osteon::kinematics
