#include "report/bone_view.h"

#include <cmath>
#include <span>

#include <gtest/gtest.h>

#include "report_markup.h"
#include "report_synthetic.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/chunk_bytes.h"

namespace osteon::report {
namespace {

// A coarse block whose tool goes straight in, without tilt.
const SyntheticParams kStraight{
    .spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 2e-3, .ticks = 5, .frames = 400};

// Carves the run's bone with its tool along a path; `max_quads` bounds the number of faces.
CarvedSurface SurfaceOf(const SyntheticRun& run, std::span<const Pose> X_GP,
                        std::size_t max_quads = 120'000) {
  const simulation::ToolPath path{.tool = &run.tool, .X_GP = X_GP};
  return CarveSurface({.bone = run.bone,
                       .materials = MaterialMap(run.bone.points),
                       .paths = {&path, 1},
                       .max_quads = max_quads});
}

// The pose X_GP of the run with the smallest z.
Pose DeepestPose(const SyntheticRun& run) {
  Pose deepest = PathOf(run).front();
  for (const Pose& X : PathOf(run))
    if (X.translation().z() < deepest.translation().z()) deepest = X;
  return deepest;
}

// The ideal cavity is that of a tool that goes straight down the site's axis. A cavity cut along such a path
// deviates from it only by the grid's error.
TEST(BoneView, AToolThatWentStraightInLeavesTheIdealCavity) {
  const SyntheticRun run = MakeSyntheticRun(kStraight);
  const Vector3 axis = run.bone.site.axis;
  std::vector<Pose> path(2, DeepestPose(run));
  path[0].translation() = path[1].translation() + 0.05 * axis;
  const CarvedSurface carved = SurfaceOf(run, path);
  ASSERT_GT(carved.error.samples, 1000);
  const double voxel_m = 1e-3 * static_cast<double>(carved.layout.voxel_mm);
  EXPECT_LT(carved.error.mean_abs_m, 0.02 * voxel_m);
  EXPECT_LT(carved.error.p95_m, 0.1 * voxel_m);
}

// A tool that also moves 0.4 mm sideways at its deepest place cuts up to 0.4 mm beyond the ideal cavity.
TEST(BoneView, AToolThatWentAsideCutsBeyondTheIdealCavity) {
  const SyntheticRun run = MakeSyntheticRun(kStraight);
  constexpr double kAside_m = 0.4e-3, kLift_m = 1e-6;
  std::vector<Pose> path(3, DeepestPose(run));
  path[0].translation() += 0.05 * Vector3(run.bone.site.axis);
  // this pose is a micrometre higher, so that the pose on the axis remains the deepest
  path[2].translation() +=
      kAside_m * Vector3(run.bone.site.axis).unitOrthogonal() + kLift_m * Vector3(run.bone.site.axis);
  const CarvedSurface carved = SurfaceOf(run, path);
  EXPECT_NEAR(carved.error.max_over_m, kAside_m, 0.03e-3);
  EXPECT_GT(carved.error.mean_m, 0.05e-3);
  EXPECT_GT(carved.error.max_under_m, -0.05e-3);
}

TEST(BoneView, TheGridIsCoarserWhereThereAreTooManyTriangles) {
  const SyntheticRun run = MakeSyntheticRun(kStraight);
  const std::vector<Pose> path = PathOf(run);
  const CarvedSurface fine = SurfaceOf(run, path), coarse = SurfaceOf(run, path, fine.quads / 3);
  EXPECT_LE(coarse.quads, fine.quads / 3);
  EXPECT_GT(coarse.quads, fine.quads / 8);
  EXPECT_GT(coarse.layout.voxel_mm, fine.layout.voxel_mm);
}

TEST(BoneView, CarvingAPathAtOnceEqualsCarvingItFrameByFrame) {
  const SyntheticRun run = MakeSyntheticRun(kStraight);
  const std::vector<Pose> path = PathOf(run);
  constexpr float kVoxel_mm = 0.5F;
  const auto uncut = surface::UnionOfBalls(run.bone, kVoxel_mm);
  surface::CarvedField at_once(uncut), by_frames(uncut);
  CarveAlong(at_once, {.tool = &run.tool, .X_GP = path});
  for (const surface::Capsule& capsule : CapsulesAlong({.tool = &run.tool, .X_GP = path}))
    by_frames.Carve({&capsule, 1});
  std::size_t swept = 0;
  for (surface::BrickIndex brick = 0; brick < uncut->layout().Count(); ++brick) {
    EXPECT_TRUE(at_once.swept().SameValues(by_frames.swept(), brick)) << brick;
    swept += at_once.swept().HasValues(brick) ? 1 : 0;
  }
  EXPECT_GT(swept, 10u);
}

TEST(BoneView, EveryVertexOfACutFaceHasADeviation) {
  const SyntheticRun run = MakeSyntheticRun(kStraight);
  const std::vector<Pose> path = PathOf(run);
  const CarvedSurface carved = SurfaceOf(run, path);
  std::size_t cut = 0, at = 0;
  surface::SurfaceChunk chunk;
  while (at < carved.chunks.size()) {
    const auto read = surface::ReadChunk(carved.layout, std::span(carved.chunks).subspan(at), chunk);
    ASSERT_TRUE(read.has_value());
    at += *read;
    for (const surface::SurfaceVertex& vertex : chunk.vertices) cut += vertex.cut ? 1 : 0;
  }
  EXPECT_GT(cut, 1000U);
  EXPECT_EQ(carved.deviation_um.size(), cut);
}

TEST(BoneView, WithoutACuttingToolTheViewShowsTheBoneAndNoDeviation) {
  SyntheticRun run = MakeSyntheticRun(kStraight);
  run.tool.balls.clear();
  const CarvedSurface carved = SurfaceOf(run, {});
  EXPECT_GT(carved.quads, 1000U);
  const std::string html = BoneViewHtml(carved, run.bone, {});
  EXPECT_EQ(MarkupError(html), "");
  EXPECT_EQ(html.find("data-show=\"deviation\""), std::string::npos);
  run.bone.balls.clear();
  EXPECT_EQ(BoneViewHtml(SurfaceOf(run, {}), run.bone, {}), "");
}

}  // namespace
}  // namespace osteon::report
