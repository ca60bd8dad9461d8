#include "hil/arm/dynamic_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "config/reading/load_robot.h"
#include "hil/arm/servo_arm.h"
#include "kinematics/payload.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests the simulated arm with masses against closed forms: the servo's differential equation, statics,
// energy and momentum.

namespace osteon::hil {
namespace {

using kinematics::JointVector;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kPeriod_s = 1e-3;
const Vector3 kGravity{0.0, 0.0, -9.81};
const Vector3 kTool_m{0.0, 0.0, 0.2};  // the tool's apex in the flange's frame

// The shipped LBR iiwa 14 with a payload of 2 kg. @param torque_share  factor on the drives' torque limits
kinematics::ChainParams<7> Iiwa(double torque_share = 1.0) {
  auto chain = std::get<kinematics::ChainParams<7>>(
      config::LoadRobot(std::string(OSTEON_SOURCE_DIR) + "/config/robots/lbr_iiwa_14_r820.yaml").chain);
  for (auto& joint : chain.joints) joint.limits.torque_Nm *= torque_share;
  return kinematics::WithPayload(
      chain, {.mass_kg = 2.0, .p_LLcm_m = {0.0, 0.0, 0.08}, .I_LLcm_kg_m2 = 0.004 * Matrix3::Identity()});
}

kinematics::ChainParams<7> WithFriction(kinematics::ChainParams<7> chain) {
  for (auto& joint : chain.joints)
    joint.friction = {.viscous_Nms_per_rad = 0.5, .coulomb_Nm = 1.0, .smoothing_rad_per_s = 0.02};
  return chain;
}

JointVector Start() { return (JointVector() << 0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2).finished(); }

DynamicArm Arm(const DynamicArmParams& params, const kinematics::ChainParams<7>& chain = Iiwa()) {
  return {params, chain, kGravity, kTool_m, kPeriod_s, Start()};
}

// A command to hold the start posture.
ArmDrive HoldStartIn(control::ControlMode control) {
  ArmDrive drive;
  drive.control = control;
  drive.q_cmd = Start();
  return drive;
}

// Force and torque as one vector.
Vector6 Stacked(const Wrench& F) {
  Vector6 v;
  v << F.f, F.t;
  return v;
}

// Jacobian at the tool's apex, in the base's frame.
kinematics::Jacobian ToolJacobian(const JointVector& q) {
  const kinematics::SerialChain<7> chain(Iiwa());
  const auto posture = chain.ComputePosture(q);
  return chain.JacobianAt(posture, posture.X_BF * kTool_m);
}

// The tolerance of 1e-9 rad covers the error of the Runge-Kutta method. With steps h of 1/8 ms and an
// oscillator of 15 Hz (angular frequency w), the error is (w h)^4 / 120, about 1e-11 of a step.
TEST(DynamicArm, WithAnExactModelPositionControlEqualsTheServosEquation) {
  auto limits = Iiwa().joints;
  std::array<kinematics::JointLimits, 7> fast;
  for (std::size_t i = 0; i < 7; ++i) {
    fast[i] = limits[i].limits;
    fast[i].velocity_rad_per_s = 1e9;
  }
  for (const double z : {0.4, 1.0, 1.6}) {
    DynamicArm arm = Arm({.bandwidth_hz = 15.0, .damping_ratio = z, .dead_cycles = 3}, Iiwa(1e3));
    ServoArm servo({.bandwidth_hz = 15.0, .damping_ratio = z, .dead_cycles = 3}, fast, kPeriod_s, Start());
    for (int k = 0; k < 400; ++k) {
      ArmDrive drive = HoldStartIn(control::ControlMode::kPosition);
      for (int i = 0; i < 7; ++i) drive.q_cmd[i] += 0.2 * std::sin(0.01 * (i + 1) * k);
      arm.Step(drive, {});
      servo.Step(drive.q_cmd);
      ASSERT_LT((arm.q() - servo.q()).cwiseAbs().maxCoeff(), 1e-9) << z << " " << k;
    }
  }
}

TEST(DynamicArm, HoldsItsOwnWeightInEveryControlMode) {
  for (const control::ControlMode control :
       {control::ControlMode::kPosition, control::ControlMode::kJointImpedance,
        control::ControlMode::kCartesianImpedance}) {
    DynamicArm arm = Arm({});
    for (int k = 0; k < 1000; ++k) arm.Step(HoldStartIn(control), {});
    EXPECT_LT((arm.q() - Start()).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT(arm.tau_external_Nm().cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_GT(arm.tau_measured_Nm().cwiseAbs().maxCoeff(), 20.0) << "its weight is no small thing";
  }
}

TEST(DynamicArm, AnArmWithAWrongModelSagsByMissingTorqueOverStiffness) {
  DynamicArm arm = Arm({.mass_error = -0.05});
  for (int k = 0; k < 4000; ++k) arm.Step(HoldStartIn(control::ControlMode::kJointImpedance), {});
  const JointVector missing = 0.05 * kinematics::SerialChain<7>(Iiwa(), kGravity).Gravity(arm.q());
  const JointVector sag = Start() - arm.q();
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(500.0 * sag[i], missing[i], 1e-4) << i;
  EXPECT_GT(missing.cwiseAbs().maxCoeff(), 1.0);
  EXPECT_LT((arm.tau_external_Nm() + missing).cwiseAbs().maxCoeff(), 1e-3)
      << "what the model gets wrong looks like something that presses";
}

TEST(DynamicArm, AWrenchDeflectsTheArmByTheControllersCompliance) {
  const Wrench F{.f = {30.0, -20.0, 40.0}, .t = {1.0, 2.0, -1.5}};
  {
    DynamicArm arm = Arm({});
    for (int k = 0; k < 4000; ++k) arm.Step(HoldStartIn(control::ControlMode::kJointImpedance), F);
    const JointVector pressed = ToolJacobian(arm.q()).transpose() * Stacked(F);
    EXPECT_LT((500.0 * (arm.q() - Start()) - pressed).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_LT((arm.tau_external_Nm() - pressed).cwiseAbs().maxCoeff(), 1e-4);
  }
  {
    DynamicArm arm = Arm({});
    for (int k = 0; k < 6000; ++k) arm.Step(HoldStartIn(control::ControlMode::kCartesianImpedance), F);
    const kinematics::SerialChain<7> chain(Iiwa());
    const Vector3 moved = chain.FlangePose(arm.q()) * kTool_m - chain.FlangePose(Start()) * kTool_m;
    EXPECT_LT((2000.0 * moved - F.f).norm(), 0.05) << moved.transpose();
  }
  {
    DynamicArm arm = Arm({});
    for (int k = 0; k < 2000; ++k) arm.Step(HoldStartIn(control::ControlMode::kPosition), F);
    const double w = 2.0 * std::numbers::pi * 15.0;
    const JointVector pressed = ToolJacobian(arm.q()).transpose() * Stacked(F);
    const JointVector held =
        w * w * (kinematics::SerialChain<7>(Iiwa()).MassMatrix(arm.q()) * (arm.q() - Start()));
    EXPECT_LT((held - pressed).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(DynamicArm, TorqueAndWrenchOverlaysCancelAnExternalWrench) {
  // each overlay must cancel the external wrench: in joint impedance by torques, in Cartesian impedance by a
  // wrench
  const Wrench F{.f = {20.0, 10.0, -30.0}, .t = {0.5, -1.0, 2.0}};
  DynamicArm joint = Arm({}), cartesian = Arm({});
  ArmDrive torque = HoldStartIn(control::ControlMode::kJointImpedance),
           wrench = HoldStartIn(control::ControlMode::kCartesianImpedance);
  wrench.F_T_B = {.f = -F.f, .t = -F.t};
  for (int k = 0; k < 500; ++k) {
    torque.tau_Nm = -ToolJacobian(joint.q()).transpose() * Stacked(F);
    joint.Step(torque, k < 4 ? Wrench{} : F);  // the overlay acts after the dead time, but the external
                                               // wrench acts at once, so it begins later
    cartesian.Step(wrench, k < 3 ? Wrench{} : F);
  }
  EXPECT_LT((cartesian.q() - Start()).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((joint.q() - Start()).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(DynamicArm, NoDriveExceedsItsTorqueLimit) {
  const kinematics::ChainParams<7> chain = Iiwa();
  DynamicArm arm = Arm({}, chain);
  ArmDrive drive = HoldStartIn(control::ControlMode::kPosition);
  drive.q_cmd.array() += 0.05;
  int at_limit = 0;
  for (int k = 0; k < 500; ++k) {
    arm.Step(drive, {});
    for (int i = 0; i < 7; ++i) {
      const double share =
          std::abs(arm.tau_measured_Nm()[i]) / chain.joints[static_cast<std::size_t>(i)].limits.torque_Nm;
      ASSERT_LE(share, 1.0 + 1e-12);
      if (share > 0.999) ++at_limit;
    }
  }
  EXPECT_GT(at_limit, 10) << "the step must ask for more than the drives have, or nothing is proven";
  EXPECT_LT((arm.q() - drive.q_cmd).cwiseAbs().maxCoeff(), 1e-3) << "and it comes to its place at last";
}

TEST(DynamicArm, AnArmInImpedanceControlNeverGainsEnergy) {
  DynamicArm arm = Arm({.dead_cycles = 0}, WithFriction(Iiwa()));
  ArmDrive drive = HoldStartIn(control::ControlMode::kJointImpedance);
  drive.q_cmd += (JointVector() << 0.1, -0.05, 0.1, 0.1, -0.1, 0.1, 0.1).finished();
  const kinematics::SerialChain<7> chain(Iiwa());
  double before = HUGE_VAL, first = 0.0;
  for (int k = 0; k < 1500; ++k) {
    arm.Step(drive, {});
    const double energy = 0.5 * arm.qd().dot(chain.MassMatrix(arm.q()) * arm.qd()) +
                          250.0 * (drive.q_cmd - arm.q()).squaredNorm();
    ASSERT_LE(energy, before + 1e-10) << k;
    if (k == 0) first = energy;
    before = energy;
  }
  EXPECT_LT(before, 0.05 * first);
  EXPECT_GT(before, 0.0) << "friction holds it a little off";
}

TEST(DynamicArm, FrictionHoldsASmallerTorqueUnlessItIsCompensated) {
  const auto creep = [](double compensation) {
    DynamicArm arm = Arm({.stiffness_Nm_per_rad = JointVector::Zero(),
                          .joint_damping_ratio = 0.0,
                          .friction_compensation = compensation},
                         WithFriction(Iiwa()));
    ArmDrive drive = HoldStartIn(control::ControlMode::kJointImpedance);
    drive.tau_Nm[6] = 0.3;  // less than the Coulomb friction of 1 N·m
    for (int k = 0; k < 200; ++k) arm.Step(drive, {});
    return arm.q()[6] - Start()[6];
  };
  EXPECT_LT(creep(0.0), 0.002) << "tanh creeps at .3 of its smoothing";
  EXPECT_GT(creep(1.0), 0.1);
}

TEST(DynamicArm, AWrenchDeflectsTheMountingByItsCompliance) {
  const FlexibleMountParams mount{
      .stiffness_N_per_m = 2e5, .stiffness_Nm_per_rad = 5e4, .damping_ratio = 0.5};
  DynamicArm arm = Arm({.mount = mount});
  const Wrench F{.f = {100.0, 50.0, -80.0}, .t = {1.0, 2.0, 3.0}};
  for (int k = 0; k < 5000; ++k) arm.Step(HoldStartIn(control::ControlMode::kPosition), F);
  const Pose X = arm.X_BBnow();
  const kinematics::SerialChain<7> chain(Iiwa(), kGravity);
  const Vector3 p_B = chain.FlangePose(arm.q()) * kTool_m;
  EXPECT_LT((2e5 * X.translation() - F.f).norm(), 1e-3 * F.f.norm());
  // the deflection of the joints moves the arm's weight a little, which changes the load of the mount
  EXPECT_LT((5e4 * LogRotation(X.linear()) - (F.t + p_B.cross(F.f))).norm(),
            0.05 * (F.t + p_B.cross(F.f)).norm());
}

// Results for an arm whose base floats in space, without gravity and almost without stiffness of the mount.
// The drives push for 50 ms.
struct FreeFlight {
  double momentum{0.0};       ///< largest total momentum [kg m/s]
  double base_momentum{0.0};  ///< largest momentum of the base alone
  double energy_change{0.0};  ///< relative change of the energy after the push
};
// @param push  factor on the torques of the drives
FreeFlight SimulateFreeFlight(double push) {
  constexpr double kStep_s = 2e-5, kMass_kg = 10.0, kInertia_kg_m2 = 0.5;
  const kinematics::ChainParams<7> params = Iiwa();
  const kinematics::SerialChain<7> chain(params, Vector3::Zero());
  FlexibleMount mount({.stiffness_N_per_m = 1e-6,
                       .stiffness_Nm_per_rad = 1e-6,
                       .damping_ratio = 0.0,
                       .mass_kg = kMass_kg,
                       .inertia_kg_m2 = kInertia_kg_m2},
                      params, Vector3::Zero(), Start());
  JointVector q = Start(), qd = JointVector::Zero();
  FreeFlight flight;
  // returns the total kinetic energy, and updates the largest total momentum. The velocity of each body is
  // the sum of the base's motion and the joints' motion
  const auto energy = [&] {
    const Vector3 U = mount.rate().head<3>(), W = mount.rate().tail<3>();
    double sum = 0.5 * (kMass_kg * U.squaredNorm() + kInertia_kg_m2 * W.squaredNorm());
    Vector3 momentum = kMass_kg * U, v = Vector3::Zero(), w = Vector3::Zero(), before = Vector3::Zero();
    const auto posture = chain.ComputePosture(q);
    for (int i = 0; i < 7; ++i) {
      const auto at = static_cast<std::size_t>(i);
      v += w.cross(posture.p_BL[at] - before);
      w += qd[i] * posture.axis_B(i);
      before = posture.p_BL[at];
      const Pose X = chain.LinkPose(posture, i);
      const kinematics::LinkInertia& link = params.joints[at].link;
      const Vector3 c = X * link.p_LLcm_m, v_c = U + W.cross(c) + v + w.cross(c - posture.p_BL[at]);
      const Vector3 w_L = X.linear().transpose() * (W + w);
      sum += 0.5 * (link.mass_kg * v_c.squaredNorm() + w_L.dot(link.I_LLcm_kg_m2 * w_L));
      momentum += link.mass_kg * v_c;
    }
    flight.momentum = std::max(flight.momentum, momentum.norm());
    return sum;
  };
  double pushed = 0.0;
  for (int k = 0; k < 20'000; ++k) {
    JointVector tau = JointVector::Zero();
    if (k < 2500) tau << 8.0, 12.0, 3.0, -8.0, 1.0, -2.0, 0.3;
    const JointVector qdd = chain.ForwardDynamics(q, qd, push * tau - mount.Torques(chain, q));
    qd += kStep_s * qdd;
    q += kStep_s * qd;
    mount.Step(chain, {.q = q, .qd = qd}, kStep_s);
    flight.base_momentum = std::max(flight.base_momentum, kMass_kg * mount.rate().head<3>().norm());
    if (k == 2500) pushed = energy();
  }
  flight.energy_change = std::abs(energy() / pushed - 1.0);
  return flight;
}

// Torques between links must never change the total momentum, and the energy must stay constant after the
// torques end. This tests both directions of the coupling between arm and base. The simulation neglects the
// Coriolis and centrifugal loads due to the base's rotation. Their effect on the energy decreases with the
// speed.
TEST(DynamicArm, ArmAndBaseExchangeMomentumWithoutCreatingEnergy) {
  const FreeFlight fast = SimulateFreeFlight(0.5), slow = SimulateFreeFlight(0.03);
  EXPECT_GT(fast.base_momentum, 0.1) << "the base must move to prove anything";
  EXPECT_LT(fast.momentum, 1e-7 * fast.base_momentum);
  EXPECT_LT(slow.momentum, 1e-7 * slow.base_momentum);
  EXPECT_LT(fast.energy_change, 0.1);
  EXPECT_LT(slow.energy_change, 0.35 * fast.energy_change);
}

TEST(DynamicArm, TwoRunsAreBitIdenticalAndAStepDoesNotAllocate) {
  DynamicArm one = Arm({.mount = FlexibleMountParams{}}, WithFriction(Iiwa())),
             other = Arm({.mount = FlexibleMountParams{}}, WithFriction(Iiwa()));
  const Wrench F{.f = {10.0, 0.0, -30.0}, .t = {0.0, 1.0, 0.0}};
  for (const control::ControlMode control :
       {control::ControlMode::kPosition, control::ControlMode::kJointImpedance,
        control::ControlMode::kCartesianImpedance})
    for (int k = 0; k < 50; ++k) {
      ArmDrive drive = HoldStartIn(control);
      drive.q_cmd.array() += 0.001 * k;
      rt::CheckedNoAllocScope no_alloc;
      one.Step(drive, F);
      other.Step(drive, F);
    }
  EXPECT_EQ(one.q(), other.q());
  EXPECT_EQ(one.qd(), other.qd());
}

TEST(DynamicArm, RefusesBadParametersByName) {
  const auto message = [](const DynamicArmParams& params, const kinematics::ChainParams<7>& chain) {
    try {
      Arm(params, chain);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({}, Iiwa()), "");
  EXPECT_NE(message({.bandwidth_hz = -1.0}, Iiwa()).find("bandwidth_hz: found -1"), std::string::npos);
  EXPECT_NE(message({.substeps = 0}, Iiwa()).find("substeps"), std::string::npos);
  EXPECT_NE(message({.mass_error = NAN}, Iiwa()).find("mass_error"), std::string::npos);
  EXPECT_NE(message({.mount = FlexibleMountParams{.mass_kg = 0.0}}, Iiwa()).find("mass_kg: found 0"),
            std::string::npos);
  kinematics::ChainParams<7> weak = Iiwa();
  weak.joints[2].limits.torque_Nm = 0.0;
  EXPECT_NE(message({}, weak).find("torque_Nm of A3"), std::string::npos);
  kinematics::ChainParams<7> massless = Iiwa();
  massless.has_masses = false;
  EXPECT_NE(message({}, massless).find("masses"), std::string::npos);
}

}  // namespace
}  // namespace osteon::hil
