#include "hil/arm/simulated_arm.h"

#include <gtest/gtest.h>

#include "config/reading/load_robot.h"
#include "kinematics/lbr_arm.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests properties that all levels of the simulated arm have in common (kinematic, servo, dynamic), and
// differences between the levels.

namespace osteon::hil {
namespace {

using kinematics::JointVector;

constexpr ArmLevel kLevels[] = {ArmLevel::kKinematic, ArmLevel::kServo, ArmLevel::kDynamic};

SimulatedArmParams Params(ArmLevel level) {
  SimulatedArmParams params;
  params.level = level;
  params.chain = std::get<kinematics::ChainParams<7>>(
      config::LoadRobot(std::string(OSTEON_SOURCE_DIR) + "/config/robots/lbr_iiwa_14_r820.yaml").chain);
  params.lbr = kinematics::LbrParamsFrom(params.chain);
  params.p_FT_m = {0.0, 0.0, 0.2};
  params.q_start << 0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2;
  return params;
}

// An arm's command with this joint position.
ArmDrive CommandPosition(const JointVector& q) {
  ArmDrive drive;
  drive.q_cmd = q;
  return drive;
}

TEST(SimulatedArm, EachLevelReachesItsGoalWithSpeedsThatMatchItsPositions) {
  for (const ArmLevel level : kLevels) {
    const SimulatedArmParams params = Params(level);
    const auto arm = MakeSimulatedArm(params, 1e-3);
    const JointVector distance = JointVector::LinSpaced(0.02, 0.05);
    JointVector sum = JointVector::Zero();
    for (int k = 1; k <= 600; ++k) {
      const JointVector before = arm->q(), speed_before = arm->qd();
      arm->Step(CommandPosition(params.q_start + std::min(1.0, k / 300.0) * distance), {});
      sum += arm->q() - before;
      // the distance over a cycle is the mean of the speeds at both ends of the cycle times the period. For a
      // smooth motion this is accurate to second order
      if (level != ArmLevel::kKinematic && k > 10) {
        EXPECT_LT((arm->q() - before - 0.5e-3 * (speed_before + arm->qd())).cwiseAbs().maxCoeff(), 1e-6);
      }
    }
    EXPECT_LT((arm->q() - params.q_start - distance).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((sum - distance).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT(arm->qd().cwiseAbs().maxCoeff(), 1e-4);
  }
}

TEST(SimulatedArm, TheKinematicLevelIsExactlyAtItsCommand) {
  const SimulatedArmParams params = Params(ArmLevel::kKinematic);
  const auto arm = MakeSimulatedArm(params, 2e-3);
  const JointVector q = params.q_start + JointVector::Constant(1e-3);
  arm->Step(CommandPosition(q), {});
  EXPECT_EQ(arm->q(), q);
  EXPECT_LT((arm->qd() - JointVector::Constant(0.5)).cwiseAbs().maxCoeff(), 1e-12);
}

// The external torque must equal J^T F, with the Jacobian J and the external wrench F. The levels kinematic
// and servo compute it from the wrench; the level dynamic computes it from the torques that hold the arm.
TEST(SimulatedArm, EachLevelReportsTheSameExternalTorqueOnceAtRest) {
  const Wrench F{.f = {20.0, -10.0, 30.0}, .t = {1.0, 0.5, -2.0}};
  Eigen::Matrix<double, 6, 1> stacked;
  stacked << F.f, F.t;
  for (const ArmLevel level : kLevels) {
    const SimulatedArmParams params = Params(level);
    const auto arm = MakeSimulatedArm(params, 1e-3);
    for (int k = 0; k < 2000; ++k) arm->Step(CommandPosition(params.q_start), F);
    const kinematics::LbrArm lbr(params.lbr);
    const JointVector expected = lbr.JacobianAt(arm->q(), params.p_FT_m).transpose() * stacked;
    EXPECT_LT((arm->tau_external_Nm() - expected).cwiseAbs().maxCoeff(), 1e-6) << static_cast<int>(level);
    EXPECT_EQ(arm->q() == params.q_start, level != ArmLevel::kDynamic) << "only masses give way";
  }
}

TEST(SimulatedArm, StepDoesNotAllocate) {
  for (const ArmLevel level : kLevels) {
    const SimulatedArmParams params = Params(level);
    const auto arm = MakeSimulatedArm(params, 1e-3);
    rt::CheckedNoAllocScope no_alloc;
    arm->Step(CommandPosition(params.q_start), {});
    EXPECT_TRUE(arm->tau_external_Nm().allFinite());
  }
}

}  // namespace
}  // namespace osteon::hil
