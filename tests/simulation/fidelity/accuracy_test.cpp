#include "simulation/fidelity/accuracy.h"

#include <cmath>

#include <gtest/gtest.h>

#include "simulation/contact/cutting_math.h"
#include "simulation/solids/shell_solid.h"
#include "tests/oracles/depth_table.h"

// Tests of the accuracy of a cut, on shapes whose error is known exactly.

namespace osteon::simulation {
namespace {

/// The solid minus a sweep along the scene's path. The sweep is that of a ball that is larger than the tool
/// by `over_m` (negative: smaller).
class OvercutShape final : public CarvedShape {
 public:
  OvercutShape(const Solid& solid, const DepthScene& scene, double over_m)
      : solid_(solid), scene_(scene), radius_m_(scene.tool.balls.front().radius_m + over_m) {}

  // Distance to a box minus capsules. It is exact in the middle of the cut, which these tests use, and a
  // lower bound elsewhere.
  [[nodiscard]] double Distance(const Vector3& p, double at_most_m) const override {
    double axis = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < scene_.corners_m.size(); ++i)
      axis = std::min(axis, (p - ClosestOnSegment(p, scene_.corners_m[i], scene_.corners_m[i + 1])).norm());
    return std::clamp(std::max(solid_.SignedDistance(p), radius_m_ - axis), 0.0, at_most_m);
  }

 private:
  const Solid& solid_;
  const DepthScene& scene_;
  double radius_m_;
};

SweptTool Swept(const DepthScene& scene) { return {scene.tool, scene.Path(0.5e-3)}; }

TEST(CutAccuracy, AreaAndSweptVolumeAgreeWithTheClosedForms) {
  const DepthScene block = MakeBlockScene(), cup = MakeCupScene();
  const OvercutShape whole(*block.solid, block, -1.0), cut(*block.solid, block, 0.0);
  const CutAccuracy m = MeasureCut(*block.solid, whole, cut, Swept(block), {.surface_cells = 20'000});
  // half a ball and half a cylinder 6 mm long
  const double R = 5e-3, volume = M_PI * (2.0 / 3.0 * R * R * R + 0.5 * R * R * 6e-3);
  EXPECT_NEAR(m.swept_volume_m3, volume, 0.003 * volume);
  const double area = M_PI * (2.0 * R * R + R * 6e-3);
  EXPECT_NEAR(m.cut_area_m2, area, 0.02 * area);  // the layer is 0.1 mm thick; its edge counts half
  EXPECT_EQ(m.lost_m3, 0.0);
  EXPECT_EQ(m.left_volume_m3, 0.0);
  EXPECT_EQ(m.left_depth_m, 0.0);
  const CutAccuracy b = MeasureCut(*cup.solid, whole, whole, Swept(cup), {.surface_cells = 20'000});
  // A ball that moves down by h sweeps, below z = 0, the volume of a disc of height h more than at its start.
  const double swept = M_PI * 25e-3 * 25e-3 * 3e-3;
  EXPECT_NEAR(b.swept_volume_m3, swept, 0.005 * swept);
}

TEST(CutAccuracy, MeasuresAnOvercutThatIsTheSameEverywhere) {
  const DepthScene scene = MakeBlockScene();
  const OvercutShape whole(*scene.solid, scene, -1.0);
  for (const double over : {0.02e-3, 0.1e-3}) {
    const OvercutShape after(*scene.solid, scene, over);
    const CutAccuracy m =
        MeasureCut(*scene.solid, whole, after, Swept(scene),
                   {.probe_radii_m = {5e-3, 2.5e-3, 1e-3}, .surface_cells = 20'000, .probe_samples = 1500});
    // a layer of that thickness on a surface of radius 5: (1 + over/2R) more volume; area to 2 %
    EXPECT_NEAR(m.depth_error_m, over * (1.0 + over / 10e-3), 0.03 * over) << over;
    EXPECT_LT(m.depth_error_se_m, 0.02 * over);
    EXPECT_EQ(m.left_volume_m3, 0.0);
    for (const ProbeGap& probe : m.probes) {
      EXPECT_GT(probe.samples, 1000u);
      // in a trough that is wider all around, a ball moves further by exactly `over`
      EXPECT_NEAR(probe.mean_m, over, 0.02 * over) << probe.radius_m;
      EXPECT_NEAR(probe.p95_m, over, 0.02 * over) << probe.radius_m;
    }
  }
}

// The carved ball is 0.2 mm smaller than the tool, so a layer of this thickness is left in the tool's path.
TEST(CutAccuracy, MeasuresBoneThatIsLeftInThePath) {
  const DepthScene scene = MakeBlockScene();
  const OvercutShape whole(*scene.solid, scene, -1.0), after(*scene.solid, scene, -0.2e-3);
  const CutAccuracy m = MeasureCut(*scene.solid, whole, after, Swept(scene),
                                   {.probe_radii_m = {1e-3}, .surface_cells = 20'000});
  const double area = M_PI * (2.0 * 25e-6 + 5e-3 * 6e-3);
  EXPECT_NEAR(m.left_volume_m3, area * 0.2e-3 * (1.0 - 0.2 / 10.0), 0.03 * area * 0.2e-3);
  EXPECT_NEAR(m.left_depth_m, 0.2e-3, 0.01e-3);
  EXPECT_EQ(m.lost_m3, 0.0);
  EXPECT_EQ(m.probes[0].max_m, 0.0);
}

TEST(CutAccuracy, DoesNotDependOnThreadsAndRefusesNoCut) {
  const DepthScene scene = MakeBlockScene();
  const OvercutShape whole(*scene.solid, scene, -1.0), after(*scene.solid, scene, 0.05e-3);
  AccuracyParams params{.probe_radii_m = {1e-3}, .surface_cells = 3000, .probe_samples = 200};
  params.threads = 1;
  const CutAccuracy one = MeasureCut(*scene.solid, whole, after, Swept(scene), params);
  params.threads = 3;
  const CutAccuracy three = MeasureCut(*scene.solid, whole, after, Swept(scene), params);
  EXPECT_EQ(one.lost_m3, three.lost_m3);
  EXPECT_EQ(one.probes[0].mean_m, three.probes[0].mean_m);
  const SweptTool nothing(scene.tool, {});
  EXPECT_THROW((void)MeasureCut(*scene.solid, whole, after, nothing, params), std::invalid_argument);
  params.probe_radii_m = {0.0};
  EXPECT_THROW((void)MeasureCut(*scene.solid, whole, after, Swept(scene), params), std::invalid_argument);
}

// The largest overlap is that of the ball of radius 2.25 mm: its centre is 7 - 5 = 2 mm below the sweep, so
// the overlap is 0.25 mm. A removed ball has none.
TEST(MaxOverlap, IsThatOfTheBallDeepestInTheSweep) {
  const DepthScene scene = MakeBlockScene();
  const std::vector<Ball> balls{{.center_m = Vector3(0, 0, -7e-3), .radius_m = 1.5e-3},
                                {.center_m = Vector3(0, 0, -7e-3), .radius_m = 2.25e-3},
                                {.center_m = Vector3(0, 0, -3e-3), .radius_m = 0.0}};
  EXPECT_NEAR(MaxOverlap(balls, Swept(scene)), 0.25e-3, 1e-15);
  EXPECT_EQ(MaxOverlap({balls.data(), 1}, Swept(scene)), 0.0);
}

TEST(ShellSolid, DistanceIsThatToItsNearestSurfacePoint) {
  const ShellSolid shell(25e-3, 33e-3);
  EXPECT_NEAR(shell.SignedDistance({0, 0, -29e-3}), -4e-3, 1e-15);
  EXPECT_NEAR(shell.SignedDistance({0, 0, -26e-3}), -1e-3, 1e-15);
  EXPECT_NEAR(shell.SignedDistance({29e-3, 0, -0.5e-3}), -0.5e-3, 1e-15);
  EXPECT_NEAR(shell.SignedDistance({29e-3, 0, 2e-3}), 2e-3, 1e-15);
  EXPECT_NEAR(shell.SignedDistance({0, 20e-3, 0}), 5e-3, 1e-15);
  EXPECT_NEAR(shell.SignedDistance({0, 36e-3, 4e-3}), 5e-3, 1e-15);
  EXPECT_NEAR(shell.SignedDistance({0, 0, -40e-3}), 7e-3, 1e-15);
  EXPECT_NEAR(shell.SignedDistance({0, 0, 0}), 25e-3, 1e-15);
  EXPECT_THROW(ShellSolid(33e-3, 25e-3), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
