#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "control/loop/loop_repeat.h"
#include "servo_bench.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests the change of the tool while the loop is paused. The loop takes the new tool from a table that was
// prepared before the run.

namespace osteon::control {
namespace {

using safety::CellState;

constexpr double kLonger_m =
    0.001;  // a reamer of 46 mm replaces one of 44 mm: the apex is 1 mm farther from the flange

std::vector<LoopTool> Tools() {
  LoopTool first{.X_FT = ServoBench::FlangeToTool(), .sensor = ServoBench::Params().sensor};
  LoopTool second = first;
  second.X_FT.translation().z() += kLonger_m;
  return {first, second};
}

// A loop that has rendered with the tool in free space, 60 mm before the bone's plane, and is now paused.
struct PausedLoop {
  PausedLoop() : bench(ServoBench::Params(), 0.06) {
    bench.loop.SetTools(Tools(), 0);
    bench.Run(20);
    bench.Activate();
    bench.push_N = 2.0;
    bench.Run(300);
    bench.push_N = 0.0;
    bench.loop.RequestPause();
    last = bench.Run(600);
  }
  ServoBench bench;
  TickRecord last;
};

TEST(ServoToolChange, KeepsTheJointsToTheBitAndMovesTheApexToTheNewTools) {
  PausedLoop cell;
  ASSERT_EQ(cell.bench.loop.state(), CellState::kPaused);
  const JointArray held = cell.last.q_cmd;
  const Pose X_before = cell.last.X_WT_cmd;
  cell.bench.loop.RequestTool(1);
  const TickRecord changed = cell.bench.Tick();
  EXPECT_EQ(changed.input.tool_index, 1);
  EXPECT_EQ(changed.q_cmd, held);
  const Vector3 apex_before_T = X_before.inverse() * Pose(changed.X_WT_cmd).translation();
  EXPECT_LT((apex_before_T - Vector3(0.0, 0.0, kLonger_m)).norm(), 1e-15);
  EXPECT_LT((Pose(changed.X_WT_meas).translation() - Pose(changed.X_WT_cmd).translation()).norm(), 1e-9);
  EXPECT_EQ(changed.tool_speed_meas_m_per_s, 0.0) << "the frame has jumped, nothing has moved";
  EXPECT_EQ(cell.bench.loop.tool_command().tool_index, 1);

  cell.bench.loop.RequestResume();
  double max_step_rad = 0.0;
  JointArray before = held;
  for (int i = 0; i < 300; ++i) {
    const TickRecord tick = cell.bench.Tick();
    max_step_rad = std::max(max_step_rad, MaxJointDifference(tick.q_cmd, before));
    before = tick.q_cmd;
    EXPECT_LT(tick.tool_speed_meas_m_per_s, 1e-6);
  }
  EXPECT_TRUE(safety::Renders(cell.bench.loop.state()));
  EXPECT_LT(max_step_rad, 1e-12) << "nobody pushes";
  EXPECT_FALSE(cell.bench.loop.faults().Any());
}

TEST(ServoToolChange, HappensOnlyInAPausedLoop) {
  ServoBench bench(ServoBench::Params(), 0.06);
  bench.loop.SetTools(Tools(), 0);
  bench.Run(20);
  bench.loop.RequestTool(1);
  EXPECT_EQ(bench.Tick().input.tool_index, 0) << "it waits";
  bench.Activate();
  bench.push_N = 2.0;
  bench.Run(300);
  ASSERT_TRUE(safety::Renders(bench.loop.state()));
  bench.loop.RequestTool(1);
  EXPECT_EQ(bench.Tick().input.tool_index, 0) << "it renders";
  bench.loop.RequestPause();
  bench.loop.RequestTool(1);
  EXPECT_EQ(bench.Tick().input.tool_index, 0) << "it brakes";
  bench.Run(600);
  ASSERT_EQ(bench.loop.state(), CellState::kPaused);
  EXPECT_EQ(bench.Tick().input.tool_index, 0) << "an earlier request is not kept";
  for (const int unknown : {-1, 2, 1000}) {
    bench.loop.RequestTool(unknown);
    EXPECT_EQ(bench.Tick().input.tool_index, 0) << unknown;
  }
  bench.loop.RequestTool(1);
  EXPECT_EQ(bench.Tick().input.tool_index, 1);
}

TEST(ServoToolChange, DoesNotAllocate) {
  PausedLoop cell;
  cell.bench.loop.RequestTool(1);
  {
    const rt::CheckedNoAllocScope scope;
    (void)cell.bench.Tick();
  }
  EXPECT_EQ(cell.bench.loop.tool_index(), 1);
}

// The new tool is heavier. If the loop subtracts the new tool's weight from the sensor's reading, the tool
// rests. If it still subtracted the old tool's weight, the tool would creep down.
TEST(ServoToolChange, SubtractsTheNewToolsWeightFromTheSensor) {
  constexpr double kHeavier_kg = 0.0134;  // mass of a 50 mm reamer minus that of a 44 mm reamer
  std::vector<LoopTool> tools = Tools();
  tools[1].sensor.tool_mass_kg += kHeavier_kg;
  for (const bool with_load : {true, false}) {
    if (!with_load) tools[1].sensor = tools[0].sensor;
    ServoBench bench(ServoBench::Params(), 0.06);
    bench.loop.SetTools(tools, 0);
    bench.Run(20);
    bench.Activate();
    bench.push_N = 2.0;
    bench.Run(300);
    bench.push_N = 0.0;
    bench.loop.RequestPause();
    bench.Run(600);
    bench.loop.RequestTool(1);
    bench.Tick();
    bench.loop.RequestResume();
    bench.side_W_N = kHeavier_kg * Vector3(0.0, 0.0, -9.81);  // additional weight of the new tool
    double speed_m_per_s = 0.0;
    for (int i = 0; i < 2000; ++i) speed_m_per_s = Vector3(bench.Tick().v_WT_cmd_m_per_s).norm();
    if (with_load)
      EXPECT_LT(speed_m_per_s, 0.001);
    else
      EXPECT_GT(speed_m_per_s, 0.003) << "0.13 N against 30 N s/m";
  }
}

TEST(ServoToolChange, AReplayChangesToTheSameTool) {
  ServoBench bench(ServoBench::Params(), 0.06);
  bench.loop.SetTools(Tools(), 0);
  ServoLoop replay(ServoBench::Params(), ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                   ServoBench::Arm().ArmAngle(ServoBench::StartJoints()));
  replay.SetTools(Tools(), 0);
  ArmCommand command;
  const auto run = [&](int count) {
    for (int i = 0; i < count; ++i) {
      const TickRecord tick = bench.Tick();
      const TickRecord repeated = ReplayTick(replay, tick, bench.model, command);
      ASSERT_EQ(command.q, tick.q_cmd);
      ASSERT_EQ(Pose(repeated.X_WT_cmd).matrix(), Pose(tick.X_WT_cmd).matrix());
      ASSERT_EQ(repeated.input.tool_index, tick.input.tool_index);
    }
  };
  run(20);
  bench.Activate();
  bench.push_N = 2.0;
  run(300);
  bench.push_N = 0.0;
  bench.loop.RequestPause();
  run(600);
  bench.loop.RequestTool(1);
  run(50);
  bench.loop.RequestResume();
  bench.push_N = 2.0;
  run(500);
  EXPECT_EQ(replay.tool_index(), 1);
}

TEST(ServoToolChange, RefusesAnUnusableToolTable) {
  ServoBench bench;
  EXPECT_THROW(bench.loop.SetTools({}, 0), std::invalid_argument);
  EXPECT_THROW(bench.loop.SetTools(Tools(), 2), std::invalid_argument);
  EXPECT_THROW(bench.loop.SetTools(Tools(), -1), std::invalid_argument);
  std::vector<LoopTool> tools = Tools();
  tools[1].X_FT.linear() *= 2.0;
  EXPECT_THROW(bench.loop.SetTools(tools, 0), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
