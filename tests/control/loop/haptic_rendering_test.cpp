#include "control/loop/haptic_rendering.h"

#include <gtest/gtest.h>

#include "tests/control/loop/rendering_rig.h"

// Tests the part of the loop that renders the force, in ticks in which a hand guides the tool.

namespace osteon::control {
namespace {

using safety::CellState, safety::Fault;

TEST(HapticRendering, AToolInBoneIsRenderedAndRecorded) {
  RenderingRig rig;
  ASSERT_TRUE(rig.StartRendering());
  rig.model = PlaneBehind(1e-3, rig.now);
  rig.rendering.Step(rig.Inputs());
  EXPECT_EQ(rig.supervisor.state(), CellState::kHaptic);
  ASSERT_TRUE(rig.result.coupling_evaluated);
  EXPECT_TRUE(rig.result.rendered);
  TickRecord record;
  rig.rendering.FillRecord(record);
  EXPECT_GT(record.tool_in_bone_m, 0.0);
  EXPECT_EQ(record.tool_in_bone_m, rig.statistics.peak_tool_in_bone_m);
}

TEST(HapticRendering, AFaultBrakesInsteadOfRendering) {
  RenderingRig rig;
  ASSERT_TRUE(rig.StartRendering());
  rig.readings.force.trusted = false;
  rig.rendering.Step(rig.Inputs());
  EXPECT_TRUE(rig.supervisor.faults().Has(Fault::kSensorFault));
  EXPECT_FALSE(safety::Renders(rig.supervisor.state()));
  EXPECT_FALSE(rig.result.rendered);
  TickRecord record;
  record.tank_J = -1.0;
  rig.rendering.FillRecord(record);
  EXPECT_EQ(record.tank_J, -1.0) << "nothing was rendered: the stabilisers leave no record";
}

TEST(HapticRendering, TheSpindleTurnsOnlyWhileRenderingAndWhilePermitted) {
  ServoParams params = ServoBench::Params();
  params.spindle_rad_per_s = 30.0;
  RenderingRig rig(params);
  EXPECT_EQ(rig.rendering.SpindleCommand_rad_per_s(), 0.0);
  ASSERT_TRUE(rig.StartRendering());
  EXPECT_EQ(rig.rendering.SpindleCommand_rad_per_s(), 30.0);
  rig.params.has_interlock = true;
  rig.readings.interlock = {.stamp = rig.now, .permitted = true, .enabled = true, .spindle_permitted = true};
  rig.rendering.Step(rig.Inputs());
  EXPECT_EQ(rig.supervisor.state(), CellState::kCutting);
  rig.readings.interlock.spindle_permitted = false;
  rig.rendering.Step(rig.Inputs());
  EXPECT_EQ(rig.rendering.SpindleCommand_rad_per_s(), 0.0);
  EXPECT_EQ(rig.supervisor.state(), CellState::kHaptic);
}

}  // namespace
}  // namespace osteon::control
