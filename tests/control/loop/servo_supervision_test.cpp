// Tests what the servo loop supervises in each state of the cell: a hand that rests on the handle, sensor and
// spindle on the path to the start, the hand's force during a stop, and an arm in impedance control that a
// hand moves.

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "servo_bench.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::control {
namespace {

using kinematics::JointVector;
using safety::CellState;
using safety::Fault;
using safety::MotionPermit;

// --- a hand rests on the handle: its constant push must not be mistaken for the force sensor's bias

TEST(RestingHand, IsNotTakenForABiasInARecovery) {
  ServoBench bench(ServoBench::Params(), 10.0);
  bench.Run(600);
  bench.Activate();
  bench.Run(100);
  ASSERT_EQ(bench.loop.phase(), Phase::kHaptic);
  bench.arm.session = SessionState::kCommandingWait;
  bench.Run(50);
  ASSERT_TRUE(bench.loop.CanRecover());
  bench.loop.RequestRecovery();
  bench.push_N = 8.0;  // a constant push, longer than the rest of 0.5 s after which the bias is estimated
  const TickRecord waited = bench.Run(1000);
  EXPECT_EQ(Vector3(waited.F_bias_S.f), Vector3::Zero());
  ++bench.arm.activation;
  bench.Activate();
  bench.Run(20);
  ASSERT_EQ(bench.loop.phase(), Phase::kHaptic);
  bench.push_N = 0.0;
  bench.Run(1500);  // the virtual tool's drag reduces the speed that the push has caused
  EXPECT_LT(Vector3(bench.Tick().v_WT_cmd_m_per_s).norm(), 1e-4)
      << "nobody holds the tool: it does not creep";
}

TEST(RestingHand, IsNotTakenForABiasInAPause) {
  ServoBench bench(ServoBench::Params(), 10.0);
  bench.Run(600);
  bench.Activate();
  bench.Run(100);
  bench.loop.RequestPause();
  bench.Run(100);
  ASSERT_EQ(bench.loop.state(), CellState::kPaused);
  bench.push_N = 8.0;
  bench.Run(1000);
  bench.loop.RequestResume();
  const TickRecord record = bench.Run(100);
  EXPECT_EQ(Vector3(record.F_bias_S.f), Vector3::Zero());
  EXPECT_GT(Vector3(record.v_WT_cmd_m_per_s).norm(), 1e-3) << "a hand that pushes moves the tool";
}

TEST(RestingHand, PreventsTheFirstMotionUntilItLetsGo) {
  ServoBench bench(ServoBench::Params(), 10.0);
  bench.push_N = 8.0;
  bench.Run(600);
  bench.Activate();
  bench.Run(100);
  EXPECT_FALSE(bench.loop.permits().Has(MotionPermit::kHandOff));
  EXPECT_EQ(bench.loop.phase(), Phase::kWaiting);
  bench.push_N = 0.0;
  bench.Run(510);
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
  EXPECT_LT(Vector3(bench.Run(500).v_WT_cmd_m_per_s).norm(), 1e-4);
}

TEST(RestingHand, APushTakenForABiasMovesAFreeToolNoFasterThanACreep) {
  // 0.99 N is just below the largest accepted bias, 1 N: the drag of 20 N s/m at 50 mm/s
  ServoBench bench(ServoBench::Params(), 10.0);
  bench.push_N = 0.99;
  bench.Run(600);
  bench.Activate();
  bench.Run(50);
  ASSERT_EQ(bench.loop.phase(), Phase::kHaptic);
  bench.push_N = 0.0;
  double fastest_m_per_s = 0.0;
  for (int i = 0; i < 1500; ++i)
    fastest_m_per_s = std::max(fastest_m_per_s, Vector3(bench.Tick().v_WT_cmd_m_per_s).norm());
  EXPECT_GT(fastest_m_per_s, 0.04) << "it was believed";
  EXPECT_LE(fastest_m_per_s, 0.05);
}

// --- on the path to the start

// A cell whose arm moves along its start path.
class StartPathSupervision : public ::testing::Test {
 protected:
  static ServoParams Params() {
    ServoParams params = ServoBench::Params();
    JointVector goal = ServoBench::StartJoints();
    goal[0] += 0.3;
    params.arm_body = kinematics::ChainFrom(ServoBench::Arm().params());
    params.start = StartParams{.q = goal, .path = {}};
    params.workspace.sphere_radius_m = 1.0;
    params.workspace.plane_offset_m = -1.0;
    params.has_spindle = true;
    return params;
  }
  StartPathSupervision() {
    Run(5);
    bench.Activate();
    Run(100);
    EXPECT_EQ(bench.loop.state(), CellState::kAligning);
  }
  TickRecord Run(int count) {
    TickRecord record;
    for (int i = 0; i < count; ++i) {
      bench.readings.spindle = spindle;
      bench.readings.spindle.stamp = bench.now + ServoBench::kTick;
      record = bench.Tick();
    }
    return record;
  }
  // Runs one tick. @returns the largest change of a joint's command [rad]
  [[nodiscard]] double MaxJointStep_rad() {
    const JointVector before = Eigen::Map<const JointVector>(bench.command.q.data());
    Run(1);
    return (Eigen::Map<const JointVector>(bench.command.q.data()) - before).cwiseAbs().maxCoeff();
  }

  SpindleReading spindle{.ready = true};
  ServoBench bench{Params(), 10.0};
};

TEST_F(StartPathSupervision, AHandBeyondItsLimitStopsTheArm) {
  bench.push_N = 400.0;
  Run(5);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kSensorForce));
  EXPECT_EQ(bench.loop.state(), CellState::kStop1);
  Run(1000);
  EXPECT_EQ(bench.loop.state(), CellState::kFault);
  EXPECT_EQ(MaxJointStep_rad(), 0.0);
}

TEST_F(StartPathSupervision, APushOnTheHandlePausesTheStartPath) {
  ASSERT_GT(MaxJointStep_rad(), 0.0);
  bench.push_N = 60.0;
  Run(600);  // duration of the path's pause
  EXPECT_EQ(MaxJointStep_rad(), 0.0);
  EXPECT_FALSE(bench.loop.faults().Any());
  EXPECT_EQ(bench.loop.state(), CellState::kAligning);
  bench.push_N = 0.0;
  Run(600);
  EXPECT_GT(MaxJointStep_rad(), 0.0);
}

TEST_F(StartPathSupervision, ASilentSensorStopsTheArm) {
  bench.sensor_lives = false;
  Run(150);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kSensorStale));
  EXPECT_NE(bench.loop.state(), CellState::kAligning);
}

TEST_F(StartPathSupervision, AnOverloadedSensorStopsTheArm) {
  bench.sensor_lives = false;
  bench.readings.force.stamp = bench.now + ServoBench::kTick;
  bench.readings.force.trusted = false;
  Run(2);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kSensorFault));
}

TEST_F(StartPathSupervision, ASpindleFaultStopsTheArm) {
  spindle.fault = true;
  Run(2);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kSpindle));
  EXPECT_EQ(bench.loop.state(), CellState::kStop1);
}

// The stop is slow (0.4 m/s^2), so the hand's force exceeds its limit while the arm is still braking.
TEST(StopSupervision, AHandBeyondItsLimitInAnOrderlyStopIsAFault) {
  ServoParams params = ServoBench::Params();
  params.stop_deceleration_m_per_s2 = 0.4;
  params.workspace.deceleration_m_per_s2 = 0.4;
  ServoBench bench(params, 10.0);
  bench.Run(600);
  bench.Activate();
  bench.push_N = 20.0;
  bench.Run(150);
  ASSERT_EQ(bench.loop.phase(), Phase::kHaptic);
  bench.loop.RequestStop();
  bench.push_N = 400.0;
  bench.Run(20);
  ASSERT_EQ(bench.loop.phase(), Phase::kStopping);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kSensorForce));
  bench.Run(1000);
  EXPECT_EQ(bench.loop.state(), CellState::kFault);
}

// A comparison with NaN is false, so a limit on the torque alone would not detect the NaN.
TEST(ArmTorques, ATorqueThatIsNotANumberIsAFault) {
  ServoBench bench(ServoBench::Params(), 10.0);
  bench.Run(5);
  bench.Activate();
  bench.Run(50);
  bench.arm.tau_ext[3] = std::numeric_limits<double>::quiet_NaN();
  bench.Run(1);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kNotFinite));
  bench.arm.tau_ext[3] = 0.0;
  bench.Run(500);
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
}

// --- an arm in impedance control

// The hand turns the arm about its axis A1 at a given speed. The loop follows the measured position.
class HandLedArm : public ::testing::Test {
 protected:
  static ServoParams Params() {
    ServoParams params = ServoBench::Params();
    params.law = Law::kImpedance;
    params.impedance.twist_filter_s = 0.0;
    params.workspace.sphere_radius_m = 1.0;
    params.workspace.plane_offset_m = -1.0;
    return params;
  }
  HandLedArm() {
    bench.arm.command_mode = CommandMode::kWrench;
    bench.arm_moves = false;
    bench.Run(5);
    bench.Activate();
    bench.Run(200);
    EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
  }
  // Runs one tick in which the hand moves the arm. The arm's message may be lost.
  TickRecord Lead(ReceiveResult received = ReceiveResult::kOk) {
    bench.arm.q_meas[0] += speed_rad_per_s * 1e-3;
    if (received != ReceiveResult::kOk) ++bench.arm.lost;
    const std::array<double, 7> q = bench.arm.q_meas;
    const TickRecord record = bench.Tick(received);
    bench.arm.q_meas = q;
    return record;
  }
  // Speed of the tool's apex on its circle about A1.
  [[nodiscard]] double Speed_m_per_s() const {
    return std::abs(speed_rad_per_s) * Vector3(bench.ToolNow().translation()).head<2>().norm();
  }

  double speed_rad_per_s{0.0};
  ServoBench bench{Params(), 10.0};
};

TEST_F(HandLedArm, LostMessagesDoNotRaiseTheMeasuredVelocity) {
  speed_rad_per_s = 0.9 * ServoBench::Params().twist.max_speed_m_per_s /
                    Vector3(bench.ToolNow().translation()).head<2>().norm();
  // the distance over a gap of 1 to 4 lost messages must not count as the distance of one tick
  for (int round = 0; round < 30; ++round) {
    for (int i = 0; i < 20; ++i) {
      const TickRecord record = Lead();
      ASSERT_LT(Vector3(record.v_WT_cmd_m_per_s).norm(), 1.01 * Speed_m_per_s()) << round << ", " << i;
    }
    for (int i = 0; i < 1 + round % 4; ++i) Lead(ReceiveResult::kTimeout);
  }
  EXPECT_FALSE(bench.loop.faults().Any()) << "below the limit there is no trip";
}

// While messages are lost, the pose keeps its old time stamp, so that the simulation sees its age.
TEST_F(HandLedArm, APoseKeepsItsTimeStampWhileMessagesAreLost) {
  speed_rad_per_s = 0.05;
  Lead();
  const rt::Nanoseconds measured_at = bench.loop.tool_command().stamp;
  const Pose X = bench.loop.tool_command().X_WT;
  EXPECT_EQ(measured_at, bench.now);
  for (int i = 0; i < 3; ++i) {
    Lead(ReceiveResult::kTimeout);
    EXPECT_EQ(bench.loop.tool_command().stamp, measured_at);
    EXPECT_TRUE(Pose(bench.loop.tool_command().X_WT).isApprox(X, 1e-15));
  }
  Lead();
  EXPECT_EQ(bench.loop.tool_command().stamp, bench.now);
}

TEST_F(HandLedArm, AStopEndsOnceTheArmIsMeasuredAtRest) {
  speed_rad_per_s = 0.1;
  for (int i = 0; i < 50; ++i) Lead();
  bench.loop.RequestStop();
  for (int i = 0; i < 500; ++i) Lead();  // meanwhile the hand moves the arm on
  EXPECT_EQ(bench.loop.phase(), Phase::kStopping) << "it moves at " << Speed_m_per_s() << " m/s";
  speed_rad_per_s = 0.0;
  for (int i = 0; i < 15; ++i) Lead();
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
  EXPECT_FALSE(bench.loop.faults().Any());
}

// A hand pushes a paused arm away. That is no fault, but the arm must be brought back before rendering
// resumes.
TEST_F(HandLedArm, APausedArmThatAHandPushesAwayResumesOnlyWhereItPaused) {
  bench.loop.RequestPause();
  for (int i = 0; i < 200; ++i) Lead();
  ASSERT_EQ(bench.loop.state(), CellState::kPaused);
  const JointVector held = Eigen::Map<const JointVector>(bench.arm.q_meas.data());
  speed_rad_per_s = 0.1;
  for (int i = 0; i < 1200; ++i) Lead();  // 0.12 rad move the apex by at least 80 mm
  EXPECT_FALSE(bench.loop.faults().Any());
  EXPECT_EQ(bench.loop.state(), CellState::kPaused);
  speed_rad_per_s = 0.0;
  bench.loop.RequestResume();
  for (int i = 0; i < 50; ++i) Lead();
  EXPECT_EQ(bench.loop.phase(), Phase::kWaiting) << "not where it would go on from";
  EXPECT_FALSE(bench.loop.permits().Has(MotionPermit::kPosePlausible));
  Eigen::Map<JointVector>(bench.arm.q_meas.data()) = held;
  for (int i = 0; i < 50; ++i) Lead();
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
}

}  // namespace
}  // namespace osteon::control
