#include "simulation/tools/proxy_path.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "simulation/tools/swept_tool.h"

namespace osteon::simulation {
namespace {

FrameRecord FrameAt(std::uint64_t number, const Pose& X_WP) {
  FrameRecord frame;
  frame.model.frame = number;
  frame.model.X_WP = X_WP;
  return frame;
}

// Pose of the proxy at time t in s: a winding path with a tremor of 20 um, of a tool that tilts and turns.
Pose PoseAt(double t) {
  Pose X = Pose::Identity();
  X.translation() = Vector3(0.02 * std::sin(0.9 * t), 0.01 * std::cos(1.3 * t), -1e-4 * t);
  X.translation() += 2e-5 * Vector3(std::sin(50.0 * t), std::cos(47.0 * t), 0.0);
  X.linear() = ExpRotation({0.3 * std::sin(0.5 * t), 0.0, 0.2 * t});
  return X;
}

// Two cutting balls and one of the shaft.
Tool TwoBalls() {
  Tool tool;
  tool.balls = {{.center_m = Vector3(0, 0, 0.002), .radius_m = 0.002, .cutting = true},
                {.center_m = Vector3(0.001, 0, 0.006), .radius_m = 0.001, .cutting = true},
                {.center_m = Vector3(0, 0, 0.100), .radius_m = 0.003, .cutting = false}};
  return tool;
}

TEST(ProxyPath, KeepsEveryPoseWhileTheyAreFew) {
  Pose X_WG = Pose::Identity();
  X_WG.translation() = Vector3(0.1, 0.2, 0.3);
  ProxyPath path(TwoBalls(), X_WG, 100);
  for (int i = 1; i < 100; ++i) path.Add(FrameAt(static_cast<std::uint64_t>(i), X_WG * PoseAt(0.01 * i)));
  ASSERT_EQ(path.X_GP().size(), 99u);
  EXPECT_EQ(path.tolerance_m(), 0.0);
  for (int i = 1; i < 100; ++i)
    EXPECT_TRUE(path.X_GP()[static_cast<std::size_t>(i) - 1].isApprox(PoseAt(0.01 * i), 1e-12));
}

TEST(ProxyPath, SkipsFramesWithoutANumberWithAnErrorOrWithoutAPose) {
  ProxyPath path(TwoBalls(), Pose::Identity());
  FrameRecord failed = FrameAt(2, PoseAt(1.0));
  failed.model.status = EngineStatus::kDeviceLost;
  path.Add(FrameAt(0, PoseAt(0.0)));
  path.Add(failed);
  Pose nowhere = Pose::Identity();
  nowhere.translation().x() = std::nan("");
  path.Add(FrameAt(3, nowhere));
  EXPECT_TRUE(path.X_GP().empty());
}

// Oracle: every recorded pose. Each ball's centre at each of them must lie within the stated tolerance of the
// ball's path along the thinned poses.
TEST(ProxyPath, ThinnedPathKeepsEachBallWithinTheTolerance) {
  const Tool tool = TwoBalls();
  ProxyPath path(tool, Pose::Identity(), 2000);
  std::vector<Pose> all;
  for (std::uint64_t i = 1; i <= 30'000; ++i) {
    all.push_back(PoseAt(1e-3 * static_cast<double>(i)));
    path.Add(FrameAt(i, all.back()));
  }
  EXPECT_LT(path.X_GP().size(), 2000u);
  EXPECT_GT(path.tolerance_m(), 0.0);
  EXPECT_LT(path.tolerance_m(), 50e-6) << "of a tremor of 20 µm";
  EXPECT_TRUE(path.X_GP().front().isApprox(all.front()));
  for (const ToolBall& ball : tool.balls) {
    if (!ball.cutting) continue;
    Tool alone;
    alone.balls = {ball};
    const SweptTool swept(alone, path.X_GP(), 0.0);
    double worst_m = 0.0;
    for (const Pose& X : all)
      worst_m = std::max(worst_m, swept.SignedDistance(X * Vector3(ball.center_m)) + ball.radius_m);
    EXPECT_LE(worst_m, path.tolerance_m());
    EXPECT_GT(worst_m, path.tolerance_m() / 20.0) << "the tolerance is not far larger than what it bounds";
  }
}

}  // namespace
}  // namespace osteon::simulation
