#include "control/loop/motion_supervisor.h"

#include <gtest/gtest.h>

// Tests the supervisor, which keeps the cell's state, its faults and the operator's requests.

namespace osteon::control {
namespace {

using safety::CellAction, safety::CellEvent, safety::CellState, safety::Fault;

// A supervisor that has reached the haptic state.
MotionSupervisor RenderingSupervisor() {
  MotionSupervisor supervisor;
  static_cast<void>(supervisor.Apply(CellEvent::kArmSeen));
  static_cast<void>(supervisor.Apply(CellEvent::kPermitsHold));
  EXPECT_EQ(supervisor.Apply(CellEvent::kBeginRendering), CellAction::kBeginRendering);
  supervisor.SetRendered();
  return supervisor;
}

TEST(MotionSupervisor, ReachesRenderingByTheEventsOfAStart) {
  MotionSupervisor supervisor;
  EXPECT_EQ(supervisor.state(), CellState::kOff);
  EXPECT_FALSE(supervisor.moved());
  supervisor = RenderingSupervisor();
  EXPECT_EQ(supervisor.state(), CellState::kHaptic);
  EXPECT_EQ(supervisor.phase(), Phase::kHaptic);
  EXPECT_TRUE(supervisor.moved());
  EXPECT_TRUE(supervisor.MovesOrBrakes());
  EXPECT_FALSE(supervisor.IsWaitingOrPaused());
}

TEST(MotionSupervisor, AFaultBrakesAndIsHeldUntilARecoveryClearsIt) {
  MotionSupervisor supervisor = RenderingSupervisor();
  supervisor.Latch(Fault::kSession);
  EXPECT_EQ(supervisor.Apply(CellEvent::kFault), CellAction::kBrake);
  EXPECT_EQ(supervisor.phase(), Phase::kStopping);
  EXPECT_EQ(supervisor.Apply(CellEvent::kRestFault), CellAction::kHold);
  EXPECT_EQ(supervisor.state(), CellState::kFault);
  ASSERT_TRUE(supervisor.CanRecover());
  EXPECT_EQ(supervisor.Apply(CellEvent::kRecover), CellAction::kClearFaults);
  EXPECT_FALSE(supervisor.faults().Any());
  EXPECT_EQ(supervisor.state(), CellState::kRecovery);
}

TEST(MotionSupervisor, CannotRecoverFromOtherFaultsOrAfterAStopRequest) {
  for (const bool stop_requested : {false, true}) {
    MotionSupervisor supervisor = RenderingSupervisor();
    supervisor.Latch(stop_requested ? Fault::kSession : Fault::kWorkspace);
    static_cast<void>(supervisor.Apply(CellEvent::kFault));
    static_cast<void>(supervisor.Apply(CellEvent::kRestFault));
    supervisor.SetStopRequested(stop_requested);
    EXPECT_FALSE(supervisor.CanRecover());
  }
}

// A stop is requested while the arm moves to the start pose. The phase must remain kAligning until the arm is
// at rest.
TEST(MotionSupervisor, AStopOnTheWayToTheStartKeepsThePhaseUntilRest) {
  MotionSupervisor supervisor;
  static_cast<void>(supervisor.Apply(CellEvent::kArmSeen));
  static_cast<void>(supervisor.Apply(CellEvent::kPermitsHold));
  EXPECT_EQ(supervisor.Apply(CellEvent::kBeginAligning), CellAction::kBeginPath);
  supervisor.SetOnPath(true);
  supervisor.SetStopRequested(true);
  static_cast<void>(supervisor.Apply(CellEvent::kStopRequested));
  EXPECT_EQ(supervisor.phase(), Phase::kAligning);
  static_cast<void>(supervisor.Apply(CellEvent::kRest));
  EXPECT_FALSE(supervisor.on_path());
  EXPECT_EQ(supervisor.phase(), Phase::kStopped);
}

TEST(MotionSupervisor, APauseRequestIsTakenOnceAndOnlyIfMotionCanPause) {
  MotionSupervisor supervisor = RenderingSupervisor();
  supervisor.RequestPause(true);
  supervisor.RequestPause(false);
  EXPECT_TRUE(supervisor.TakePauseRequest()) << "an asking stays until it is taken";
  EXPECT_FALSE(supervisor.TakePauseRequest());
  static_cast<void>(supervisor.Apply(CellEvent::kFault));
  supervisor.RequestPause(true);
  EXPECT_FALSE(supervisor.TakePauseRequest()) << "a stop is no motion that could pause";
}

}  // namespace
}  // namespace osteon::control
