#include "simulation/solids/cut_zone.h"

#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "simulation/solids/acetabulum_solid.h"

// Tests of the zones of a cut: the depth of a point below a zone, in closed form.

namespace osteon::simulation {
namespace {

TEST(PathZone, DepthIsTheDistanceToTheSweptCapsules) {
  const PathZone zone({{0, 0, 0}, {0.010, 0, 0}, {0.010, 0.010, 0}}, 0.002);
  EXPECT_NEAR(zone.DepthAt({0.005, 0, -0.003}), 0.001, 1e-15);
  EXPECT_NEAR(zone.DepthAt({-0.003, 0, 0}), 0.001, 1e-15);
  EXPECT_NEAR(zone.DepthAt({0.014, 0.005, 0.003}), 0.003, 1e-15);
  EXPECT_NEAR(zone.DepthAt({0.010, 0.004, 0}), -0.002, 1e-15);
  EXPECT_NEAR(PathZone({{1, 0, 0}}, 0.05).DepthAt({0, 0, 0}), 0.95, 1e-15);
}

TEST(PathZone, RefusesEmptyPathsNonFinitePointsAndZeroRadius) {
  EXPECT_THROW(PathZone({}, 0.002), std::invalid_argument);
  EXPECT_THROW(PathZone({{0, 0, std::nan("")}}, 0.002), std::invalid_argument);
  EXPECT_THROW(PathZone({{0, 0, 0}}, 0.0), std::invalid_argument);
}

TEST(SurfaceZone, DepthIsToTheSurfaceWithinTheRegionAndToTheRegionElsewhere) {
  const AcetabulumSolid solid{{}};
  EXPECT_NEAR(SurfaceZone(solid).DepthAt({0, 0, -0.030}), 0.006, 1e-15);
  const SurfaceZone zone(solid, Ball{.center_m = Vector3(0, 0, -0.024), .radius_m = 0.010});
  EXPECT_NEAR(zone.DepthAt({0, 0, -0.030}), 0.006, 1e-15);
  EXPECT_NEAR(zone.DepthAt({0.039, 0, -0.024}), 0.029, 1e-15);
}

// A 1-Lipschitz depth changes by no more than the point moves.
TEST(CutZone, DepthIsOneLipschitz) {
  const AcetabulumSolid solid{{}};
  const CupZone cup(solid.cup());
  const PathZone path({{0, 0, 0}, {0.010, 0.003, -0.020}}, 0.004);
  const SurfaceZone surface(solid), region(solid, Ball{.center_m = Vector3(0, 0, 0), .radius_m = 0.02});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(-0.05, 0.05), near(-2e-3, 2e-3);
  for (int i = 0; i < 20000; ++i) {
    const Vector3 p(at(random), at(random), at(random));
    const Vector3 q = p + Vector3(near(random), near(random), near(random));
    for (const CutZone* zone : std::initializer_list<const CutZone*>{&cup, &path, &surface, &region})
      ASSERT_LE(std::abs(zone->DepthAt(p) - zone->DepthAt(q)), (p - q).norm() * (1.0 + 1e-12) + 1e-15);
  }
}

}  // namespace
}  // namespace osteon::simulation
