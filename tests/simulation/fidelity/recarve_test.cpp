#include "simulation/fidelity/recarve.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "simulation/engine/reference_engine.h"
#include "simulation/fidelity/accuracy.h"
#include "simulation/fidelity/carved_shape.h"
#include "simulation/fidelity/packing_level.h"
#include "simulation/fidelity/scene_workload.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/tools/swept_tool.h"
#include "simulation/tools/tool_path.h"

// Tests of repacking during a cut: another packing of the same solid is carved along the path that the tool
// has taken, and then replaces the first packing.

namespace osteon::simulation {
namespace {

constexpr double kHeadRadius_m = 3e-3;

/// A block of 20 × 20 × 10 mm with a path that enters it and goes 10 mm along.
SceneParams BlockScene() {
  SceneParams scene;
  scene.shape = BlockShape{.width_m = 20e-3, .depth_m = 20e-3, .height_m = 10e-3, .layers = {}, .core = 0};
  scene.site = {.x_m = 0.0, .y_m = 0.0, .radius_m = kHeadRadius_m};
  scene.zone = {.kind = ZoneParams::Kind::kPath,
                .radius_m = kHeadRadius_m,
                .path_C_m = {Vector3(-5e-3, 0, 4e-3), Vector3(-5e-3, 0, 0), Vector3(5e-3, 0, -1e-3)}};
  scene.material_names = {"bone"};
  scene.materials = {DefaultBoneMaterials().front()};
  scene.materials.front().name = "bone";
  scene.points.cells = {.finest_m = 1e-3, .coarser_from_m = {3e-3, 5e-3}};
  return scene;
}

Tool RoundBurr() {
  Tool tool;
  tool.name = "ball";
  tool.balls = {{.center_m = {}, .radius_m = kHeadRadius_m, .cutting = true}};
  return tool;
}

/// A burr's workload in the block, and packings of the block to carve with it.
class Recarve : public testing::Test {
 protected:
  Recarve()
      : scene_(BlockScene()),
        solid_(MakeSceneSolid(scene_)),
        tool_(RoundBurr()),
        work_(MakeSceneWorkload(solid_, scene_, tool_, {})),
        cut_(ShapeOfCut(work_, scene_)) {}

  /// The scene's bone in a graded packing of this spacing; mass points do not depend on the spacing.
  Bone Packed(double spacing_m) const {
    const PackingLevel level = MakeLevel(PackingKind::kGraded, spacing_m, 1.2, cut_, 0.0);
    return SceneBone(solid_, scene_, PackLevel(level, *solid_.solid, *work_.zone),
                     BuildMassPoints(*solid_.solid, *work_.zone, scene_.points));
  }
  ReferenceEngine Engine(const Bone& bone) const { return {bone, tool_, Pose::Identity(), work_.cutting}; }

  SceneParams scene_;
  SceneSolid solid_;
  Tool tool_;
  CutWorkload work_;
  CutShape cut_;
};

// The finer packing is cut and the proxy's path recorded. The coarser one is carved along the path and takes
// over.
TEST_F(Recarve, ACoarserPackingIsCarvedLikeTheFinerOne) {
  const double fine_m = 0.8e-3, coarse_m = 1.3e-3;
  ReferenceEngine fine = Engine(Packed(fine_m));
  ProxyTrail trail(ToolLever(tool_), 20e-6);
  ContactModel last;
  for (std::size_t k = 0; k < work_.cut_end; ++k) {
    last = fine.Step(work_.frames[k]);
    ASSERT_EQ(last.status, EngineStatus::kOk);
    trail.Add(last.X_WP);
  }
  ASSERT_GT(last.removed_volume_m3, 100e-9);

  const Bone bone = Packed(coarse_m);
  ReferenceEngine coarse = Engine(bone);
  ASSERT_TRUE(CarveTrail(coarse, trail.places()));
  const CarvedState counted = fine.Snapshot(), carved = coarse.Snapshot();
  EXPECT_TRUE(ReachedPose(carved, Pose(counted.X_GP), ToolLever(tool_), 1e-6));
  EXPECT_FALSE(ReachedPose(carved, Pose(counted.X_GP) * Pose(Eigen::Translation3d(0, 0, 2e-6)),
                           ToolLever(tool_), 1e-6));

  // The remaining bone must be clear of the tool's path. Beyond the path it must lack as much bone as if the
  // tool had cut the coarse packing directly.
  ReferenceEngine direct = Engine(bone);
  for (std::size_t k = 0; k < work_.cut_end; ++k) direct.Step(work_.frames[k]);
  const auto measured = [&](const ReferenceEngine& engine) {
    return MeasureCut(*solid_.solid, BallUnion(bone.balls), BallUnion(LiveBalls(engine.Snapshot())),
                      SweptTool(tool_, work_.CutPath()),
                      {.probe_radii_m = {}, .surface_cells = 12'000, .probe_samples = 2000});
  };
  const CutAccuracy cut = measured(coarse), own = measured(direct);
  EXPECT_LT(cut.MeanLeft_m(), 0.02e-3);
  EXPECT_NEAR(cut.depth_error_m, own.depth_error_m, 0.05 * own.depth_error_m);

  // The coarse engine replaces the fine one: the totals of removed volume and mass must continue, and the
  // tool must touch the cut face at the same place.
  coarse.Restore(MergeCarvedStates(carved, counted));
  const FrameInput& pressed = work_.frames[work_.feel_begin];
  const ContactModel a = fine.Step(pressed), b = coarse.Step(pressed);
  EXPECT_EQ(b.frame, a.frame);
  EXPECT_NEAR(b.removed_volume_m3, a.removed_volume_m3, 1e-15);
  EXPECT_NEAR(b.removed_mass_kg, a.removed_mass_kg, 1e-12);
  const double moved_m = (Vector3(a.X_WP.p) - Vector3(b.X_WP.p)).norm();
  EXPECT_LT(moved_m, 2.0 * own.depth_error_m);
  const double depth_m = (Pose(pressed.X_WT).translation() - Vector3(b.X_WP.p)).norm();
  EXPECT_GT(depth_m, 0.1e-3) << "it holds the tool";
}

// The recorded path covers half of the cut. The second packing must be cut along that half and intact beyond.
TEST_F(Recarve, BoneBeyondTheTrailStays) {
  ReferenceEngine fine = Engine(Packed(0.8e-3));
  ProxyTrail half(ToolLever(tool_), 20e-6);
  for (std::size_t k = 0; k < work_.cut_end / 2; ++k) half.Add(fine.Step(work_.frames[k]).X_WP);
  const Bone bone = Packed(1.3e-3);
  ReferenceEngine coarse = Engine(bone);
  ASSERT_TRUE(CarveTrail(coarse, half.places()));
  const BallUnion left(LiveBalls(coarse.Snapshot()));
  const auto center = [&](std::size_t k) {
    return Vector3(Pose(work_.frames[k].X_WT) * Vector3(CuttingHead(tool_)->center_m));
  };
  EXPECT_GE(left.Distance(center(work_.cut_end / 2 - 1), 1.0), kHeadRadius_m - 1e-5) << "gone";
  EXPECT_LT(left.Distance(center(work_.cut_end - 1), 1.0), 0.5 * kHeadRadius_m) << "not gone";
}

TEST(ProxyTrail, DoesNotReallocateWithinItsReservedSize) {
  ProxyTrail trail(10e-3, 0.1e-3);
  trail.Add(Pose(Eigen::Translation3d(1.0, 0.0, 0.0)));
  trail.Reserve(1000);
  ASSERT_EQ(trail.places().size(), 1u);
  EXPECT_EQ(trail.places().front().p.x, 1.0);
  const PlainPose* first = trail.places().data();
  for (int i = 1; i < 1000; ++i) trail.Add(Pose(Eigen::Translation3d(1.0 + i, 0.0, 0.0)));
  EXPECT_EQ(trail.places().size(), 1000u);
  EXPECT_EQ(trail.places().data(), first);
}

TEST(ProxyTrail, KeepsPlacesAStepApartAndTheLastOne) {
  ProxyTrail trail(10e-3, 0.1e-3);
  EXPECT_EQ(trail.settled(), 0u);
  Pose X = Pose::Identity();
  for (int k = 0; k <= 100; ++k) {
    X.translation().x() = 0.01e-3 * k;
    trail.Add(X);
  }
  EXPECT_NEAR(static_cast<double>(trail.places().size()), 11.0, 1.0);
  EXPECT_EQ(Vector3(trail.places().back().p).x(), 1e-3);
  for (std::size_t i = 1; i < trail.places().size(); ++i)
    EXPECT_LE(trail.places()[i].p.x - trail.places()[i - 1].p.x, 0.1e-3 + 1e-12);
  const std::size_t before = trail.places().size();
  X.rotate(Eigen::AngleAxisd(0.1, Vector3::UnitX()));  // moves the tool's farthest point by 1 mm
  trail.Add(X);
  X.rotate(Eigen::AngleAxisd(0.1, Vector3::UnitX()));
  trail.Add(X);
  EXPECT_GE(trail.places().size(), before + 1);
  EXPECT_EQ(trail.settled(), trail.places().size() - 1);
}

TEST(MergeCarvedStates, RefusesStatesWithDifferentNumbersOfPoints) {
  CarvedState a, b;
  a.cleared.resize(3);
  b.cleared.resize(4);
  EXPECT_THROW((void)MergeCarvedStates(a, b), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
