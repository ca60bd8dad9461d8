#include "simulation/solids/mesh_solid.h"

#include <limits>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "simulation/mesh/triangle_tree.h"
#include "tests/simulation/bone/cup_bone.h"
#include "tests/simulation/mesh/mesh_shapes.h"

namespace osteon::simulation {
namespace {

TEST(MeshSolid, IcosphereDistanceIsTheSpheresWithinTheFacetsSagitta) {
  const Vector3 center(0.1, -0.13, 0.5);
  const double radius = 0.02;
  const TriangleMesh mesh = MakeIcosphere(center, radius, 4);
  // The mesh lies between two spheres: inside the exact one, and outside the one that touches the plane of
  // the innermost triangle.
  double sag = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vector3 a = mesh.vertices_m[t[0]];
    const Vector3 n = (mesh.vertices_m[t[1]] - a).cross(mesh.vertices_m[t[2]] - a).normalized();
    sag = std::max(sag, radius - n.dot(a - center));
  }
  ASSERT_LT(sag, 0.002 * radius);
  const MeshSolid solid(mesh);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> scale(0.0, 2.0);
  for (int i = 0; i < 2000; ++i) {
    const Vector3 u = Vector3(normal(random), normal(random), normal(random)).normalized();
    const Vector3 p = center + scale(random) * radius * u;
    const double exact = (p - center).norm() - radius;
    const SurfacePoint nearest = solid.NearestSurface(p);
    ASSERT_GE(nearest.distance_m, exact - 1e-9);
    ASSERT_LE(nearest.distance_m, exact + sag + 1e-9);
    ASSERT_NEAR((nearest.p_m - p).norm(), std::abs(nearest.distance_m), 1e-15);
  }
}

TEST(MeshSolid, TheDistanceToABoxIsExactAtItsFacesEdgesAndCorners) {
  const Vector3 half(0.02, 0.015, 0.01);
  const MeshSolid solid(MakeBox(-half, half));
  std::mt19937 random(8);
  std::uniform_real_distribution<double> u(-0.04, 0.04);
  for (int i = 0; i < 3000; ++i) {
    const Vector3 p(u(random), u(random), u(random));
    // exact distance to a box: the outside part plus the inside part
    const Vector3 q = p.cwiseAbs() - half;
    const double exact = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
    ASSERT_NEAR(solid.SignedDistance(p), exact, 1e-12) << p.transpose();
  }
}

// If the nearest feature is a sharp vertex, the normal of one of its faces may give the wrong sign. Only the
// angle-weighted pseudonormal gives the right one. Oracle: parity of the crossings of a ray with all
// triangles.
TEST(MeshSolid, TheSignAgreesWithCountedCrossingsOnASpikyMesh) {
  TriangleMesh mesh = MakeIcosphere({0, 0, 0}, 0.02, 2);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> stretch(0.4, 1.6);
  for (Vector3& v : mesh.vertices_m) v *= stretch(random);  // star-shaped: no self-intersection
  ASSERT_TRUE(CheckMesh(mesh, "spikes"));
  const MeshSolid solid(mesh);
  const auto inside_by_parity = [&mesh](const Vector3& p) {
    const Vector3 ray = Vector3(0.3, 0.5, 0.81).normalized();
    int crossings = 0;
    for (const auto& t : mesh.triangles) {
      Matrix3 m;
      m << mesh.vertices_m[t[1]] - mesh.vertices_m[t[0]], mesh.vertices_m[t[2]] - mesh.vertices_m[t[0]], -ray;
      const Vector3 x = m.inverse() * (p - mesh.vertices_m[t[0]]);
      if (x[0] >= 0 && x[1] >= 0 && x[0] + x[1] <= 1 && x[2] > 0) ++crossings;
    }
    return crossings % 2 == 1;
  };
  std::uniform_real_distribution<double> u(-0.035, 0.035);
  int inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3 p(u(random), u(random), u(random));
    ASSERT_EQ(solid.SignedDistance(p) < 0.0, inside_by_parity(p)) << p.transpose();
    inside += inside_by_parity(p) ? 1 : 0;
  }
  EXPECT_GT(inside, 200);
}

/// Oracle: measures every triangle; among equally near triangles the first one wins.
class NearestOfAll {
 public:
  explicit NearestOfAll(const TriangleMesh& mesh) {
    for (const auto& triangle : mesh.triangles) {
      TriangleMesh one;
      for (const std::uint32_t i : triangle) one.vertices_m.push_back(mesh.vertices_m[i]);
      one.triangles.push_back({0, 1, 2});
      triangles_.push_back(std::make_unique<TriangleTree>(one));
    }
  }
  [[nodiscard]] TriangleHit operator()(const Vector3& p) const {
    TriangleHit best;
    best.distance_m = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      TriangleHit hit = triangles_[i]->Nearest(p);
      hit.triangle = i;
      if (hit.distance_m < best.distance_m) best = hit;
    }
    return best;
  }

 private:
  std::vector<std::unique_ptr<TriangleTree>> triangles_;
};

// The tree's boxes hold floats: their rounding must never exclude the nearest triangle. Needles have no
// normal in floats; small meshes have partly filled nodes.
TEST(TriangleTree, FindsTheNearestOfAllTrianglesToTheLastBit) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto point = [&](double size) -> Vector3 { return size * Vector3(u(random), u(random), u(random)); };
  TriangleMesh needles;  // 0.1 um wide, 30 mm long, half a metre from the origin
  for (int i = 0; i < 40; ++i) {
    const Vector3 a = Vector3(0.3, 0.4, 0.1) + point(0.02), along = point(0.015), across = point(1e-7);
    needles.vertices_m.insert(needles.vertices_m.end(), {a, a + along, a + along + across});
    needles.triangles.push_back({3u * i, 3u * i + 1, 3u * i + 2});
  }
  TriangleMesh soup;
  for (int i = 0; i < 7; ++i) {
    soup.vertices_m.insert(soup.vertices_m.end(), {point(0.02), point(0.02), point(0.02)});
    soup.triangles.push_back({3u * i, 3u * i + 1, 3u * i + 2});
  }
  TriangleMesh triangle = soup;
  triangle.triangles.resize(1);
  for (const TriangleMesh& mesh :
       {MakeIcosphere({0.1, -0.2, 0.5}, 0.02, 2), MakeBox({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}), needles,
        soup, triangle}) {
    const TriangleTree tree(mesh);
    const NearestOfAll nearest_of_all(mesh);
    Eigen::AlignedBox3d box;
    for (const Vector3& v : mesh.vertices_m) box.extend(v);
    for (int i = 0; i < 300; ++i) {
      Vector3 p = box.center() + point(box.sizes().maxCoeff());
      // at a corner, on a face, far away; on a box's diagonals many are equally near
      if (i % 5 == 1) p = mesh.vertices_m[random() % mesh.vertices_m.size()];
      if (i % 5 == 2) p = tree.Nearest(p).p_m;
      if (i % 25 == 3) p *= 50.0;
      if (i % 25 == 4) p = box.center();
      const TriangleHit found = tree.Nearest(p), exact = nearest_of_all(p);
      ASSERT_EQ(found.distance_m, exact.distance_m) << p.transpose();
      ASSERT_EQ(found.triangle, exact.triangle);
      ASSERT_EQ(found.feature, exact.feature);
      ASSERT_EQ(found.p_m, exact.p_m);
    }
  }
}

// Each thread caches its last search. A cached result must never answer for another tree, not even for a tree
// made at the address of a destroyed one.
TEST(TriangleTree, RepeatedQueryIsNotAnsweredFromAnotherTreesCache) {
  const Vector3 p(0.001, 0.002, 0.003);
  const auto distance = [&p](double half) { return half - p.z(); };
  std::vector<std::unique_ptr<TriangleTree>> trees;
  const auto box = [](double half) { return MakeBox(Vector3::Constant(-half), Vector3::Constant(half)); };
  for (int i = 0; i < 40; ++i) trees.push_back(std::make_unique<TriangleTree>(box(0.01 + 0.001 * i)));
  for (int round = 0; round < 2; ++round)
    for (int i = 0; i < 40; ++i)
      for (int again = 0; again < 2; ++again)
        ASSERT_NEAR(trees[i]->Nearest(p).distance_m, distance(0.01 + 0.001 * i), 1e-15) << i;
  for (int i = 0; i < 40; ++i) {
    const TriangleTree short_lived(box(0.01 + 0.001 * i));
    ASSERT_NEAR(short_lived.Nearest(p).distance_m, distance(0.01 + 0.001 * i), 1e-15) << i;
  }
}

TEST(MeshSolid, CupInABlockHasLayersAndTheOtherFacesACorticalShell) {
  // The cup is a spherical cavity in a block: its lower half has the same floor as a hemispherical cup.
  const CutSite cup{.center_m = Vector3(0, 0, 0), .axis = Vector3(0, 0, 1), .radius_m = 0.02};
  const TriangleMesh mesh =
      Join(MakeBox({-0.04, -0.04, -0.04}, {0.04, 0.04, 0.04}), InsideOut(MakeIcosphere({0, 0, 0}, 0.02, 4)));
  const MeshSolid solid(mesh, CupBoneTissue({}, cup));
  const Vector3 down = Vector3(0.3, 0.2, -1).normalized();
  EXPECT_EQ(solid.MaterialAt(0.0215 * down), kCartilage);
  EXPECT_EQ(solid.MaterialAt(0.0225 * down), kCortical);
  EXPECT_EQ(solid.MaterialAt(0.0235 * down), kCancellous);
  EXPECT_EQ(solid.MaterialAt(-0.0210 * down), kCortical);  // beyond the cup's opening
  EXPECT_EQ(solid.MaterialAt(-0.0220 * down), kCancellous);
  EXPECT_EQ(solid.MaterialAt({0.01, 0.01, -0.039}), kCortical);  // the outer face
  EXPECT_EQ(solid.MaterialAt({0.01, 0.01, -0.038}), kCancellous);
}

}  // namespace
}  // namespace osteon::simulation
