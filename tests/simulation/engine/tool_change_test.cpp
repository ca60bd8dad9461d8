#include "simulation/engine/tool_change.h"

#include <cmath>

#include <gtest/gtest.h>

// Tests of a change of tool in a carved bone: the clearance of the new tool, and its first state.

namespace osteon::simulation {
namespace {

// Oracle: distance of two centres less both radii, by hand.
TEST(ToolClearance, IsTheGapOfTheNearestPairOfBalls) {
  CarvedState state;
  state.balls = {0.0f,  0.0f, 0.0f, 1.0f,   // 1 mm at the origin
                 10.0f, 0.0f, 0.0f, 2.0f,   // 2 mm
                 3.0f,  0.0f, 0.0f, 0.0f};  // removed
  Tool tool;
  tool.balls = {{.center_m = Vector3(0.0, 0.0, -0.002), .radius_m = 0.002},
                {.center_m = Vector3(0.0, 0.0, -0.010), .radius_m = 0.001, .cutting = false}};
  Pose X_GT = Pose::Identity();
  X_GT.translation() = Vector3(0.003, 0.0, 0.002);  // the head's centre at (3, 0, 0) mm
  EXPECT_NEAR(ToolClearance(state, tool, X_GT), 0.0, 1e-12) << "3 - 1 - 2 mm";
  X_GT.translation().x() = 0.0025;
  EXPECT_NEAR(ToolClearance(state, tool, X_GT), -0.0005, 1e-12);
  X_GT.translation() = Vector3(0.003, 0.0, 0.006);
  EXPECT_NEAR(ToolClearance(state, tool, X_GT), 0.002, 1e-9) << "5 mm of the head's centre, less 3";
  X_GT.translation() = Vector3(0.010, 0.0, 0.014);
  EXPECT_NEAR(ToolClearance(state, tool, X_GT), 0.001, 1e-9)
      << "the shaft's ball, 4 mm above the bone's of 2 mm";
  state.balls.clear();
  EXPECT_TRUE(std::isinf(ToolClearance(state, tool, X_GT))) << "no bone is left";
}

TEST(ToolChange, KeepsTheBoneAndForgetsTheProxy) {
  CarvedState state;
  state.balls = {1.0f, 2.0f, 3.0f, 4.0f};
  state.cleared = {1, 0};
  state.has_proxy = true;
  state.removed_volume_m3 = 2.0;
  const std::uint64_t hash = HashState(state);
  const CarvedState next = WithoutContact(state);
  EXPECT_FALSE(next.has_proxy);
  EXPECT_EQ(HashState(next), hash) << "the bone is the same";
  EXPECT_EQ(next.removed_volume_m3, 2.0);
}

}  // namespace
}  // namespace osteon::simulation
