#include "safety/guard_kinematics.h"

#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "safety/guard_monitor.h"
#include "tests/kinematics/chain_samples.h"

// This program links the library osteon::guard, but neither osteon::kinematics nor osteon::safety. If the
// program links, the guard runs no code of the loop that it supervises. The guard's kinematics is compared
// with KDL and with poses worked out by hand.

namespace osteon::safety {
namespace {

using kinematics::ChainParams, kinematics::Iiwa14Chain, kinematics::KdlChain, kinematics::RandomChain,
    kinematics::RandomJoints;
using Joints = GuardKinematics::Joints;

constexpr double kRounding = 1e-12;  // some hundred products of numbers around 1, with a margin

// A random pose.
Pose AnyPose(std::mt19937_64& random) { return RandomChain<7>(random).X_LF; }

Vector3 ToVector(const KDL::Vector& v) { return {v.x(), v.y(), v.z()}; }

// The point of the line through p along a that is nearest to the line through q along b; a and b are unit
// vectors. Solves the two equations that the connecting vector is perpendicular to a and to b.
Vector3 NearestOfLine(const Vector3& p, const Vector3& a, const Vector3& q, const Vector3& b) {
  Eigen::Matrix2d equations;
  equations << 1.0, -a.dot(b), a.dot(b), -1.0;
  const Eigen::Vector2d along = equations.inverse() * Eigen::Vector2d(a.dot(q - p), b.dot(q - p));
  return p + along[0] * a;
}

// Compares positions [m], the tool's rotation matrix and the joints' motions over random postures.
double LargestDifferenceFromKdl(const ChainParams<7>& chain, const Pose& X_WB, const Pose& X_FT, int postures,
                                std::mt19937_64& random) {
  const GuardKinematics arm(chain, X_WB, X_FT);
  const KDL::Chain described = KdlChain(chain);
  KDL::ChainFkSolverPos_recursive forward(described);
  KDL::ChainJntToJacSolver velocity(described);
  KDL::JntArray joints(7);
  KDL::Jacobian J(7);
  double worst = 0.0;
  const auto compare = [&worst](const auto& found, const auto& expected) {
    worst = std::max(worst, (found - expected).cwiseAbs().maxCoeff());
  };
  for (int n = 0; n < postures; ++n) {
    const Joints q = RandomJoints<7>(random, std::numbers::pi);
    joints.data = q;
    KDL::Frame flange, a3, a4;
    EXPECT_EQ(forward.JntToCart(joints, flange), 0);
    EXPECT_EQ(forward.JntToCart(joints, a3, 3), 0);
    EXPECT_EQ(forward.JntToCart(joints, a4, 4), 0);
    EXPECT_EQ(velocity.JntToJac(joints, J), 0);
    Pose X_BF = Pose::Identity();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) X_BF.linear()(i, j) = flange.M(i, j);
    X_BF.translation() = ToVector(flange.p);

    const GuardKinematics::Placement at = arm.ComputePlacement(q);
    compare(at.p_WFlange, Vector3(X_WB * X_BF.translation()));
    const Vector3 elbow =
        NearestOfLine(ToVector(a4.p), J.data.col(3).tail<3>(), ToVector(a3.p), J.data.col(2).tail<3>());
    compare(at.p_WElbow, Vector3(X_WB * elbow));
    compare(at.p_WT, Vector3((X_WB * X_BF * X_FT).translation()));
    compare(at.R_WT, Matrix3((X_WB * X_BF * X_FT).linear()));

    const Vector3 lever_W = X_WB.linear() * (X_BF.linear() * Vector3(X_FT.translation()));
    const GuardKinematics::JointMotions motions = arm.ComputeJointMotions(q, at.p_WT);
    for (int i = 0; i < 7; ++i) {
      const Vector3 v_W = X_WB.linear() * Vector3(J.data.col(i).head<3>()),
                    w_W = X_WB.linear() * Vector3(J.data.col(i).tail<3>());
      compare(motions.w[static_cast<std::size_t>(i)], w_W);
      compare(motions.v[static_cast<std::size_t>(i)], Vector3(v_W + w_W.cross(lever_W)));
    }
  }
  return worst;
}

TEST(GuardKinematics, EqualsKdlForAnIiwa) {
  std::mt19937_64 random{20261126};
  EXPECT_LT(LargestDifferenceFromKdl(Iiwa14Chain(), AnyPose(random), AnyPose(random), 20'000, random),
            kRounding);
}

TEST(GuardKinematics, EqualsKdlForRandomArms) {
  std::mt19937_64 random{7};
  for (int arm = 0; arm < 200; ++arm)
    EXPECT_LT(LargestDifferenceFromKdl(RandomChain<7>(random), AnyPose(random), AnyPose(random), 50, random),
              kRounding);
}

// An iiwa 14 with a tool of 100 mm. Its shoulder is at 360 mm, its elbow 420 mm farther, its wrist 400 mm
// farther, its flange 126 mm farther.
TEST(GuardKinematics, EqualsPosturesOfAnIiwaThatWereWorkedOutByHand) {
  ChainParams<7> chain = Iiwa14Chain();
  Pose X_FT = Pose::Identity();
  X_FT.translation() = Vector3(0.0, 0.0, 0.1);
  const GuardKinematics arm(chain, Pose::Identity(), X_FT);
  const auto expect = [&](const Joints& q, const Vector3& elbow, const Vector3& flange, const Vector3& apex,
                          const Vector3& tool_z) {
    const GuardKinematics::Placement at = arm.ComputePlacement(q);
    EXPECT_LT((at.p_WElbow - elbow).norm(), 1e-12) << at.p_WElbow.transpose();
    EXPECT_LT((at.p_WFlange - flange).norm(), 1e-12) << at.p_WFlange.transpose();
    EXPECT_LT((at.p_WT - apex).norm(), 1e-12) << at.p_WT.transpose();
    EXPECT_LT((at.R_WT.col(2) - tool_z).norm(), 1e-12) << at.R_WT.col(2).transpose();
  };
  const double right = std::numbers::pi / 2.0;
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  Joints q = Joints::Zero();
  expect(q, 0.78 * z, 1.306 * z, 1.406 * z, z);  // upright
  q[1] = right;                                  // A2 turns about y: stretched out along x
  expect(q, 0.36 * z + 0.42 * x, 0.36 * z + 0.946 * x, 0.36 * z + 1.046 * x, x);
  q[0] = right;  // A1 about z: along y
  expect(q, 0.36 * z + 0.42 * y, 0.36 * z + 0.946 * y, 0.36 * z + 1.046 * y, y);
  q = Joints::Zero();
  q[3] = right;  // A4 about -y: the forearm along -x
  expect(q, 0.78 * z, 0.78 * z - 0.526 * x, 0.78 * z - 0.626 * x, -x);
  q[2] = right;  // A3 about z: forearm along -y
  expect(q, 0.78 * z, 0.78 * z - 0.526 * y, 0.78 * z - 0.626 * y, -y);
  q = Joints::Zero();
  q[5] = right;  // A6 about y: the hand along x
  expect(q, 0.78 * z, 1.18 * z + 0.126 * x, 1.18 * z + 0.226 * x, x);
  q[4] = right;  // A5 about z: hand along y
  expect(q, 0.78 * z, 1.18 * z + 0.126 * y, 1.18 * z + 0.226 * y, y);
  q[6] = right;  // A7 turns about the tool's own axis: its x goes from -z to -x
  expect(q, 0.78 * z, 1.18 * z + 0.126 * y, 1.18 * z + 0.226 * y, y);
  EXPECT_LT((arm.ComputePlacement(q).R_WT.col(0) - (-x)).norm(), 1e-12)
      << arm.ComputePlacement(q).R_WT.col(0).transpose();
}

TEST(GuardKinematics, RefusesAxesAndRotationsThatAreNotUnitOrNotFinite) {
  const auto refuses = [](auto change) {
    ChainParams<7> chain = Iiwa14Chain();
    Pose X_WB = Pose::Identity(), X_FT = Pose::Identity();
    change(chain, X_WB, X_FT);
    EXPECT_THROW(GuardKinematics(chain, X_WB, X_FT), std::invalid_argument);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuses([](ChainParams<7>& chain, Pose&, Pose&) { chain.joints[2].axis_J *= 1.01; });
  refuses([&](ChainParams<7>& chain, Pose&, Pose&) { chain.joints[4].axis_J.x() = nan; });
  refuses([](ChainParams<7>& chain, Pose&, Pose&) { chain.joints[6].X_PJ.linear() *= 1.01; });
  refuses([](ChainParams<7>& chain, Pose&, Pose&) { chain.X_LF.linear().col(0) *= -1.0; });
  refuses([&](ChainParams<7>&, Pose& X_WB, Pose&) { X_WB.translation().y() = nan; });
  refuses([&](ChainParams<7>&, Pose&, Pose& X_FT) { X_FT.linear().setZero(); });
}

// The whole guard is linked without the code that it supervises. The tool creeps out of a sphere of 1 mm.
TEST(GuardAlone, JudgesAnArmWithoutTheControllersCode) {
  GuardParams params{.arm = Iiwa14Chain()};
  const GuardJoints start{0.1, 0.6, -0.2, -1.3, 0.3, 0.9, -0.4};
  const Vector3 p = GuardKinematics(params.arm, params.X_WB, params.X_FT)
                        .ComputePlacement(Eigen::Map<const Joints>(start.data()))
                        .p_WT;
  params.workspace.zones = {{.shape = ZoneShape::kSphere, .p_W_m = p, .radius_m = 1e-3}};
  GuardMonitor monitor(params);
  GuardCommand command{.q = start};
  GuardArmMessage arm{.session = GuardSession::kActive, .q_meas = start, .q_ipo = start};
  rt::Nanoseconds now = rt::kSecond;
  while (!monitor.latched() && now < 2 * rt::kSecond) {
    now += rt::kMillisecond;
    ++arm.sequence;
    ASSERT_EQ(monitor.OnArmMessage(arm, now), GuardDecision::kPass);
    ++command.sequence;
    command.reflected = arm.sequence;
    (*command.q)[0] += 1e-4;
    if (monitor.OnCommand(command, now) == GuardDecision::kPass) arm.q_meas = *command.q;
  }
  EXPECT_EQ(monitor.reason().finding, GuardFinding::kZone) << Describe(monitor.reason());
}

}  // namespace
}  // namespace osteon::safety
