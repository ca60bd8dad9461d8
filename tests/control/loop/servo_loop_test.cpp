#include "control/loop/servo_loop.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "servo_bench.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests the whole servo loop: start, contact, limits, stops, and partners that are silent or faulty.

namespace osteon::control {
namespace {

using kinematics::JointVector;
using safety::Fault;

JointVector Joints(const std::array<double, 7>& q) { return Eigen::Map<const JointVector>(q.data()); }

// Largest ratio of a commanded joint's speed to its limit, for a step of 1 ms.
double MaxJointSpeedRatio(const std::array<double, 7>& before, const std::array<double, 7>& after) {
  double ratio = 0.0;
  for (std::size_t i = 0; i < 7; ++i)
    ratio = std::max(
        ratio, std::abs(after[i] - before[i]) / 0.001 / kinematics::Iiwa14().limits[i].velocity_rad_per_s);
  return ratio;
}

TEST(ServoLoop, FollowsTheWaitingArmAndStartsWithoutAJump) {
  ServoBench bench;
  TickRecord record = bench.Run(5);
  EXPECT_EQ(record.phase, Phase::kWaiting);
  EXPECT_EQ(record.q_cmd, bench.arm.q_ipo);
  EXPECT_EQ(bench.loop.tool_command().spindle_rad_per_s, 0.0);

  // as on a real arm, the measured position lags a little behind the interpolator's position
  bench.arm.q_ipo[1] += 1e-3;
  const auto q_ipo = bench.arm.q_ipo;
  bench.Activate();
  record = bench.Tick();
  EXPECT_EQ(record.phase, Phase::kHaptic);
  EXPECT_LT((Joints(record.q_cmd) - Joints(q_ipo)).norm(), 1e-9) << "starts where the arm commands itself";
  record = bench.Run(20);
  const Pose X_WT = ServoBench::Arm().FlangePose(Joints(q_ipo)) * ServoBench::FlangeToTool();
  EXPECT_LT((Pose(record.X_WT_cmd).matrix() - X_WT.matrix()).norm(), 1e-9)
      << "the tool stays while nobody pushes";
  EXPECT_EQ(record.faults, 0u);
}

TEST(ServoLoop, TurnsToTheWantedArmAngleSlowlyFromAnyOther) {
  const double start = ServoBench::Arm().ArmAngle(ServoBench::StartJoints());
  ServoLoop loop(ServoBench::Params(), ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                 start + 0.02);
  ServoBench bench;  // the bench supplies messages and models
  bench.Activate();
  ArmCommand command{.q = bench.arm.q_ipo};
  for (int i = 0; i < 500; ++i) {
    bench.Tick();
    ArmState arm = bench.arm;
    arm.q_meas = command.q;
    const auto before = command.q;
    const TickRecord record = loop.Tick({.state = arm,
                                         .received = ReceiveResult::kOk,
                                         .readings = bench.readings,
                                         .model = bench.model,
                                         .now = bench.now},
                                        command);
    ASSERT_EQ(record.faults, 0u);
    ASSERT_LT(MaxJointSpeedRatio(before, command.q), 0.2);
  }
  EXPECT_NEAR(ServoBench::Arm().ArmAngle(Joints(command.q)), start + 0.02, 1e-6);
  const Pose X_WT = ServoBench::Arm().FlangePose(Joints(command.q)) * ServoBench::FlangeToTool();
  EXPECT_LT((X_WT.translation() - ServoBench::StartPose().translation()).norm(), 1e-9) << "the tool stays";
}

TEST(ServoLoop, Presses120NIntoAPlaneAndSettlesWithoutPassingTheLimit) {
  ServoBench bench;
  bench.Activate();
  bench.push_N = 120.0;
  double peak_N = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const TickRecord record = bench.Tick();
    ASSERT_EQ(record.faults, 0u) << "tick " << i;
    peak_N = std::max(peak_N, Vector3(record.F_coupling_T_W.f).norm());
  }
  const TickRecord record = bench.Tick();
  EXPECT_NEAR(Vector3(record.F_coupling_T_W.f).norm(), 120.0, 0.1);
  EXPECT_NEAR(bench.Depth(), 120.0 / 20e3, 5e-6);
  EXPECT_LT(Vector3(record.v_WT_cmd_m_per_s).norm(), 1e-5);
  EXPECT_LE(peak_N, 200.0);
  EXPECT_EQ(bench.loop.statistics().peak_coupling_force_N, peak_N);
  EXPECT_NEAR(bench.loop.statistics().peak_sensor_force_N, 120.0, 1e-9);
  EXPECT_LE(bench.loop.statistics().peak_tool_speed_m_per_s, 0.25 * (1.0 + 1e-9));
}

TEST(ServoLoop, TheRecordedPoseIsThatOfTheCommandedJoints) {
  ServoBench bench;
  bench.Activate();
  bench.push_N = -60.0;
  bench.side_W_N = Vector3(20.0, 30.0, 0.0);
  for (int i = 0; i < 2000; ++i) {
    const TickRecord record = bench.Tick();
    const Pose of_joints = ServoBench::Arm().FlangePose(Joints(record.q_cmd)) * ServoBench::FlangeToTool();
    ASSERT_LT((of_joints.matrix() - Pose(record.X_WT_cmd).matrix()).norm(), 1e-9) << "tick " << i;
    ASSERT_EQ(record.faults, 0u) << "tick " << i;
  }
  EXPECT_GT(bench.loop.statistics().limits.Of(safety::Limit::kWorkspace).ticks, 0u)
      << "it was pushed to its bound";
  EXPECT_GT(bench.loop.statistics().limits.Of(safety::Limit::kToolSpeed).ticks, 0u);
}

TEST(ServoLoop, PushedTowardsAJointLimitItSlowsDownAndStaysInside) {
  ServoParams params = ServoBench::Params();
  params.workspace.sphere_radius_m = 2.0;
  params.workspace.plane_offset_m = -2.0;
  const double start_a4 = std::abs(ServoBench::StartJoints()[3]);
  params.joints.limits[3].upper_rad = start_a4 + 0.15;
  params.joints.limits[3].lower_rad = -params.joints.limits[3].upper_rad;
  ServoBench bench(params, 10.0);
  bench.Activate();
  // a push toward the shoulder bends the arm until joint A4 reaches its limit
  bench.side_W_N = -40.0 * (ServoBench::StartPose().translation() - Vector3(0.0, 0.0, 0.36)).normalized();
  double before = start_a4;
  for (int i = 0; i < 3000; ++i) {
    const TickRecord record = bench.Tick();
    ASSERT_EQ(record.faults, 0u) << "tick " << i;
    ASSERT_GE(std::abs(record.q_cmd[3]), before - 1e-9) << "monotone: no chatter";
    before = std::abs(record.q_cmd[3]);
    ASSERT_LE(before, start_a4 + 0.15 - params.joints.position_margin_rad + 1e-9);
  }
  EXPECT_GT(before, start_a4 + 0.15 - params.joints.position_margin_rad - 2e-3) << "and gets there";
  EXPECT_GT(bench.loop.statistics().limits.Of(safety::Limit::kJoints).ticks, 0u);

  // the virtual tool's velocity has been reduced to the limited motion, so there is no wind-up
  EXPECT_LT(Vector3(bench.Tick().v_WT_cmd_m_per_s).norm(), 0.01);
  bench.side_W_N *= -1.0;
  bench.Run(3);
  EXPECT_LT(std::abs(bench.Tick().q_cmd[3]), before) << "pulled back it leaves at once";
}

// Oracle: the stopping distance v² / 2a, with the speed v and the deceleration a.
TEST(ServoLoop, AStopEndsOnItsLineAtTheComputedDistance) {
  ServoBench bench(ServoBench::Params(), 1.0);
  bench.Activate();
  bench.push_N = 4.0;  // 4 N against the drag of 20 N s/m: the speed approaches 0.2 m/s
  const TickRecord moving = bench.Run(500);
  const double v = Vector3(moving.v_WT_cmd_m_per_s).norm();
  ASSERT_GT(v, 0.15);
  const Vector3 from = Pose(moving.X_WT_cmd).translation();
  bench.loop.RequestStop();
  TickRecord record = bench.Tick();
  EXPECT_EQ(record.phase, Phase::kStopping);
  double speed = v;
  while (record.phase == Phase::kStopping) {
    const double now_v = Vector3(record.v_WT_cmd_m_per_s).norm();
    ASSERT_NEAR(speed - now_v, 3.0 * 0.001, 1e-9) << "constant deceleration";
    speed = now_v;
    record = bench.Tick();
  }
  EXPECT_EQ(record.phase, Phase::kStopped);
  const Vector3 travel = Pose(record.X_WT_cmd).translation() - from;
  EXPECT_NEAR(travel.norm(), v * v / (2.0 * 3.0), v * 0.001) << "within a tick's way";
  EXPECT_LT(travel.cross(bench.feed_W).norm(), 1e-9) << "on the same line";
  EXPECT_EQ(record.faults, 0u) << "asked for: no fault";
  const auto held = record.q_cmd;
  EXPECT_EQ(bench.Run(100).q_cmd, held) << "holds, although the hand still pushes";
}

TEST(ServoLoop, AStopInContactEndsRenderingAndStopsTheSpindle) {
  ServoParams params = ServoBench::Params();
  params.spindle_rad_per_s = 26.18;
  ServoBench bench(params);
  bench.Activate();
  bench.push_N = 120.0;
  EXPECT_EQ(bench.Run(2000).spindle_rad_per_s, 26.18);
  bench.loop.RequestStop();
  const TickRecord record = bench.Run(200);
  EXPECT_EQ(record.phase, Phase::kStopped);
  EXPECT_EQ(record.spindle_rad_per_s, 0.0);
  EXPECT_EQ(bench.loop.tool_command().spindle_rad_per_s, 0.0);
  EXPECT_TRUE(Vector3(record.F_coupling_T_W.f).isZero(0.0));
}

TEST(ServoLoop, AStopRequestBeforeTheArmIsActivePreventsRendering) {
  ServoBench bench;
  bench.Run(3);
  bench.loop.RequestStop();
  EXPECT_EQ(bench.Tick().phase, Phase::kStopped);
  bench.Activate();
  EXPECT_EQ(bench.Run(10).phase, Phase::kStopped);
}

// Up to a model age of 20 ms the full coupling acts. From 60 ms on nothing is rendered and the tool is held
// in place. At 250 ms the cell stops.
TEST(ServoLoop, AStalledSimulationFadesThenHoldsThenStops) {
  ServoBench bench;
  bench.Activate();
  bench.push_N = 120.0;
  bench.Run(3000);
  bench.simulation_lives = false;
  bench.push_N = 60.0;  // the hand reduces its push: the full spring force would now throw it back
  const Vector3 contact = Pose(bench.loop.tool_command().X_WT).translation();
  double before_N = 1e9, returned_J = 0.0;
  Vector3 held = contact, p_before = contact;
  for (int i = 0; i < 400; ++i) {
    const TickRecord record = bench.Tick();
    const double f_N = Vector3(record.F_coupling_T_W.f).norm();
    const Vector3 p = Pose(record.X_WT_cmd).translation();
    returned_J += Vector3(record.F_coupling_T_W.f).dot(p - p_before);
    p_before = p;
    if (record.model_age_s > 0.020) {
      ASSERT_LE(f_N, before_N + 1e-9);
    }
    before_N = f_N;
    if (record.model_age_s >= 0.0605 && record.model_age_s < 0.0615) held = p;
    if (record.model_age_s > 0.0605 && record.model_age_s <= 0.250) {
      ASSERT_EQ(record.phase, Phase::kHaptic);
      ASSERT_EQ(f_N, 0.0);
      ASSERT_EQ((p - held).norm(), 0.0) << "held, although the hand pushes";
    }
    if (record.model_age_s > 0.2515 && record.model_age_s < 1.0) {
      ASSERT_NE(record.phase, Phase::kHaptic);
      ASSERT_EQ(record.faults, static_cast<std::uint32_t>(Fault::kModelStale));
    }
  }
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
  EXPECT_LE(returned_J, 0.36) << "no more than the spring had stored: F^2 / 2K";
}

// The simulation stalls during contact, for up to 200 ms, and then continues.
TEST(ServoLoop, AfterAStallTheForceRisesWithoutAJump) {
  for (const int stall_ticks : {20, 60, 120, 200}) {
    ServoBench bench;
    bench.Activate();
    bench.push_N = 120.0;
    bench.Run(3000);
    bench.simulation_lives = false;
    bench.Run(stall_ticks);
    bench.simulation_lives = true;
    double before_N = Vector3(bench.Tick().F_coupling_T_W.f).norm(), peak_N = before_N;
    for (int i = 0; i < 1000; ++i) {
      const TickRecord record = bench.Tick();
      const double f_N = Vector3(record.F_coupling_T_W.f).norm();
      ASSERT_EQ(record.faults, 0u);
      ASSERT_LT(f_N - before_N, 2.0) << "1.2 N a tick are the ramp's";
      before_N = f_N;
      peak_N = std::max(peak_N, f_N);
    }
    EXPECT_LT(peak_N, 1.1 * 120.0) << "stall of " << stall_ticks << " ms";
    EXPECT_NEAR(before_N, 120.0, 1.0);
  }
}

TEST(ServoLoop, WithoutAModelRenderingDoesNotBegin) {
  ServoBench bench;
  bench.simulation_lives = false;
  bench.Activate();
  bench.push_N = 50.0;
  const TickRecord record = bench.Run(260);
  EXPECT_EQ(record.phase, Phase::kWaiting);
  EXPECT_EQ(record.q_cmd, bench.arm.q_ipo);
  EXPECT_FALSE(bench.loop.faults().Any());
  bench.simulation_lives = true;
  EXPECT_EQ(bench.Run(3).phase, Phase::kHaptic);
}

TEST(ServoLoop, ASilentSensorStopsAfter100Milliseconds) {
  ServoBench bench(ServoBench::Params(), 1.0);
  bench.Activate();
  bench.push_N = 3.0;
  bench.Run(300);
  bench.sensor_lives = false;
  TickRecord record = bench.Run(99);
  EXPECT_EQ(record.faults, 0u);
  EXPECT_NEAR(record.sensor_age_s, 0.099, 1e-9);
  record = bench.Run(2);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kSensorStale));
  EXPECT_EQ(bench.Run(200).phase, Phase::kStopped);
}

TEST(ServoLoop, ASilentArmIsHeldAndIsAFaultAfterFiveMessages) {
  ServoBench bench(ServoBench::Params(), 1.0);
  bench.Activate();
  bench.push_N = 3.0;
  const TickRecord before = bench.Run(300);
  TickRecord record;
  for (int i = 0; i < 4; ++i) {
    record = bench.Tick(ReceiveResult::kTimeout);
    EXPECT_EQ(record.q_cmd, before.q_cmd) << "holds";
    EXPECT_EQ(record.faults, 0u);
  }
  record = bench.Tick(ReceiveResult::kTimeout);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kArmStale));
  EXPECT_EQ(record.phase, Phase::kStopped);
  EXPECT_EQ(bench.Run(20).q_cmd, before.q_cmd) << "holds when it is back, too";
  EXPECT_EQ(bench.loop.statistics().missed_messages, 5u);
}

TEST(ServoLoop, TimeoutsBeforeTheFirstMessageAreNoFault) {
  ServoBench bench;
  for (int i = 0; i < 100; ++i) bench.Tick(ReceiveResult::kTimeout);
  EXPECT_FALSE(bench.loop.faults().Any());
  bench.Activate();
  EXPECT_EQ(bench.Run(4).phase, Phase::kHaptic) << "a frame later";
}

TEST(ServoLoop, AnArmThatLeavesTheSessionIsNotCommandedAgainByItself) {
  ServoBench bench;
  bench.Activate();
  bench.Run(10);
  bench.arm.session = SessionState::kMonitoringReady;
  const TickRecord record = bench.Tick();
  EXPECT_EQ(record.phase, Phase::kStopped);
  EXPECT_EQ(record.faults, static_cast<std::uint32_t>(Fault::kSession));
  bench.Activate();
  bench.push_N = 50.0;
  const auto held = bench.Tick().q_cmd;
  EXPECT_EQ(bench.Run(50).q_cmd, held) << "back in COMMANDING_ACTIVE it holds until told";
}

TEST(ServoLoop, EachFaultStopsTheTool) {
  const auto fault_after = [](const auto& spoil) {
    ServoBench bench;
    bench.Activate();
    bench.push_N = 100.0;
    bench.Run(1000);
    spoil(bench);
    for (int i = 0; i < 20; ++i) bench.Tick();
    EXPECT_NE(bench.loop.phase(), Phase::kHaptic);
    for (int i = 0; i < 300; ++i) bench.Tick();
    EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
    return bench.loop.faults().bits();
  };
  const auto bits = [](Fault fault) { return static_cast<std::uint32_t>(fault); };
  EXPECT_EQ(fault_after([](ServoBench& b) {
              for (; b.push_N < 260.0; b.push_N += 5.0) b.Tick();  // rises as fast as a hand can push
            }),
            bits(Fault::kSensorForce));
  EXPECT_EQ(fault_after([](ServoBench& b) { b.plane_W -= 4e-3 * b.feed_W; }), bits(Fault::kWrenchRate));
  EXPECT_EQ(fault_after([](ServoBench& b) { b.push_N = std::numeric_limits<double>::quiet_NaN(); }),
            bits(Fault::kNotFinite));
  EXPECT_EQ(fault_after([](ServoBench& b) { b.arm.safety_state = 2; }), bits(Fault::kSession));
  EXPECT_EQ(fault_after([](ServoBench& b) {
              b.simulation_lives = false;
              b.model.status = simulation::EngineStatus::kDeviceLost;
            }),
            bits(Fault::kDevice));
}

TEST(ServoLoop, AnArmFarFromItsCommandIsAFault) {
  ServoBench bench;
  bench.Activate();
  bench.Run(10);
  ArmState arm = bench.arm;
  arm.q_meas[0] += 0.1;  // 6 cm at the tool
  bench.loop.Tick({.state = arm,
                   .received = ReceiveResult::kOk,
                   .readings = bench.readings,
                   .model = bench.model,
                   .now = bench.now},
                  bench.command);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kTracking));
}

// A hand pushes the tool outward with 60 N until the arm is stretched out, then sideways as well, and then
// back.
TEST(ServoLoop, AtTheEndOfItsReachTheToolStopsSlidesAndReturns) {
  ServoParams params = ServoBench::Params();
  params.workspace.sphere_radius_m = 3.0;
  params.workspace.plane_offset_m = -3.0;
  ServoBench bench(params, 10.0);
  bench.Activate();
  // vector from the shoulder to the wrist
  const auto p_SW = [](const TickRecord& record) -> Vector3 {
    return ServoBench::Arm().FlangePose(Joints(record.q_cmd)) *
               Vector3(0, 0, -kinematics::Iiwa14().wrist_to_flange_m) -
           Vector3(0.0, 0.0, kinematics::Iiwa14().base_to_shoulder_m);
  };
  const double reach_m = kinematics::Iiwa14().shoulder_to_elbow_m + kinematics::Iiwa14().elbow_to_wrist_m;
  auto before = bench.arm.q_meas;
  Vector3 v_before = Vector3::Zero();
  double jump_m_per_s = 0.0;
  const auto run = [&](int ticks) {
    TickRecord record;
    for (int i = 0; i < ticks; ++i) {
      record = bench.Tick();
      EXPECT_EQ(record.faults, 0u) << record.tick;
      EXPECT_LE(MaxJointSpeedRatio(before, record.q_cmd), 0.9 + 1e-9) << record.tick;
      jump_m_per_s = std::max(jump_m_per_s, (Vector3(record.v_WT_cmd_m_per_s) - v_before).norm());
      v_before = record.v_WT_cmd_m_per_s;
      before = record.q_cmd;
    }
    return record;
  };
  const Vector3 outward = (ServoBench::StartPose().translation() - Vector3(0.0, 0.0, 0.36)).normalized();
  bench.side_W_N = 60.0 * outward;
  EXPECT_GT(p_SW(run(6000)).norm(), reach_m - 1e-4) << "all of the reach is used";
  const Vector3 stopped = bench.loop.tool_command().X_WT.p;
  bench.side_W_N += 5.0 * Vector3::UnitZ().cross(outward);
  EXPECT_GT((Vector3(run(500).X_WT_cmd.p) - stopped).norm(), 0.02) << "it slides";
  bench.side_W_N = -20.0 * outward;
  EXPECT_LT(p_SW(run(500)).norm(), reach_m - 0.015) << "and is not held there";
  // in one tick, 60 N change the speed of 3 kg by 20 mm/s
  EXPECT_LT(jump_m_per_s, 0.02 + 1e-9);
}

TEST(ServoLoop, TwoRunsAreBitIdentical) {
  const auto run = [](auto& records) {
    ServoParams params = ServoBench::Params();
    params.spindle_rad_per_s = 26.18;
    ServoBench bench(params);
    bench.Activate();
    for (int i = 0; i < 1500; ++i) {
      bench.push_N = 80.0 + 40.0 * std::sin(0.01 * i);
      bench.side_W_N = Vector3(10.0 * std::sin(0.003 * i), 5.0, 0.0);
      records.push_back(bench.Tick());
    }
  };
  std::vector<TickRecord> a, b;
  run(a);
  run(b);
  EXPECT_GT(Vector3(a.back().F_coupling_T_W.f).norm(), 1.0) << "the bone was felt";
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].q_cmd, b[i].q_cmd) << "tick " << i;
    ASSERT_EQ(Vector3(a[i].F_coupling_T_W.f), Vector3(b[i].F_coupling_T_W.f));
    ASSERT_EQ(Vector3(a[i].F_coupling_T_W.t), Vector3(b[i].F_coupling_T_W.t));
  }
}

TEST(ServoLoop, NoTickAllocatesOrLocksInAnyPhase) {
  ServoBench bench;
  const auto run = [&](int count, ReceiveResult received = ReceiveResult::kOk) {
    for (int i = 0; i < count; ++i) {
      rt::CheckedNoAllocScope no_alloc;
      const TickRecord record = bench.Tick(received);
      (void)record;
    }
  };
  run(5);
  bench.Activate();
  bench.push_N = 150.0;
  run(1000);
  run(2, ReceiveResult::kTimeout);
  bench.side_W_N = Vector3(50.0, 0.0, 0.0);
  run(1000);
  bench.push_N = 400.0;  // exceeds the limit of the sensor's force, which stops the cell
  run(300);
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
}

TEST(ServoLoop, RefusesParametersOutOfRange) {
  const auto make = [](const ServoParams& params) {
    return ServoLoop(params, ServoBench::Arm(), Pose::Identity(), Pose::Identity(), 0.0);
  };
  ServoParams usable;
  EXPECT_THROW(make(usable), std::invalid_argument) << "the arm's limits have no default";
  usable.joints.limits = ServoBench::Arm().params().limits;
  EXPECT_NO_THROW(make(usable));
  ServoParams params = usable;
  params.workspace.deceleration_m_per_s2 = 10.0;
  EXPECT_THROW(make(params), std::invalid_argument)
      << "the workspace must not count on more than the stop does";
  params = usable;
  params.period_s = 0.0;
  EXPECT_THROW(make(params), std::invalid_argument);
  params = usable;
  params.twist.max_speed_m_per_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(make(params), std::invalid_argument);
  Pose mirrored = Pose::Identity();
  mirrored.matrix()(0, 0) = -1.0;
  EXPECT_THROW(ServoLoop(usable, ServoBench::Arm(), mirrored, Pose::Identity(), 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
