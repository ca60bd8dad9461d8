// Tests the impedance law of the servo loop on a simulated arm with masses, in Cartesian and in joint
// impedance control. The rendered force must equal the hand's force, and limits and stops must hold.

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "config/reading/load_robot.h"
#include "control/loop/servo_loop.h"
#include "hil/arm/dynamic_arm.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/payload.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::hil {
namespace {

using control::CommandMode;
using control::ControlMode;
using control::Phase;
using kinematics::JointVector;
using safety::Fault;

constexpr double kPeriod_s = 1e-3;

JointVector Start() { return (JointVector() << 0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2).finished(); }

Pose FlangeToTool() {
  Pose X_FT = Pose::Identity();
  X_FT.translation().z() = 0.2;
  return X_FT;
}

// The shipped LBR iiwa 14 with a payload of 2 kg.
kinematics::ChainParams<7> Iiwa() {
  return kinematics::WithPayload(
      std::get<kinematics::ChainParams<7>>(
          config::LoadRobot(std::string(OSTEON_SOURCE_DIR) + "/config/robots/lbr_iiwa_14_r820.yaml").chain),
      {.mass_kg = 2.0, .p_LLcm_m = {0.0, 0.0, 0.08}, .I_LLcm_kg_m2 = 0.004 * Matrix3::Identity()});
}

// Parameters of a loop with the impedance law. The limits of its workspace are out of reach.
control::ServoParams Params() {
  control::ServoParams params;
  params.law = control::Law::kImpedance;
  params.joints.limits = kinematics::Iiwa14().limits;
  params.workspace.sphere_radius_m = 3.0;
  params.workspace.plane_offset_m = -3.0;
  params.spindle_rad_per_s = 0.0;
  params.coupling.max_stiffness_N_per_m = 10e3;
  params.arm_body = Iiwa();
  return params;
}

// The servo loop and a simulated arm with masses, in virtual time. A plane of bone lies 2 mm ahead of the
// tool, and a hand pushes the arm.
class ImpedanceBench {
 public:
  explicit ImpedanceBench(const control::ServoParams& params = Params(),
                          CommandMode mode = CommandMode::kWrench, int dead_cycles = 2)
      : loop(params, lbr_, Pose::Identity(), FlangeToTool(), lbr_.ArmAngle(Start())),
        arm(Dynamics(dead_cycles), Iiwa(), kinematics::kGravity_W_m_per_s2, FlangeToTool().translation(),
            kPeriod_s, Start()) {
    drive_.control =
        mode == CommandMode::kWrench ? ControlMode::kCartesianImpedance : ControlMode::kJointImpedance;
    drive_.q_cmd = Start();
    state.command_mode = mode;
    state.session = control::SessionState::kCommandingActive;
    state.activation = 1;
    state.period_s = kPeriod_s;
    state.has_ipo = true;
    feed_W = Tool().linear().col(2);
    plane_W = Tool().translation() + 0.002 * feed_W;
  }

  // Parameters of an arm whose own impedance has little stiffness and thus little damping. So the loop's
  // overlay has to hold the tool.
  static DynamicArmParams Dynamics(int dead_cycles) {
    return {.dead_cycles = dead_cycles,
            .stiffness_Nm_per_rad = JointVector::Constant(50.0),
            .stiffness_N_per_m = 500.0,
            .stiffness_Nm_per_rad_turn = 50.0};
  }

  // @returns the record of the last tick
  control::TickRecord Run(int ticks) {
    control::TickRecord record;
    for (int i = 0; i < ticks; ++i) {
      now += rt::kMillisecond;
      state.stamp = now;
      ++state.sequence;
      std::copy_n(arm.q().data(), 7, state.q_meas.begin());
      std::copy_n(drive_.q_cmd.data(), 7, state.q_ipo.begin());
      readings.force.stamp = now;
      ++model.frame;
      model.pose_stamp = now;
      model.contact_count = 1;
      model.contacts[0].p_W_m = plane_W;
      model.contacts[0].n_W = Vector3(-feed_W);
      model.contacts[0].stiffness_N_per_m = 10e3;
      record = loop.Tick({.state = state,
                          .received = control::ReceiveResult::kOk,
                          .readings = readings,
                          .model = model,
                          .now = now},
                         command);
      drive_.q_cmd = Eigen::Map<const JointVector>(command.q.data());
      drive_.tau_Nm = Eigen::Map<const JointVector>(command.tau.data());
      const Matrix3 R_WT = Tool().linear();
      drive_.F_T_B = {.f = R_WT * Vector3(command.F.f), .t = R_WT * Vector3(command.F.t)};
      arm.Step(drive_, {.f = push_W_N, .t = Vector3::Zero()});
      peak_sent_N = std::max(peak_sent_N, Vector3(command.F.f).norm());
    }
    return record;
  }

  [[nodiscard]] Pose Tool() const { return lbr_.FlangePose(arm.q()) * FlangeToTool(); }
  // Depth of the tool's apex below the bone's plane [m].
  [[nodiscard]] double Depth() const { return feed_W.dot(Tool().translation() - plane_W); }

 private:
  kinematics::LbrArm lbr_{kinematics::Iiwa14()};

 public:
  control::ServoLoop loop;
  DynamicArm arm;
  control::ArmState state;
  control::ArmCommand command;
  control::CellReadings readings;
  simulation::ContactModel model;
  rt::Nanoseconds now{rt::kSecond};
  Vector3 push_W_N{Vector3::Zero()}, feed_W, plane_W;
  double peak_sent_N{0.0};

 private:
  ArmDrive drive_;
};

TEST(ImpedanceLoop, AWallsSpringCarriesTheHandsForceWithEitherOverlay) {
  for (const CommandMode mode : {CommandMode::kWrench, CommandMode::kTorque}) {
    ImpedanceBench bench(Params(), mode);
    bench.push_W_N = 40.0 * bench.feed_W;
    bench.Run(4000);
    ASSERT_FALSE(bench.loop.faults().Any()) << bench.loop.faults().bits();
    const control::TickRecord record = bench.Run(1);
    // The arm's own spring has its equilibrium at the measured position. So the coupling alone must carry the
    // hand's force, within 1 %.
    EXPECT_NEAR(Vector3(record.F_coupling_T_W.f).dot(-bench.feed_W), 40.0, 0.4);
    EXPECT_NEAR(bench.Depth(), 40.0 / 10e3, 4e-5);
    EXPECT_LT(bench.arm.qd().norm(), 1e-3) << "at rest: it does not buzz";
  }
}

TEST(ImpedanceLoop, InFreeMotionNoForceIsRendered) {
  ImpedanceBench bench;
  bench.push_W_N = -5.0 * bench.feed_W;
  const control::TickRecord record = bench.Run(300);
  EXPECT_FALSE(bench.loop.faults().Any());
  EXPECT_EQ(Vector3(record.F_coupling_T_W.f).norm(), 0.0);
  const Pose seen = bench.loop.tool_command().X_WT;
  EXPECT_LT((seen.translation() - Pose(record.X_WT_meas).translation()).norm(), 1e-12);
  EXPECT_LT(bench.Depth(), -0.01) << "it goes where the hand pulls it";
}

TEST(ImpedanceLoop, NeverSendsAForceBeyondTheLimit) {
  control::ServoParams params = Params();
  params.wrench.max_force_N = 50.0;
  ImpedanceBench bench(params);
  bench.push_W_N = 150.0 * bench.feed_W;
  bench.Run(200);
  EXPECT_GT(bench.peak_sent_N, 49.0);
  EXPECT_LE(bench.peak_sent_N, 50.0 * (1.0 + 1e-12));
}

TEST(ImpedanceLoop, BrakesBeyondTheSpeedLimitAndStopsAtOneAndAHalfTimes) {
  control::ServoParams params = Params();
  params.twist.max_speed_m_per_s = 0.05;
  ImpedanceBench bench(params);
  bench.push_W_N = -8.0 * bench.feed_W;
  bench.Run(600);
  EXPECT_FALSE(bench.loop.faults().Any());
  // The force balance at the speed v is 8 N = 10 v + 250 (v - 0.05) + the arm's own losses. Without losses, v
  // would be 0.079 m/s. The cell stops at 1.5 times the limit, 0.075 m/s.
  EXPECT_LT(bench.loop.statistics().peak_tool_speed_m_per_s, 0.075);
  EXPECT_GT(bench.loop.statistics().limits.Of(safety::Limit::kToolSpeed).ticks, 100u);

  bench.push_W_N = -120.0 * bench.feed_W;
  bench.Run(400);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kToolSpeed));
  bench.push_W_N.setZero();
  bench.Run(6000);  // a soft arm oscillates for some seconds
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
}

TEST(ImpedanceLoop, AfterAStopNoWrenchIsSentAndTheArmRests) {
  ImpedanceBench bench;
  bench.push_W_N = -8.0 * bench.feed_W;
  bench.Run(200);
  bench.push_W_N.setZero();
  bench.loop.RequestStop();
  bench.Run(4000);  // the simulated arm is soft in its null space, so the elbow still oscillates
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
  EXPECT_EQ(Vector3(bench.command.F.f).norm(), 0.0);
  const Vector3 before = bench.Tool().translation();
  bench.Run(1);
  EXPECT_LT((bench.Tool().translation() - before).norm(), 1e-3 * kPeriod_s) << "below 1 mm/s";
  EXPECT_FALSE(bench.loop.faults().Any());
}

// With four cycles of dead time, a brake with its full gain of 250 N·s/m would accelerate the wrist to four
// times its initial speed, and the arm would keep oscillating.
TEST(ImpedanceLoop, AStopDoesNotShakeAToolThatNobodyHolds) {
  for (const CommandMode mode : {CommandMode::kWrench, CommandMode::kTorque}) {
    ImpedanceBench bench(Params(), mode, 4);
    bench.push_W_N = -3.0 * bench.feed_W;
    bench.Run(200);
    bench.push_W_N.setZero();
    bench.loop.RequestStop();
    double peak_m_per_s = 0.0;
    Vector3 before = bench.Tool().translation();
    bench.Run(1);
    const double start_m_per_s = (bench.Tool().translation() - before).norm() / kPeriod_s;
    for (int i = 0; i < 400; ++i) {
      before = bench.Tool().translation();
      bench.Run(1);
      peak_m_per_s = std::max(peak_m_per_s, (bench.Tool().translation() - before).norm() / kPeriod_s);
    }
    EXPECT_GT(start_m_per_s, 0.02);
    EXPECT_LT(peak_m_per_s, 2.0 * start_m_per_s) << static_cast<int>(mode);
    EXPECT_FALSE(bench.loop.faults().Any());
  }
}

TEST(ImpedanceLoop, AnArmInAnUnsuitableCommandModeIsAFault) {
  ImpedanceBench wrong(Params(), CommandMode::kPosition);
  wrong.Run(5);
  EXPECT_TRUE(wrong.loop.faults().Has(Fault::kCommandMode));
  EXPECT_EQ(wrong.loop.phase(), Phase::kStopped);

  control::ServoParams admittance = Params();
  admittance.law = control::Law::kAdmittance;
  ImpedanceBench compliant(admittance, CommandMode::kWrench);
  compliant.Run(5);
  EXPECT_TRUE(compliant.loop.faults().Has(Fault::kCommandMode));
}

TEST(ImpedanceLoop, ASilentSimulationStopsTheLoop) {
  ImpedanceBench bench;
  bench.push_W_N = 20.0 * bench.feed_W;
  bench.Run(1000);
  const double before_N = Vector3(bench.command.F.f).norm();
  EXPECT_GT(before_N, 15.0);
  for (int i = 0; i < 400; ++i) {
    bench.model.pose_stamp = 0;
    const rt::Nanoseconds frozen = bench.now;
    control::ArmState& state = bench.state;
    bench.now += rt::kMillisecond;
    state.stamp = bench.now;
    ++state.sequence;
    bench.readings.force.stamp = bench.now;
    simulation::ContactModel stale = bench.model;
    stale.pose_stamp = frozen - i * rt::kMillisecond;
    bench.loop.Tick({.state = state,
                     .received = control::ReceiveResult::kOk,
                     .readings = bench.readings,
                     .model = stale,
                     .now = bench.now},
                    bench.command);
  }
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kModelStale));
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
  EXPECT_EQ(Vector3(bench.command.F.f).norm(), 0.0);
}

// For one tick the measured position of a joint is NaN.
TEST(ImpedanceLoop, APositionThatIsNotANumberCausesAStopWithoutWrench) {
  for (const CommandMode mode : {CommandMode::kWrench, CommandMode::kTorque}) {
    ImpedanceBench bench(Params(), mode);
    bench.push_W_N = 20.0 * bench.feed_W;
    bench.Run(1000);
    const auto sent = [&] {
      return Vector3(bench.command.F.f).norm() +
             Eigen::Map<const JointVector>(bench.command.tau.data()).norm();
    };
    ASSERT_GT(sent(), 5.0);
    bench.state.q_meas[2] = std::nan("");
    bench.now += rt::kMillisecond;
    bench.state.stamp = bench.now;
    bench.readings.force.stamp = bench.now;
    bench.loop.Tick({.state = bench.state,
                     .received = control::ReceiveResult::kOk,
                     .readings = bench.readings,
                     .model = bench.model,
                     .now = bench.now},
                    bench.command);
    EXPECT_EQ(sent(), 0.0) << "neither what is no number nor the wrench of the tick before";
    EXPECT_TRUE(bench.loop.faults().Has(Fault::kNotFinite));
    bench.Run(6000);
    EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
  }
}

TEST(ImpedanceLoop, DoesNotAllocate) {
  ImpedanceBench bench(Params(), CommandMode::kTorque);
  bench.push_W_N = 20.0 * bench.feed_W;
  bench.Run(100);
  rt::CheckedNoAllocScope no_alloc;
  bench.Run(50);
}

}  // namespace
}  // namespace osteon::hil
