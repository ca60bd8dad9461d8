#include "simulation/surface/tool_sweep.h"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

namespace osteon::surface {
namespace {

using simulation::Tool;

const Tool kReamer{.name = "ball", .balls = {{.center_m = Vector3(0, 0, -0.01), .radius_m = 0.01}}};

/// A frame whose proxy ended at p_m in W without a slide.
ToolFrame FrameAt(const Vector3& p_m, std::uint64_t frame, bool cuts = true) {
  Pose X = Pose::Identity();
  X.translation() = p_m;
  return {.X_WP = X, .p_WS_m = p_m, .cuts = cuts, .frame = frame};
}

TEST(ToolSweep, ABatchAlongAStraightLineBecomesOneCapsule) {
  ToolSweep sweep(kReamer, Pose::Identity());
  EXPECT_FALSE(sweep.Add(FrameAt({0, 0, 0}, 1, false)));
  bool complete = false;
  for (int i = 1; i <= ToolSweep::kBatchFrames; ++i) {
    EXPECT_FALSE(complete);
    complete = sweep.Add(FrameAt({0, 0, -1e-4 * i}, 1 + static_cast<std::uint64_t>(i)));
  }
  EXPECT_TRUE(complete);
  const auto capsules = sweep.TakeCapsules();
  ASSERT_EQ(capsules.size(), 1U);
  EXPECT_FLOAT_EQ(capsules[0].radius_mm, 10.0F);
  EXPECT_FLOAT_EQ(capsules[0].a_mm.z, -10.0F);
  EXPECT_FLOAT_EQ(capsules[0].b_mm.z, -10.0F - 0.1F * ToolSweep::kBatchFrames);
}

// The tool slides 1 mm along x first, then sinks 1 mm into the bone: two capsules.
TEST(ToolSweep, PassThroughThePlaceWhereTheSlideEnds) {
  ToolSweep sweep(kReamer, Pose::Identity());
  (void)sweep.Add(FrameAt({0, 0, 0}, 1, false));
  ToolFrame frame = FrameAt({1e-3, 0, -1e-3}, 2);
  frame.p_WS_m = Vector3(1e-3, 0, 0);
  (void)sweep.Add(frame);
  const auto capsules = sweep.TakeCapsules();
  ASSERT_EQ(capsules.size(), 2U);
  EXPECT_FLOAT_EQ(capsules[0].b_mm.x, 1.0F);
  EXPECT_FLOAT_EQ(capsules[0].b_mm.z, -10.0F);
  EXPECT_FLOAT_EQ(capsules[1].b_mm.z, -11.0F);
}

// A hand that holds still trembles by half a micrometre: this must not add capsules, however long it lasts.
TEST(ToolSweep, AToolThatDwellsAddsNoCapsules) {
  ToolSweep sweep(kReamer, Pose::Identity());
  (void)sweep.Add(FrameAt({0, 0, 0}, 1));
  (void)sweep.Add(FrameAt({0, 0, -1e-3}, 2));
  EXPECT_EQ(sweep.TakeCapsules().size(), 1U);
  int batches = 0;
  for (std::uint64_t i = 3; i < 3 + 100 * ToolSweep::kBatchFrames; ++i)
    batches += sweep.Add(FrameAt({(i % 2 ? 5e-7 : -4e-7), 0, -1e-3}, i)) ? 1 : 0;
  EXPECT_EQ(batches, 100) << "a reader of the batches goes on";
  EXPECT_TRUE(sweep.TakeCapsules().empty());
}

// The tool moves by 0.1 um in each frame, 0.5 mm in all. The capsules must join and must end at most 1.1 um
// behind the tool.
TEST(ToolSweep, ASlowToolLeavesNoGaps) {
  ToolSweep sweep(kReamer, Pose::Identity());
  (void)sweep.Add(FrameAt({0, 0, 0}, 1));
  float last_mm = -10.0F;
  for (std::uint64_t i = 1; i <= 5000; ++i) {
    if (!sweep.Add(FrameAt({0, 0, -1e-7 * static_cast<double>(i)}, 1 + i))) continue;
    for (const Capsule& capsule : sweep.TakeCapsules()) {
      EXPECT_FLOAT_EQ(capsule.a_mm.z, last_mm);
      last_mm = capsule.b_mm.z;
    }
    EXPECT_NEAR(last_mm, -10.0 - 1e-4 * static_cast<double>(i), 1.1e-3);
  }
  for (const Capsule& capsule : sweep.TakeCapsules()) last_mm = capsule.b_mm.z;
  EXPECT_NEAR(last_mm, -10.5, 1.1e-3);
}

// The tool's origin rests, but a ball of the tool, 100 mm beside the origin, moves by 5 um.
TEST(ToolSweep, AToolThatTurnsInPlaceStillSweeps) {
  const Tool side{.name = "side", .balls = {{.center_m = Vector3(0.1, 0, 0), .radius_m = 0.001}}};
  ToolSweep sweep(side, Pose::Identity());
  (void)sweep.Add(FrameAt(Vector3::Zero(), 1));
  Pose turned = Pose::Identity();
  turned.linear() = Eigen::AngleAxisd(5e-5, Vector3::UnitZ()).toRotationMatrix();
  (void)sweep.Add({.X_WP = turned, .p_WS_m = Vector3(0, 0, 0), .cuts = true, .frame = 2});
  const auto capsules = sweep.TakeCapsules();
  ASSERT_EQ(capsules.size(), 1U);
  EXPECT_NEAR(capsules[0].b_mm.y, 5e-3F, 1e-4F);
}

TEST(ToolSweep, AStandingSpindleSweepsNothing) {
  ToolSweep sweep(kReamer, Pose::Identity());
  for (std::uint64_t i = 1; i < 40; ++i)
    EXPECT_FALSE(sweep.Add(FrameAt({1e-3 * static_cast<double>(i), 0, 0}, i, false)));
  EXPECT_TRUE(sweep.TakeCapsules().empty());
  EXPECT_EQ(sweep.frame(), 39U);
}

TEST(ToolSweep, ABatchEndsWhereTheSpindleStops) {
  ToolSweep sweep(kReamer, Pose::Identity());
  (void)sweep.Add(FrameAt({0, 0, 0}, 1, false));
  EXPECT_FALSE(sweep.Add(FrameAt({1e-3, 0, 0}, 2)));
  EXPECT_TRUE(sweep.Add(FrameAt({2e-3, 0, 0}, 3, false)));
  EXPECT_FALSE(sweep.TakeCapsules().empty());
  EXPECT_FALSE(sweep.Add(FrameAt({3e-3, 0, 0}, 4)));
  const auto capsules = sweep.TakeCapsules();
  ASSERT_EQ(capsules.size(), 1U);
  EXPECT_FLOAT_EQ(capsules[0].a_mm.x, 2.0F);
}

TEST(ToolSweep, SkippedFramesAreReplacedByAStraightCapsule) {
  ToolSweep sweep(kReamer, Pose::Identity());
  (void)sweep.Add(FrameAt({0, 0, 0}, 1));
  (void)sweep.Add(FrameAt({1e-3, 0, 0}, 2));
  (void)sweep.Add(FrameAt({5e-3, 0, 0}, 90));
  const auto capsules = sweep.TakeCapsules();
  ASSERT_EQ(capsules.size(), 1U);
  EXPECT_FLOAT_EQ(capsules[0].a_mm.x, 0.0F);
  EXPECT_FLOAT_EQ(capsules[0].b_mm.x, 5.0F);
}

TEST(ToolSweep, CapsulesAreInTheBonesFrame) {
  Pose X_WG = Pose::Identity();
  X_WG.translation() = Vector3(0, 0, 0.5);
  ToolSweep sweep(kReamer, X_WG);
  (void)sweep.Add(FrameAt({0, 0, 0.5}, 1));
  (void)sweep.Add(FrameAt({0, 0, 0.499}, 2));
  const auto capsules = sweep.TakeCapsules();
  ASSERT_EQ(capsules.size(), 1U);
  EXPECT_NEAR(capsules[0].b_mm.z, -11.0F, 1e-4F);
}

TEST(ToolSweep, ALargeTurnIsFollowedAlongItsArc) {
  const Tool side{.name = "side", .balls = {{.center_m = Vector3(0.02, 0, 0), .radius_m = 0.001}}};
  ToolSweep sweep(side, Pose::Identity());
  (void)sweep.Add(FrameAt(Vector3::Zero(), 1));
  Pose turned = Pose::Identity();
  turned.linear() = Eigen::AngleAxisd(std::numbers::pi / 3, Vector3::UnitZ()).toRotationMatrix();
  (void)sweep.Add({.X_WP = turned, .p_WS_m = Vector3(0, 0, 0), .cuts = true, .frame = 2});
  const auto capsules = sweep.TakeCapsules();
  EXPECT_GT(capsules.size(), 10U);
  for (const Capsule& c : capsules) EXPECT_NEAR(Norm(0.5F * (c.a_mm + c.b_mm)), 20.0F, 0.03F);
}

TEST(ToolSweep, FramesWithAnErrorOrWithoutAPoseAreSkipped) {
  simulation::ContactModel model;
  model.frame = 7;
  model.status = simulation::EngineStatus::kBadInput;
  EXPECT_EQ(MakeToolFrame(model, 10.0).frame, 0U);
  ToolSweep sweep(kReamer, Pose::Identity());
  (void)sweep.Add(FrameAt({0, 0, 0}, 1));
  EXPECT_FALSE(sweep.Add(MakeToolFrame(model, 10.0)));
  ToolFrame nowhere = FrameAt({0, 0, 0}, 3);
  nowhere.X_WP.p.x = std::nan("");
  EXPECT_FALSE(sweep.Add(nowhere));
  EXPECT_TRUE(sweep.TakeCapsules().empty());
}

TEST(ToolSweep, BallsWithinOthersAndTheShaftAreOmitted) {
  Tool tool = kReamer;
  tool.balls.push_back({.center_m = Vector3(0, 0, -0.012), .radius_m = 0.005});
  tool.balls.push_back({.center_m = Vector3(0, 0, -0.05), .radius_m = 0.004, .cutting = false});
  ToolSweep sweep(tool, Pose::Identity());
  (void)sweep.Add(FrameAt({0, 0, 0}, 1));
  (void)sweep.Add(FrameAt({0, 0, -1e-3}, 2));
  EXPECT_EQ(sweep.TakeCapsules().size(), 1U);
  EXPECT_FLOAT_EQ(VoxelFor(tool), 0.5F);
}

}  // namespace
}  // namespace osteon::surface
