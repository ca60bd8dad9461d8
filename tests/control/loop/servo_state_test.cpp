// Tests the cell's state in the servo loop: every condition of motion, pauses, recoveries, and rest after a
// fault in each state.

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "servo_bench.h"
#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::control {
namespace {

using safety::CellState;
using safety::Fault;
using safety::MotionPermit;

// A cell with spindle drive and PLC. With a start path, its arm first moves along a planned path to its start
// posture.
class ServoState : public ::testing::Test {
 protected:
  enum class StartPath { kNone, kToStart };

  static ServoParams Params(StartPath start_path) {
    ServoParams params = ServoBench::Params();
    params.has_spindle = params.has_interlock = true;
    params.spindle_rad_per_s = 26.0;
    if (start_path == StartPath::kNone) return params;
    kinematics::JointVector goal = ServoBench::StartJoints();
    goal[0] += 0.3;
    params.arm_body = kinematics::ChainFrom(ServoBench::Arm().params());
    params.start = StartParams{.q = goal, .path = {}};
    params.workspace.sphere_radius_m = 1.0;
    params.workspace.plane_offset_m = -1.0;
    return params;
  }

  // The servo bench, with fresh readings of spindle and PLC in every tick. Without a start path, the
  // simulated bone is 5 mm ahead of the tool; with a start path, it is out of reach.
  struct Cell {
    explicit Cell(StartPath start_path = StartPath::kNone)
        : bench(Params(start_path), start_path == StartPath::kNone ? 0.005 : 10.0) {
      bench.arm.activation = 1;
    }
    TickRecord Tick(ReceiveResult received = ReceiveResult::kOk) {
      const rt::Nanoseconds now = bench.now + ServoBench::kTick;
      spindle.stamp = interlock.stamp = now;
      bench.readings.spindle = spindle;
      bench.readings.interlock = interlock;
      const TickRecord record = bench.Tick(received);
      EXPECT_EQ(record.cell_state, static_cast<std::uint8_t>(bench.loop.state()));
      EXPECT_EQ(record.phase, bench.loop.phase());
      return record;
    }
    /// @returns the record of the last tick
    TickRecord Run(int ticks) {
      TickRecord record;
      for (int i = 0; i < ticks; ++i) record = Tick();
      return record;
    }
    // Renders: the arm accepts commands, and the hand pushes the tool toward the bone.
    void Render(double push_N = 60.0, int ticks = 600) {
      bench.Activate();
      bench.push_N = push_N;
      Run(ticks);
    }
    [[nodiscard]] CellState state() const { return bench.loop.state(); }

    ServoBench bench;
    SpindleReading spindle{.speed_rad_per_s = 25.0, .ready = true};
    InterlockReading interlock{.permitted = true, .enabled = true, .spindle_permitted = true};
  };

  // Largest difference of a joint between two postures [rad].
  static double MaxJointDifference_rad(const JointArray& a, const JointArray& b) {
    double max_rad = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) max_rad = std::max(max_rad, std::abs(a[i] - b[i]));
    return max_rad;
  }
};

TEST_F(ServoState, GoesFromOffOverCheckingAndReadyToHapticAndCutting) {
  Cell cell;
  EXPECT_EQ(cell.state(), CellState::kOff);
  cell.Tick(ReceiveResult::kTimeout);
  EXPECT_EQ(cell.state(), CellState::kOff);
  cell.bench.arm.session = SessionState::kIdle;
  cell.Tick();
  cell.bench.command.q = cell.bench.arm.q_meas;  // nothing has been commanded yet
  EXPECT_EQ(cell.state(), CellState::kOff) << "an idle arm does not say where it is";
  cell.bench.arm.session = SessionState::kMonitoringReady;
  cell.interlock.permitted = false;
  cell.Tick();
  EXPECT_EQ(cell.state(), CellState::kChecking);
  cell.interlock.permitted = true;
  cell.Run(3);  // until the simulation has delivered its first frame for a known pose
  EXPECT_EQ(cell.state(), CellState::kReady);
  cell.interlock.permitted = false;
  cell.Tick();
  EXPECT_EQ(cell.state(), CellState::kChecking);
  cell.interlock.permitted = true;
  cell.spindle.speed_rad_per_s = 0.0;
  cell.bench.Activate();
  cell.Tick();
  EXPECT_EQ(cell.state(), CellState::kHaptic);
  cell.spindle.speed_rad_per_s = 25.0;
  cell.Tick();
  EXPECT_EQ(cell.state(), CellState::kCutting);
  EXPECT_EQ(cell.bench.loop.phase(), Phase::kHaptic);
  cell.spindle.speed_rad_per_s = 0.0;
  cell.Tick();
  EXPECT_EQ(cell.state(), CellState::kHaptic);
  cell.bench.loop.RequestStop();
  cell.Run(100);
  EXPECT_EQ(cell.state(), CellState::kOff) << "ended in order";
  EXPECT_EQ(cell.bench.loop.phase(), Phase::kStopped);
}

// If one condition is missing, the arm must not move, and exactly this condition must be reported as missing.
// Once it is restored, motion must start.
TEST_F(ServoState, EachMissingConditionAloneKeepsTheArmAtRest) {
  struct Missing {
    MotionPermit permit;
    std::function<void(Cell&)> remove, restore;
  };
  const std::vector<Missing> all{
      {MotionPermit::kHandedOver, [](Cell& c) { c.bench.arm.safety_state = 2; },
       [](Cell& c) { c.bench.arm.safety_state = 0; }},
      {MotionPermit::kRunPermitted, [](Cell& c) { c.interlock.permitted = false; },
       [](Cell& c) { c.interlock.permitted = true; }},
      {MotionPermit::kRunPermitted, [](Cell& c) { c.interlock.enabled = false; },
       [](Cell& c) { c.interlock.enabled = true; }},
      {MotionPermit::kSensorFresh,
       [](Cell& c) {
         c.bench.sensor_lives = false;
         c.bench.readings.force.stamp = 0;
       },
       [](Cell& c) { c.bench.sensor_lives = true; }},
      {MotionPermit::kModelFresh,
       [](Cell& c) {
         c.bench.simulation_lives = false;
         c.bench.model = {};
       },
       [](Cell& c) { c.bench.simulation_lives = true; }},
      {MotionPermit::kPosePlausible,
       [](Cell& c) {
         c.bench.arm_moves = false;
         c.bench.arm.q_ipo[6] += 0.2;
       },
       [](Cell& c) { c.bench.arm.q_ipo[6] -= 0.2; }},
      {MotionPermit::kNoResidualWrench, [](Cell& c) { c.bench.plane_W -= 0.02 * c.bench.feed_W; },
       [](Cell& c) { c.bench.plane_W += 0.02 * c.bench.feed_W; }},
      {MotionPermit::kSpindleReady, [](Cell& c) { c.spindle.ready = false; },
       [](Cell& c) { c.spindle.ready = true; }},
      {MotionPermit::kPathChecked, [](Cell& c) { c.bench.loop.AllowStart(false); },
       [](Cell& c) { c.bench.loop.AllowStart(true); }},
  };
  for (const Missing& missing : all) {
    Cell cell;
    cell.bench.arm.has_ipo = true;
    cell.bench.Activate();
    missing.remove(cell);
    const TickRecord record = cell.Run(300);
    const char* what = safety::DescribeMissing(missing.permit);
    const bool only_handing = missing.permit == MotionPermit::kHandedOver;
    EXPECT_EQ(cell.state(), only_handing ? CellState::kReady : CellState::kChecking) << what;
    EXPECT_EQ(record.permits, safety::MotionPermits::kAll & ~static_cast<std::uint32_t>(missing.permit))
        << what;
    EXPECT_EQ(cell.bench.command.activation, 0u) << "not taken over: " << what;
    EXPECT_FALSE(cell.bench.loop.faults().Any()) << what;
    missing.restore(cell);
    cell.Run(3);
    EXPECT_TRUE(safety::Renders(cell.state())) << what;
  }
}

// Oracle: the braking distance v^2 / 2a, with the speed v and the stop's deceleration a = 3 m/s^2. The arm
// then rests, and motion resumes exactly from the held posture.
TEST_F(ServoState, APauseBrakesHoldsAndResumesWithoutAJump) {
  Cell cell;
  cell.Render(60.0, 40);
  TickRecord record = cell.Tick();
  const double v = Vector3(record.v_WT_cmd_m_per_s).norm();
  ASSERT_GT(v, 0.02);
  const Vector3 from = Pose(record.X_WT_cmd).translation();
  cell.bench.loop.RequestPause();
  record = cell.Tick();
  EXPECT_EQ(cell.state(), CellState::kStop2);
  EXPECT_EQ(cell.bench.loop.cell_commands().spindle_rad_per_s, 0.0);
  EXPECT_TRUE(cell.bench.loop.cell_commands().motion_requested) << "the power stays";
  record = cell.Run(200);
  EXPECT_EQ(cell.state(), CellState::kPaused);
  EXPECT_LE((Pose(record.X_WT_cmd).translation() - from).norm(), v * v / (2.0 * 3.0) + v * 0.001);
  EXPECT_TRUE(cell.bench.loop.cell_commands().motion_requested);
  EXPECT_FALSE(cell.bench.loop.faults().Any());
  const JointArray held = record.q_cmd;
  // during a pause the enabling switch may be released
  cell.interlock.permitted = cell.interlock.enabled = false;
  cell.Run(500);
  EXPECT_EQ(cell.bench.command.q, held) << "whoever pushes";
  cell.bench.loop.RequestResume();
  cell.Run(50);
  EXPECT_EQ(cell.state(), CellState::kChecking) << "asked, but not permitted";
  EXPECT_EQ(cell.bench.command.q, held) << "the arm's interpolator is where commanding began: not followed";
  cell.interlock.permitted = true;
  cell.Run(50);
  EXPECT_EQ(cell.state(), CellState::kChecking) << "permitted, but the switch is not held";
  EXPECT_EQ(cell.bench.command.q, held);
  cell.interlock.enabled = true;
  double max_step_rad = 0.0;
  JointArray before = held;
  for (int i = 0; i < 300; ++i) {
    record = cell.Tick();
    if (i == 0) {
      EXPECT_EQ(record.q_cmd, held) << "begins at rest, nothing rendered";
      EXPECT_TRUE(Vector3(record.F_coupling_T_W.f).isZero(0.0));
    }
    max_step_rad = std::max(max_step_rad, MaxJointDifference_rad(record.q_cmd, before));
    before = record.q_cmd;
  }
  EXPECT_TRUE(safety::Renders(cell.state()));
  EXPECT_LT(max_step_rad, 1e-3);
  EXPECT_FALSE(cell.bench.loop.faults().Any());
}

TEST_F(ServoState, AResumeInContactFadesTheForceIn) {
  Cell cell;
  cell.Render(120.0, 3000);
  cell.bench.loop.RequestPause();
  cell.Run(300);
  ASSERT_EQ(cell.state(), CellState::kPaused);
  cell.bench.loop.RequestResume();
  double before_N = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const TickRecord record = cell.Tick();
    const double f_N = Vector3(record.F_coupling_T_W.f).norm();
    ASSERT_LT(f_N - before_N, 2.0) << "tick " << i << ": 1.2 N a tick are the ramp's";
    before_N = f_N;
  }
  EXPECT_NEAR(before_N, 120.0, 1.0);
  EXPECT_FALSE(cell.bench.loop.faults().Any());
}

TEST_F(ServoState, APauseRequestedBeforeMotionPreventsItsStart) {
  Cell cell;
  cell.Run(3);
  cell.bench.loop.RequestPause();
  cell.Tick();
  EXPECT_EQ(cell.state(), CellState::kPaused);
  cell.bench.Activate();
  cell.Run(200);
  EXPECT_EQ(cell.state(), CellState::kPaused);
  EXPECT_EQ(cell.bench.command.activation, 0u);
  cell.bench.loop.RequestResume();
  cell.Run(3);
  EXPECT_TRUE(safety::Renders(cell.state()));
}

TEST_F(ServoState, APauseRequestedWhileTheArmIsSilentActsAtItsNextMessage) {
  Cell cell;
  cell.Render(60.0, 40);
  cell.bench.loop.RequestPause();
  cell.Tick(ReceiveResult::kTimeout);
  EXPECT_TRUE(safety::Renders(cell.state()));
  cell.Tick();
  EXPECT_EQ(cell.state(), CellState::kStop2);
}

TEST_F(ServoState, AfterAPauseOnTheStartPathTheArmGoesOnToTheStart) {
  Cell cell(StartPath::kToStart);
  cell.Run(5);
  cell.bench.Activate();
  cell.Run(600);
  ASSERT_EQ(cell.state(), CellState::kAligning);
  cell.bench.loop.RequestPause();
  cell.Tick();
  EXPECT_EQ(cell.state(), CellState::kStop2);
  EXPECT_EQ(cell.bench.loop.phase(), Phase::kAligning) << "on its path";
  cell.Run(1000);
  EXPECT_EQ(cell.state(), CellState::kPaused);
  const JointArray held = cell.bench.command.q;
  cell.bench.loop.RequestResume();
  double max_step_rad = 0.0;
  JointArray before = held;
  for (int i = 0; i < 20'000 && !safety::Renders(cell.state()); ++i) {
    const TickRecord record = cell.Tick();
    max_step_rad = std::max(max_step_rad, MaxJointDifference_rad(record.q_cmd, before));
    before = record.q_cmd;
  }
  EXPECT_TRUE(safety::Renders(cell.state()));
  EXPECT_LT(max_step_rad, 1e-3);
  EXPECT_NEAR(before[0], ServoBench::StartJoints()[0] + 0.3, 1e-9);
}

// At the end of the start path, every condition of motion must hold again, including a fresh contact model.
TEST_F(ServoState, RenderingAtTheStartWaitsForEveryCondition) {
  Cell cell(StartPath::kToStart);
  cell.Run(5);
  cell.bench.Activate();
  cell.Run(10);
  cell.bench.simulation_lives =
      false;  // the path itself needs no contact model, because nothing is rendered on it
  cell.Run(20'000);
  EXPECT_EQ(cell.state(), CellState::kAligning);
  EXPECT_NEAR(cell.bench.command.q[0], ServoBench::StartJoints()[0] + 0.3, 1e-9);
  EXPECT_FALSE(safety::MotionPermits(cell.Tick().permits).Has(MotionPermit::kModelFresh));
  cell.bench.simulation_lives = true;
  cell.Run(3);
  EXPECT_TRUE(safety::Renders(cell.state()));
}

// The arm has stayed in COMMANDING_ACTIVE, so it still reports the interpolator's position from the beginning
// of commanding. A recovery that started from there would make the arm jump.
TEST_F(ServoState, ARecoveryInTheSameActivationStartsAtTheLastCommand) {
  Cell cell;
  cell.Render(4.0, 800);
  const JointArray last_command = cell.bench.command.q;
  ASSERT_GT(MaxJointDifference_rad(last_command, cell.bench.arm.q_ipo), 5e-3) << "it has moved";
  for (int i = 0; i < 5; ++i) cell.Tick(ReceiveResult::kTimeout);
  EXPECT_EQ(cell.state(), CellState::kStop0);
  EXPECT_TRUE(cell.bench.loop.CanRecover());
  cell.bench.loop.RequestRecovery();
  JointArray before = last_command;
  for (int i = 0; i < 400; ++i) {
    const TickRecord record = cell.Tick();
    ASSERT_LT(MaxJointDifference_rad(record.q_cmd, before), 1e-3) << "tick " << i;
    before = record.q_cmd;
    // for 200 ms the PLC's permission may still date from before the stop, so it does not count
    if (i < 199) ASSERT_EQ(cell.state(), CellState::kRecovery) << "tick " << i;
  }
  EXPECT_TRUE(safety::Renders(cell.state()));
  EXPECT_FALSE(cell.bench.loop.faults().Any());
}

TEST_F(ServoState, ARecoveryOnTheStartPathStillReachesTheStart) {
  Cell cell(StartPath::kToStart);
  cell.Run(5);
  cell.bench.Activate();
  cell.Run(600);
  for (int i = 0; i < 5; ++i) cell.Tick(ReceiveResult::kTimeout);
  EXPECT_EQ(cell.state(), CellState::kStop0);
  cell.bench.loop.RequestRecovery();
  cell.Run(199);
  EXPECT_EQ(cell.state(), CellState::kRecovery) << "the PLC has not answered the new request";
  cell.Run(3);
  EXPECT_EQ(cell.state(), CellState::kAligning);
  for (int i = 0; i < 20'000 && !safety::Renders(cell.state()); ++i) cell.Tick();
  EXPECT_NEAR(cell.bench.command.q[0], ServoBench::StartJoints()[0] + 0.3, 1e-6);
}

TEST_F(ServoState, AStop0EndsOnceTheArmIsMeasuredAtRest) {
  Cell cell;
  cell.Render();
  cell.bench.arm.session = SessionState::kMonitoringReady;
  for (int i = 0; i < 50; ++i) {  // the arm still moves at 0.1 rad/s
    cell.bench.command.q[0] = cell.bench.arm.q_meas[0] + 1e-4;
    cell.Tick();
    EXPECT_EQ(cell.state(), CellState::kStop0);
    EXPECT_EQ(cell.bench.loop.phase(), Phase::kStopped);
  }
  cell.Run(20);
  EXPECT_EQ(cell.state(), CellState::kFault);
  EXPECT_TRUE(cell.bench.loop.faults().Has(Fault::kSession));
}

// In every state of the cell, however it was reached: after a fault, the command must come to rest and stay
// there.
TEST_F(ServoState, InEveryStateAFaultLeadsToRest) {
  struct ReachedState {
    CellState state;
    StartPath start_path;
    std::function<void(Cell&)> reach;
  };
  const auto align = [](Cell& c) {
    c.Run(5);
    c.bench.Activate();
    c.Run(600);
  };
  const std::vector<ReachedState> all{
      {CellState::kOff, StartPath::kNone, [](Cell&) {}},
      {CellState::kChecking, StartPath::kNone,
       [](Cell& c) {
         c.interlock.permitted = false;
         c.Run(5);
       }},
      {CellState::kReady, StartPath::kNone, [](Cell& c) { c.Run(5); }},
      {CellState::kAligning, StartPath::kToStart, align},
      {CellState::kHaptic, StartPath::kNone,
       [](Cell& c) {
         c.spindle.speed_rad_per_s = 0.0;
         c.Render(60.0, 40);
       }},
      {CellState::kCutting, StartPath::kNone, [](Cell& c) { c.Render(60.0, 40); }},
      {CellState::kPaused, StartPath::kNone,
       [](Cell& c) {
         c.Render(60.0, 40);
         c.bench.loop.RequestPause();
         c.Run(200);
       }},
      {CellState::kStop0, StartPath::kNone,
       [](Cell& c) {
         c.Render(60.0, 40);
         for (int i = 0; i < 5; ++i) c.Tick(ReceiveResult::kTimeout);
       }},
      {CellState::kStop1, StartPath::kNone,
       [](Cell& c) {
         c.Render(60.0, 40);
         c.bench.loop.RequestStop();
         c.Tick();
       }},
      {CellState::kStop1, StartPath::kToStart,
       [&](Cell& c) {
         align(c);
         c.bench.loop.RequestStop();
         c.Tick();
       }},
      {CellState::kStop2, StartPath::kNone,
       [](Cell& c) {
         c.Render(60.0, 40);
         c.bench.loop.RequestPause();
         c.Tick();
       }},
      {CellState::kStop2, StartPath::kToStart,
       [&](Cell& c) {
         align(c);
         c.bench.loop.RequestPause();
         c.Tick();
       }},
      {CellState::kFault, StartPath::kNone,
       [](Cell& c) {
         c.Render(60.0, 40);
         c.interlock.permitted = false;
         c.Run(200);
         c.interlock.permitted = true;
       }},
      {CellState::kRecovery, StartPath::kNone,
       [](Cell& c) {
         c.Render(60.0, 40);
         for (int i = 0; i < 5; ++i) c.Tick(ReceiveResult::kTimeout);
         c.interlock.permitted = false;
         c.bench.loop.RequestRecovery();
         c.Tick();
       }},
  };
  for (const ReachedState& reached : all) {
    const char* name = safety::Describe(reached.state).name;
    Cell cell(reached.start_path);
    reached.reach(cell);
    ASSERT_EQ(cell.state(), reached.state) << name;
    JointArray before = cell.bench.command.q;
    // one measured joint is NaN for one tick
    ArmState broken = cell.bench.arm;
    broken.q_meas[3] = std::numeric_limits<double>::quiet_NaN();
    cell.bench.loop.Tick({.state = broken,
                          .received = ReceiveResult::kOk,
                          .readings = cell.bench.readings,
                          .model = cell.bench.model,
                          .now = cell.bench.now},
                         cell.bench.command);
    EXPECT_TRUE(cell.bench.loop.faults().Has(Fault::kNotFinite)) << name;
    EXPECT_FALSE(safety::IsMotion(cell.state())) << name;
    int last_moving_tick = 0;
    for (int i = 0; i < 1000; ++i) {
      const TickRecord record = cell.Tick();
      ASSERT_FALSE(safety::IsMotion(cell.state())) << name << ", tick " << i;
      if (reached.state != CellState::kOff && MaxJointDifference_rad(record.q_cmd, before) > 0.0)
        last_moving_tick = i + 1;
      before = record.q_cmd;
    }
    EXPECT_EQ(cell.bench.loop.phase(), Phase::kStopped) << name;
    EXPECT_LE(last_moving_tick, 400) << name;
    EXPECT_FALSE(cell.bench.loop.CanRecover()) << name << ": not from this fault";
  }
}

TEST_F(ServoState, StartingPausingAndResumingAllocateNothing) {
  Cell cell;
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      rt::CheckedNoAllocScope no_alloc;
      cell.Tick();
    }
  };
  run(5);
  cell.bench.Activate();
  cell.bench.push_N = 60.0;
  run(300);
  cell.bench.loop.RequestPause();
  run(200);
  ASSERT_EQ(cell.state(), CellState::kPaused);
  cell.bench.loop.RequestResume();
  run(100);
  EXPECT_TRUE(safety::Renders(cell.state()));
}

}  // namespace
}  // namespace osteon::control
