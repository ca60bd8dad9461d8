#include "simulation/mesh/shape_mesh.h"

#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <Eigen/Geometry>

// Tests of meshes that are made from a function's zero level, or from rings of corners one above the other.

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

/// Signed distance to a sphere of radius 10 mm.
double Sphere(const Vector3& p) { return p.norm() - 0.010; }

Eigen::AlignedBox3d Cube(double half_m) { return {Vector3::Constant(-half_m), Vector3::Constant(half_m)}; }

/// Euler characteristic, vertices - edges + triangles: 2 for a ball, 0 for a ring.
long EulerCharacteristic(const TriangleMesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  return static_cast<long>(mesh.vertices_m.size()) - static_cast<long>(edges.size()) +
         static_cast<long>(mesh.triangles.size());
}

TEST(MeshOfLevel, ASphereIsClosedAndItsVolumeErrorFallsWithTheSquareOfTheStep) {
  const double exact = 4.0 / 3.0 * kPi * 1e-6;
  double coarse_error = 0.0;
  for (const double step : {1e-3, 0.5e-3}) {
    TriangleMesh mesh = MeshOfLevel(Sphere, Cube(0.0123), step);
    const auto report = CheckMesh(mesh, "sphere");
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->shells.size(), 1u);
    EXPECT_FALSE(report->flipped);
    EXPECT_EQ(EulerCharacteristic(mesh), 2);
    const double error = (exact - SignedVolume_m3(mesh)) / exact;
    // chords instead of arcs lose about step² / (4 r²) of the volume
    EXPECT_LT(std::abs(error), 0.5 * step * step / 1e-4) << step;
    if (coarse_error != 0.0) {
      EXPECT_NEAR(coarse_error / error, 4.0, 1.0);
    }
    coarse_error = error;
    for (const Vector3& v : mesh.vertices_m) ASSERT_LT(std::abs(Sphere(v)), 0.06 * std::sqrt(3.0) * step);
  }
}

TEST(MeshOfLevel, KeepsTheHoleOfARing) {
  const auto ring = [](const Vector3& p) {
    return std::hypot(std::hypot(p.x(), p.y()) - 0.010, p.z()) - 0.003;
  };
  TriangleMesh mesh = MeshOfLevel(ring, Cube(0.0142), 0.7e-3);
  const auto report = CheckMesh(mesh, "ring");
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(EulerCharacteristic(mesh), 0);
  const double exact = 2.0 * kPi * kPi * 0.010 * 0.003 * 0.003;
  EXPECT_NEAR(SignedVolume_m3(mesh), exact, 0.03 * exact);
}

// Sums of waves give every configuration of signs at a cell's corners, including saddles.
TEST(MeshOfLevel, AnyFieldGivesAClosedManifoldWithoutSelfIntersections) {
  for (int seed = 1; seed <= 4; ++seed) {
    const auto waves = [seed](const Vector3& p) {
      double sum = 0.0;
      for (int k = 1; k <= 6; ++k)
        sum += std::sin(p.dot(Vector3(900.0 + 130.0 * k * seed, 1100.0 - 170.0 * k, 700.0 + 210.0 * seed)) +
                        k * seed);
      return sum + 40.0 * std::max(0.0, p.norm() - 0.006) / 0.001;
    };
    TriangleMesh mesh = MeshOfLevel(waves, Cube(0.0079), 0.6e-3);
    // Shells may lie inside others in any orientation, so a contradiction between shells is accepted.
    const auto report = CheckMesh(mesh, "waves");
    if (!report) {
      EXPECT_EQ(report.error().kind, MeshErrorKind::kContradictory) << seed << report.error().message;
    }
    EXPECT_GT(mesh.triangles.size(), 2000u);
  }
}

TEST(MeshOfLevel, RefusesSurfacesThatItCannotClose) {
  const auto message = [](const LevelFunction& level, double half_m, double step_m) -> std::string {
    try {
      (void)MeshOfLevel(level, Cube(half_m), step_m);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message(Sphere, 0.009, 1e-3), HasSubstr("reaches the border"));
  EXPECT_THAT(message([](const Vector3&) { return 1.0; }, 0.01, 1e-3), HasSubstr("found no inside"));
  EXPECT_THAT(message(Sphere, 0.012, 1e-6), HasSubstr("found a step of 0.001 mm"));
  EXPECT_THAT(message(Sphere, 0.012, 0.0), HasSubstr("must be positive"));
}

TEST(MeshOfRings, APrismOfNCornersHasItsExactVolume) {
  constexpr int kCorners = 7;
  std::vector<Ring> rings(3);
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < kCorners; ++i)
      rings[k].emplace_back(0.01 * std::cos(2.0 * kPi * i / kCorners),
                            0.01 * std::sin(2.0 * kPi * i / kCorners), 0.005 * k);
  TriangleMesh mesh = MeshOfRings(rings);
  const auto report = CheckMesh(mesh, "prism");
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_FALSE(report->flipped);
  const double exact = 0.5 * kCorners * 1e-4 * std::sin(2.0 * kPi / kCorners) * 0.010;
  EXPECT_NEAR(SignedVolume_m3(mesh), exact, 1e-12 * exact);
}

TEST(MeshOfRings, RefusesRingsThatDoNotMatch) {
  const Ring three{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, four{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  EXPECT_THROW((void)MeshOfRings({}), std::invalid_argument);
  EXPECT_THROW((void)MeshOfRings({three}), std::invalid_argument);
  EXPECT_THROW((void)MeshOfRings({three, four}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
