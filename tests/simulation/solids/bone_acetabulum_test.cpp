#include "simulation/solids/acetabulum_solid.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>

// Tests of the generated acetabulum: its distance, tissues, cut zone and limits of size.

namespace osteon::simulation {
namespace {

/// Points of the default shape's surface, spaced by less than `step`.
std::vector<Vector3> SampleSurface(double step) {
  std::vector<Vector3> points;
  const int n = static_cast<int>(std::ceil(0.08 / step));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const double a = -0.04 + 0.08 * i / n, b = -0.04 + 0.08 * j / n, c = -0.06 * j / n;
      for (const double side : {-0.04, 0.04}) {
        points.emplace_back(side, a, c);
        points.emplace_back(a, side, c);
      }
      points.emplace_back(a, b, -0.06);
      if (std::hypot(a, b) >= 0.024) points.emplace_back(a, b, 0.0);
    }
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j < 3 * n; ++j) {
      const double polar = 0.5 * M_PI * i / n, around = 2.0 * M_PI * j / (3 * n);
      points.push_back(0.024 * Vector3(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                                       -std::cos(polar)));
    }
  return points;
}

// Oracle: the distance to the nearest of many surface points exceeds the exact distance by less than the
// points' spacing.
TEST(AcetabulumSolid, DistanceAgreesWithThatToASampledSurface) {
  const AcetabulumSolid solid{{}};
  const double step = 1e-3;
  const std::vector<Vector3> surface = SampleSurface(step);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int i = 0; i < 1500; ++i) {
    const Vector3 p(0.06 * u(random), 0.06 * u(random), -0.03 + 0.06 * u(random));
    double sampled = 1.0;
    for (const Vector3& s : surface) sampled = std::min(sampled, (s - p).norm());
    const SurfacePoint nearest = solid.NearestSurface(p);
    ASSERT_LE(std::abs(nearest.distance_m), sampled + 1e-12) << p.transpose();
    ASSERT_GE(std::abs(nearest.distance_m), sampled - step) << p.transpose();
    ASSERT_NEAR((nearest.p_m - p).norm(), std::abs(nearest.distance_m), 1e-15);
    const bool inside =
        p.cwiseAbs().head<2>().maxCoeff() < 0.04 && p.z() < 0 && p.z() > -0.06 && p.norm() > 0.024;
    ASSERT_EQ(nearest.distance_m < 0.0, inside) << p.transpose();
  }
}

TEST(AcetabulumSolid, TissueIsLayeredBelowTheCup) {
  const AcetabulumSolid solid{{}};
  for (const Vector3& u :
       {Vector3(0, 0, -1), Vector3(0.6, 0, -0.8), Vector3(0, 0.999, -std::sqrt(1 - 0.999 * 0.999))}) {
    EXPECT_EQ(solid.MaterialAt(0.0259 * u), kCartilage);
    EXPECT_EQ(solid.MaterialAt(0.0261 * u), kCortical);
    EXPECT_EQ(solid.MaterialAt(0.0269 * u), kCortical);
    EXPECT_EQ(solid.MaterialAt(0.0271 * u), kCancellous);
  }
  EXPECT_EQ(solid.MaterialAt({0.039, 0.039, -0.059}), kCancellous);  // no cortical shell there
}

TEST(CupZone, DepthIsTheDistanceFromTheSweepOfAReamerOfTheCupsRadius) {
  const CupZone zone(AcetabulumSolid{{}}.cup());
  EXPECT_NEAR(zone.DepthAt({0, 0, -0.030}), 0.006, 1e-15);
  EXPECT_NEAR(zone.DepthAt({0.030, 0, 0.010}), 0.006, 1e-15);  // beside the reamer's path into the cup
  EXPECT_LT(zone.DepthAt({0.010, 0, 0.050}), 0.0);
}

TEST(AcetabulumSolid, WrongSizesAreNamedWithTheirRange) {
  const auto message = [](const AcetabulumShape& shape) -> std::string {
    try {
      const AcetabulumSolid solid(shape);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({.cup_radius_m = -0.024}), "acetabulum: cup radius: found -24 mm, accepted 2 … 38 mm");
  EXPECT_EQ(message({.cup_radius_m = 0.039}), "acetabulum: cup radius: found 39 mm, accepted 2 … 38 mm");
  EXPECT_THAT(message({.width_m = std::nan("")}), testing::HasSubstr("width: found nan mm"));
  EXPECT_THAT(message({.cartilage_m = -1e-3}),
              testing::HasSubstr("cartilage thickness: found -1 mm, accepted 0 … 20 mm"));
  EXPECT_EQ(message({}), "accepted");
}

}  // namespace
}  // namespace osteon::simulation
