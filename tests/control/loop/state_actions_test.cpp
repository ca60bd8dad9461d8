#include "control/loop/state_actions.h"

#include <gtest/gtest.h>

#include "tests/control/loop/start_rig.h"

namespace osteon::control {
namespace {

using safety::CellAction, safety::CellEvent, safety::CellState, safety::Fault;

// A rendering loop whose commanded tool moves at 0.05 m/s: the law's 0.1 m/s times the fade of 0.5.
struct MovingToolRig : StartRig {
  MovingToolRig() {
    actions.ApplyEvent(CellEvent::kArmSeen);
    actions.ApplyEvent(CellEvent::kPermitsHold);
    EXPECT_EQ(actions.ApplyEvent(CellEvent::kBeginRendering), CellAction::kBeginRendering);
    tool.V_WT.v = Vector3(0.1, 0.0, 0.0);
    tool.fade = 0.5;
  }
};

TEST(StateActions, AFaultBrakesTheToolFromItsVelocityUntilItRests) {
  MovingToolRig rig;
  rig.actions.StopWith(Fault::kWorkspace);
  EXPECT_EQ(rig.supervisor.state(), CellState::kStop1);
  EXPECT_EQ(rig.tool.Velocity().v, Vector3(0.05, 0.0, 0.0));
  safety::LimitSet acting;
  int ticks = 0;
  while (rig.supervisor.state() == CellState::kStop1 && ++ticks < 1000) rig.actions.Brake(false, acting);
  EXPECT_GT(ticks, 1);
  EXPECT_EQ(rig.supervisor.state(), CellState::kFault);
  EXPECT_EQ(rig.tool.Velocity().v, Vector3::Zero());
}

TEST(StateActions, AnOrderlyStopEndsWithoutAFault) {
  MovingToolRig rig;
  rig.actions.ApplyEvent(CellEvent::kStopRequested);
  EXPECT_EQ(rig.supervisor.state(), CellState::kStop1);
  rig.actions.FinishStop();
  EXPECT_FALSE(safety::Brakes(rig.supervisor.state()));
  EXPECT_FALSE(rig.supervisor.faults().Any());
  EXPECT_NE(rig.supervisor.state(), CellState::kFault);
}

TEST(StateActions, AnArmThatLeftCommandModeEndsRendering) {
  MovingToolRig rig;
  rig.supervisor.Latch(Fault::kSession);
  rig.actions.ApplyEvent(CellEvent::kArmLeft);
  EXPECT_FALSE(safety::Renders(rig.supervisor.state()));
}

}  // namespace
}  // namespace osteon::control
