#include "simulation/solids/mass_properties.h"

#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/simulation/mesh/mesh_shapes.h"

// Tests of volume, mass, centre of mass and inertia of meshes and mass points.

namespace osteon::simulation {
namespace {

/// The mesh rotated by R about the origin, then shifted by p.
TriangleMesh Moved(TriangleMesh mesh, const Matrix3& R, const Vector3& p) {
  for (Vector3& v : mesh.vertices_m) v = R * v + p;
  return mesh;
}

/// Inertia of a box about its centre of mass [kg m^2].
Matrix3 BoxInertia(double mass, const Vector3& size) {
  const Vector3 s = size.cwiseProduct(size);
  return mass / 12.0 * Vector3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y()).asDiagonal();
}

TEST(MassProperties, AgreeWithTheClosedFormsForABox) {
  const Vector3 low(0.01, -0.02, 0.5), size(0.04, 0.02, 0.01);
  const MassProperties box = MeshMassProperties(MakeBox(low, low + size), 1850.0);
  const double mass = 1850.0 * size.prod();
  EXPECT_NEAR(box.volume_m3, size.prod(), 1e-12 * size.prod());
  EXPECT_NEAR(box.mass_kg, mass, 1e-12 * mass);
  EXPECT_NEAR((box.center_of_mass_m - (low + 0.5 * size)).norm(), 0.0, 1e-14);
  const Matrix3 exact = BoxInertia(mass, size);
  EXPECT_NEAR((box.inertia_kg_m2 - exact).norm(), 0.0, 1e-12 * exact.norm());
}

TEST(MassProperties, ConvergeToABallsAsAnIcosphereIsRefined) {
  const double radius = 0.02, density = 300.0;
  double last_error = 0.0;
  for (const int rounds : {3, 4}) {
    const MassProperties ball = MeshMassProperties(MakeIcosphere({0.3, 0.2, -0.1}, radius, rounds), density);
    const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
    const double inertia = 0.4 * density * volume * radius * radius;
    const double error = (ball.inertia_kg_m2 - inertia * Matrix3::Identity()).norm() / inertia;
    EXPECT_NEAR((ball.center_of_mass_m - Vector3(0.3, 0.2, -0.1)).norm(), 0.0, 1e-12);
    if (rounds == 4) {
      EXPECT_NEAR(ball.volume_m3, volume, 0.005 * volume);
      EXPECT_NEAR(last_error / error, 4.0, 0.2);  // facets half as wide are a quarter as far from the sphere
      EXPECT_LT(error, 0.01);
    }
    last_error = error;
  }
}

TEST(MassProperties, RotateWithTheBodyAndDoNotDependOnItsPosition) {
  TriangleMesh mesh = MakeIcosphere({0, 0, 0}, 0.02, 2);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(0.5, 1.5);
  for (Vector3& v : mesh.vertices_m) v *= u(random);
  const MassProperties here = MeshMassProperties(mesh, 1000.0);
  const Matrix3 R = Eigen::AngleAxisd(1.1, Vector3(1, -2, 0.5).normalized()).toRotationMatrix();
  const Vector3 p(5.0, -3.0, 2.0);  // far away: sums about the origin would lose nine digits
  const MassProperties there = MeshMassProperties(Moved(mesh, R, p), 1000.0);
  EXPECT_NEAR(there.volume_m3, here.volume_m3, 1e-11 * here.volume_m3);
  EXPECT_NEAR((there.center_of_mass_m - (R * here.center_of_mass_m + p)).norm(), 0.0, 1e-13);
  const Matrix3 turned = R * here.inertia_kg_m2 * R.transpose();
  EXPECT_NEAR((there.inertia_kg_m2 - turned).norm(), 0.0, 1e-10 * turned.norm());
}

TEST(MassProperties, AreCombinedByTheParallelAxisTheorem) {
  const TriangleMesh left = MakeBox({0, 0, 0}, {0.01, 0.02, 0.03}),
                     right = MakeBox({0.05, 0, 0}, {0.06, 0.02, 0.03});
  const std::vector<MassProperties> parts{MeshMassProperties(left, 700.0), MeshMassProperties(right, 700.0)};
  const MassProperties together = Combine(parts), joined = MeshMassProperties(Join(left, right), 700.0);
  EXPECT_NEAR(together.mass_kg, joined.mass_kg, 1e-14);
  EXPECT_NEAR((together.center_of_mass_m - joined.center_of_mass_m).norm(), 0.0, 1e-14);
  EXPECT_NEAR((together.inertia_kg_m2 - joined.inertia_kg_m2).norm(), 0.0,
              1e-13 * joined.inertia_kg_m2.norm());
  // calculated by hand: two masses m at a distance d = 50 mm add m d²/2 about y and z
  const double m = 700.0 * 6e-6, more = 0.5 * m * 0.05 * 0.05;
  const Matrix3 exact =
      2.0 * BoxInertia(m, {0.01, 0.02, 0.03}) + Matrix3(Vector3(0, more, more).asDiagonal());
  EXPECT_NEAR((joined.inertia_kg_m2 - exact).norm(), 0.0, 1e-12 * exact.norm());
}

TEST(MassProperties, UseARegionsDensityInsteadOfItsSurroundings) {
  LoadedMesh loaded;
  loaded.mesh = MakeBox({0, 0, 0}, {0.02, 0.02, 0.02});
  loaded.regions.push_back({.name = "core", .mesh = MakeBox({0, 0, 0}, {0.01, 0.02, 0.02}), .parent = {}});
  const std::vector<double> densities{1000.0, 3000.0};
  const MassProperties found = MeshMassProperties(loaded, densities);
  EXPECT_NEAR(found.volume_m3, 8e-6, 1e-18);
  EXPECT_NEAR(found.mass_kg, 0.016, 1e-15);  // 4 cm³ of each
  EXPECT_NEAR(found.center_of_mass_m.x(), (0.012 * 0.005 + 0.004 * 0.015) / 0.016, 1e-15);
  const std::vector<MassProperties> halves{
      MeshMassProperties(MakeBox({0, 0, 0}, {0.01, 0.02, 0.02}), 3000.0),
      MeshMassProperties(MakeBox({0.01, 0, 0}, {0.02, 0.02, 0.02}), 1000.0)};
  EXPECT_NEAR((found.inertia_kg_m2 - Combine(halves).inertia_kg_m2).norm(), 0.0, 1e-18);
}

// A box of two materials is represented by a lattice of points, each of which counts as a ball. A ball has
// less inertia than the cube of equal volume and side s that it stands for: 2/5 (3/4π)^⅔ = 0.154 instead of
// 1/6 of m s².
TEST(MassProperties, OfMassPointsEqualTheBodysExceptForEachPointsOwnInertia) {
  std::vector<MassPoint> points;
  const int n = 20;
  const double side = 0.02 / n;
  for (int i = 0; i < n * n * n; ++i) {
    const Vector3 p = side * Vector3(i % n + 0.5, i / n % n + 0.5, i / (n * n) + 0.5);
    points.push_back({.p_m = p,
                      .volume_m3 = side * side * side,
                      .material = p.x() < 0.01 ? std::uint8_t{1} : std::uint8_t{0}});
  }
  std::vector<Material> materials(2);
  materials[0].density_kg_per_m3 = 1000.0;
  materials[1].density_kg_per_m3 = 3000.0;
  const MassProperties cloud = PointMassProperties(points, materials);
  EXPECT_NEAR(cloud.volume_m3, 8e-6, 1e-15);
  EXPECT_NEAR(cloud.mass_kg, 0.016, 1e-12);
  EXPECT_NEAR((cloud.center_of_mass_m - Vector3(0.0075, 0.01, 0.01)).norm(), 0.0, 1e-14);
  const std::vector<MassProperties> halves{
      MeshMassProperties(MakeBox({0, 0, 0}, {0.01, 0.02, 0.02}), 3000.0),
      MeshMassProperties(MakeBox({0.01, 0, 0}, {0.02, 0.02, 0.02}), 1000.0)};
  const Matrix3 exact = Combine(halves).inertia_kg_m2;
  const double missing =
      (1.0 / 6.0 - 0.4 * std::pow(0.75 / std::numbers::pi, 2.0 / 3.0)) * 0.016 * side * side;
  EXPECT_NEAR((cloud.inertia_kg_m2 + missing * Matrix3::Identity() - exact).norm(), 0.0,
              1e-12 * exact.norm());
  points[7].material = 2;
  EXPECT_THROW(static_cast<void>(PointMassProperties(points, materials)), std::invalid_argument);
}

TEST(MassProperties, AreZeroForEmptyInput) {
  EXPECT_EQ(MeshMassProperties(TriangleMesh{}, 1000.0).mass_kg, 0.0);
  EXPECT_EQ(PointMassProperties({}, {}).mass_kg, 0.0);
  EXPECT_EQ(Combine({}).center_of_mass_m, Vector3(0, 0, 0));
}

}  // namespace
}  // namespace osteon::simulation
