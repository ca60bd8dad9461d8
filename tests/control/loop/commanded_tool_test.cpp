#include "control/loop/commanded_tool.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/control/loop/servo_parts.h"

// Tests the commanded tool: its pose, its motion at the law's velocity times the fade (0 … 1), and its
// braking.

namespace osteon::control {
namespace {

// A commanded tool whose arm is at the bench's start pose.
CommandedTool Tool(const ServoParams& params) { return {params, Follower(params)}; }

TEST(CommandedTool, ResetToArmPoseTakesTheMeasuredPoseAtRest) {
  const ServoParams params = ServoBench::Params();
  CommandedTool tool = Tool(params);
  EXPECT_FALSE(tool.has_pose());
  tool.ResetToArmPose({});
  EXPECT_FALSE(tool.has_pose()) << "an idle arm does not say where it is";
  tool.V_WT.v = Vector3(0.1, 0.0, 0.0);
  tool.fade = 1.0;
  tool.ResetToArmPose(StandingArm());
  EXPECT_TRUE(tool.has_pose());
  EXPECT_EQ(tool.Velocity().v, Vector3::Zero());
  EXPECT_LT((tool.X_WT().translation() - ServoBench::StartPose().translation()).norm(), 1e-12);
}

TEST(CommandedTool, MovesByFadeTimesTheLawsVelocity) {
  const ServoParams params = ServoBench::Params();
  CommandedTool tool = Tool(params);
  const Vector3 p_before = tool.X_WT().translation();
  tool.V_WT.v = Vector3(0.02, 0.0, 0.0);
  tool.fade = 0.5;
  const FollowedTwist followed = tool.FollowTwist(1.0, true);
  EXPECT_EQ(followed.fault, safety::Fault::kNone);
  EXPECT_FALSE(followed.joints_limited);
  EXPECT_NEAR((tool.X_WT().translation() - p_before).x(), 1e-5, 1e-7);
  EXPECT_NEAR(tool.V_WT.v.x(), 0.02, 1e-12) << "the law keeps its velocity";
}

// The braking distance must be |v|² / 2a along the direction of motion, with the speed v and the deceleration
// a.
TEST(CommandedTool, BrakesToRestAlongItsDirection) {
  const ServoParams params = ServoBench::Params();
  CommandedTool tool = Tool(params);
  tool.fade = 1.0;
  for (int i = 1; i <= 300; ++i) {  // accelerates
    tool.V_WT.v = std::min(1.0, i / 250.0) * Vector3(0.06, 0.08, 0.0);
    EXPECT_FALSE(tool.FollowTwist(1.0, true).joints_limited) << i;
  }
  const Vector3 p_before = tool.X_WT().translation();
  int ticks = 1;
  tool.StartBraking();
  BrakingStep step = tool.Brake(1.0);
  for (; !step.at_rest && ticks < 1000; ++ticks) step = tool.Brake(1.0);
  ASSERT_TRUE(step.at_rest);
  EXPECT_EQ(step.fault, safety::Fault::kNone);
  const Vector3 travel = tool.X_WT().translation() - p_before;
  const double wanted_m = 0.1 * 0.1 / (2.0 * params.stop_deceleration_m_per_s2);
  EXPECT_NEAR(travel.norm(), wanted_m, 0.05 * wanted_m + 1e-4);
  EXPECT_GT(travel.normalized().dot(Vector3(0.6, 0.8, 0.0)), 0.99);
  EXPECT_NEAR(ticks, 1e3 * 0.1 / params.stop_deceleration_m_per_s2, 5.0);
}

TEST(CommandedTool, AStopBeginsWithFadeTimesTheLawsVelocity) {
  const ServoParams params = ServoBench::Params();
  CommandedTool tool = Tool(params);
  tool.V_WT.v = Vector3(0.1, 0.0, 0.0);
  tool.fade = 0.25;
  tool.StartBraking();
  EXPECT_EQ(tool.Velocity().v, Vector3(0.025, 0.0, 0.0));
  tool.HoldStill();
  EXPECT_EQ(tool.Velocity().v, Vector3::Zero());
}

}  // namespace
}  // namespace osteon::control
