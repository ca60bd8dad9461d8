#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "simulation/engine/reference_engine.h"
#include "simulation/metrics/workload_scores.h"
#include "simulation/packing/mass_points.h"
#include "simulation/packing/packing_builder.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/tools/swept_tool.h"

// Tests of the workloads by which methods are compared, and of their scores. A workload cuts bone along a
// path, then stops the spindle and touches the cut bone, where the exact force is known.

namespace osteon::simulation {
namespace {

// While the tool touches the cut bone, its centre deviates from the cutting path by a known offset. The exact
// force is the spring to the nearest point of that path. Oracle for this point: a search over all poses of
// the cut.
TEST(CutWorkload, ExactForceIsTheSpringToTheNearestPointOfThePath) {
  for (const CutTask task : kCutTasks)
    for (const std::uint64_t seed : {0u, 3u}) {
      const CutWorkload work = MakeCutWorkload(task, {.seed = seed});
      ASSERT_EQ(work.exact.size(), work.frames.size() - work.feel_begin);
      const auto center = [&](std::size_t k) {
        return Vector3(Pose(work.frames[k].X_WT) * Vector3(work.tool.balls.front().center_m));
      };
      for (std::size_t i = 0; i < work.exact.size(); i += 7) {
        const Vector3 touch = center(work.feel_begin + i);
        Vector3 nearest = center(0);
        for (std::size_t k = 0; k < work.cut_end; ++k)
          if ((center(k) - touch).norm() < (nearest - touch).norm()) nearest = center(k);
        const Vector3 exact = work.cutting.stiffness_N_per_m * (nearest - touch);
        // The poses are 0.02 mm apart, so the nearest of them is up to 0.01 mm, 0.2 N, from the nearest point
        // of the path.
        EXPECT_NEAR((exact - work.exact[i].f_N).norm(), 0.0, 0.25) << TaskName(task) << " " << i;
        EXPECT_NEAR(work.exact[i].f_N.norm(), 10.0, 1e-9);
        EXPECT_GT(work.exact[i].f_N.z(), 9.0);
      }
    }
}

TEST(CutWorkload, StartsInFreeSpaceMovesInSmallStepsAndTouchesWithAStillSpindle) {
  for (const CutTask task : kCutTasks) {
    const CutWorkload work = MakeCutWorkload(task);
    const Vector3 start = Pose(work.frames.front().X_WT) * Vector3(work.tool.balls.front().center_m);
    if (task != CutTask::kReam) {
      EXPECT_GT(work.solid->SignedDistance(start), work.tool.balls.front().radius_m);
    }
    for (std::size_t k = 0; k < work.frames.size(); ++k) {
      EXPECT_EQ(work.frames[k].spindle_rad_per_s != 0.0, k < work.cut_end);
      if (k == 0) continue;
      const double step_m =
          (Pose(work.frames[k].X_WT).translation() - Pose(work.frames[k - 1].X_WT).translation()).norm();
      EXPECT_LE(step_m, 0.06e-3) << TaskName(task) << " " << k;
    }
  }
}

// The seed shifts the cut: for none of them may the cut reach the solid's sides or bottom.
TEST(CutWorkload, TheCutStaysInsideTheSolidForEverySeed) {
  for (const CutTask task : {CutTask::kPlunge, CutTask::kSlide, CutTask::kChannel})
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const CutWorkload work = MakeCutWorkload(task, {.seed = seed});
      const Eigen::AlignedBox3d cut = SweptTool(work.tool, work.CutPath()).Bounds(),
                                bone = work.solid->Bounds();
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_GT(cut.min()[axis], bone.min()[axis] + 0.2e-3) << TaskName(task) << seed;
        EXPECT_LT(cut.max()[axis], bone.max()[axis] - 0.2e-3) << TaskName(task) << seed;
      }
      EXPECT_GT(cut.min().z(), bone.min().z() + 1e-3);
    }
}

TEST(CutWorkload, RefusesInvalidRatesFeedsAndOffsets) {
  EXPECT_THROW((void)MakeCutWorkload(CutTask::kPlunge, {.rate_hz = 0.0}), std::invalid_argument);
  EXPECT_THROW((void)MakeCutWorkload(CutTask::kPlunge, {.feed_m_per_s = NAN}), std::invalid_argument);
  EXPECT_THROW((void)MakeCutWorkload(CutTask::kPlunge, {.offset_m = 2e-3}), std::invalid_argument);
}

// The reference engine on a coarse packing must come near the closed forms of the plunge, which confirms the
// workload's exact values. A run that removed nothing must have a bad score.
TEST(WorkloadScores, AreGoodForTheReferenceEngineAndBadForAnUncutBone) {
  const CutWorkload work = MakeCutWorkload(CutTask::kPlunge, {.feed_m_per_s = 0.060});
  Bone bone;
  PackingParams packing;
  packing.lattice = {.finest_m = 0.9e-3, .coarser_from_m = {6.5e-3}};
  packing.cup_radius_cap_m = 1.1e-3;
  packing.radius_growth = 0.0;
  bone.balls = BuildPacking(*work.solid, *work.zone, packing);
  bone.points =
      BuildMassPoints(*work.solid, *work.zone, {.cells = {.finest_m = 0.6e-3, .coarser_from_m = {}}});
  bone.materials = work.materials;
  ReferenceEngine engine(bone, work.tool, Pose::Identity(), work.cutting);
  const BallUnion before(bone.balls);
  const WorkloadRun run = RunWorkload(engine, work);
  ASSERT_TRUE(run.complete);
  EXPECT_NEAR(run.removed_volume_m3 * 1e9, 2.0 / 3.0 * M_PI * 125.0, 0.03 * 262.0);
  const BallUnion after(LiveBalls(engine.Snapshot()));
  const WorkloadScores scores = ScoreWorkload(work, run, before, after, 8000);
  EXPECT_NEAR(scores.swept_volume_m3 * 1e9, 2.0 / 3.0 * M_PI * 125.0, 0.01 * 262.0);
  EXPECT_LT(scores.volume_error, 0.04);
  EXPECT_GT(scores.lost_m, 0.005e-3);
  EXPECT_LT(scores.lost_m, 0.08e-3);
  EXPECT_LT(scores.left_m, 1e-6);
  // the tool sinks into the packing by at most 0.06 mm of the 0.5 mm of offset, 12 %
  EXPECT_LT(scores.force.force_relative, 0.12);
  EXPECT_LT(scores.force.normal_rms_deg, 6.0);
  EXPECT_LT(scores.ripple, 0.05);
  EXPECT_TRUE(scores.force.touched);

  const WorkloadScores nothing = ScoreWorkload(work, run, before, before, 8000);
  EXPECT_NEAR(nothing.left_m, 262e-9 / (2.0 * M_PI * 25e-6), 0.1e-3);  // a hemisphere's volume over its area
}

TEST(WorkloadScores, AreCombinedAsRootMeanSquares) {
  WorkloadScores a, b;
  a.depth_error_m = 3.0;
  b.depth_error_m = 4.0;
  a.force.normal_jump_deg_per_ms = 2.0;
  b.force.touched = false;
  const WorkloadScores both = Combined({a, b});
  EXPECT_NEAR(both.depth_error_m, std::sqrt(12.5), 1e-12);
  EXPECT_EQ(both.force.normal_jump_deg_per_ms, 2.0);
  EXPECT_FALSE(both.force.touched);
}

}  // namespace
}  // namespace osteon::simulation
