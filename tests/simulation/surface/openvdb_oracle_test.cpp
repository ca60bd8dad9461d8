// OpenVDB's headers undefine macros that other headers need, so they are included first.
#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <gtest/gtest.h>

#include "simulation/surface/welded_surface.h"
#include "tests/simulation/surface/surface_shapes.h"

// Compares our mesh's volume and area with those of OpenVDB's volumeToMesh, which meshes the same carved ball
// from exact distances on a separate grid. The two meshes have only the closed form of the shapes in common.

namespace osteon::surface {
namespace {

struct MeshFigures {
  double area_mm2{0.0}, volume_mm3{0.0};
};

/// Adds a triangle's area and its signed volume toward the origin. Over a closed mesh, these volumes sum to
/// the mesh's volume, up to the sign.
void AddTriangle(Vec3 a, Vec3 b, Vec3 c, MeshFigures& figures) {
  figures.area_mm2 += 0.5 * static_cast<double>(Norm(Cross(b - a, c - a)));
  figures.volume_mm3 += static_cast<double>(Dot(a, Cross(b, c))) / 6.0;
}

MeshFigures FiguresOf(const WeldedSurface& mesh) {
  MeshFigures figures;
  for (const auto& q : mesh.quads) {
    const auto at = [&](std::size_t k) { return mesh.vertices_mm[q[k]]; };
    AddTriangle(at(0), at(1), at(2), figures);
    AddTriangle(at(0), at(2), at(3), figures);
  }
  return figures;
}

/// Signed distance in mm to a ball of bone around the origin less the capsules: negative inside.
float CarvedBall(Vec3 p, float radius_mm, const std::vector<Capsule>& way) {
  float distance = Norm(p) - radius_mm;
  for (const Capsule& capsule : way) distance = std::max(distance, DepthIn(capsule, p));
  return distance;
}

MeshFigures OpenVdbFigures(float radius_mm, const std::vector<Capsule>& way, float voxel_mm) {
  const float band_mm = 3.0F * voxel_mm;
  const auto grid = openvdb::FloatGrid::create(band_mm);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(static_cast<double>(voxel_mm)));
  auto accessor = grid->getAccessor();
  const int reach = static_cast<int>(radius_mm / voxel_mm) + 4;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const Vec3 p{voxel_mm * static_cast<float>(x), voxel_mm * static_cast<float>(y),
                     voxel_mm * static_cast<float>(z)};
        const float distance = CarvedBall(p, radius_mm, way);
        if (distance < band_mm) accessor.setValue({x, y, z}, std::max(distance, -band_mm));
      }
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads, 0.0);
  MeshFigures figures;
  for (const openvdb::Vec4I& q : quads) {
    const auto at = [&](int k) {
      const openvdb::Vec3s& p = points[q[k]];
      return Vec3{p.x(), p.y(), p.z()};
    };
    AddTriangle(at(0), at(1), at(2), figures);
    AddTriangle(at(0), at(2), at(3), figures);
  }
  figures.volume_mm3 = std::abs(figures.volume_mm3);  // OpenVDB winds its faces the other way
  return figures;
}

class OpenVdbOracle : public testing::TestWithParam<int> {
 protected:
  static void SetUpTestSuite() { openvdb::initialize(); }
};

// The areas differ: OpenVDB's mesh has rounded rims, ours sharp ones. A sharp ridge between two cuts ends
// about a voxel early, and our voxel is twice as large. Both differences halve with the voxel.
TEST_P(OpenVdbOracle, OurMeshHasTheVolumeAndAreaOfOpenVdbs) {
  constexpr float kBone_mm = 6.0F, kVoxel_mm = 0.25F;
  std::mt19937 random(static_cast<unsigned>(40 + GetParam()));
  const float radius_mm = GetParam() % 2 == 0 ? 3.0F : 1.5F;
  const std::vector<Capsule> way = RandomToolPath(random, 4.0F, radius_mm, 6);
  CarvedField field(BallField(kBone_mm, kVoxel_mm));
  field.Carve(way);
  const MeshFigures ours = FiguresOf(WeldSurface(field));
  const MeshFigures theirs = OpenVdbFigures(kBone_mm, way, 0.5F * kVoxel_mm);
  RecordProperty("area_ratio", std::to_string(ours.area_mm2 / theirs.area_mm2));
  std::printf("volume %.2f, OpenVDB %.2f mm³; area %.2f, OpenVDB %.2f mm²\n", ours.volume_mm3,
              theirs.volume_mm3, ours.area_mm2, theirs.area_mm2);
  EXPECT_NEAR(ours.volume_mm3, theirs.volume_mm3, 0.003 * theirs.volume_mm3);
  EXPECT_NEAR(ours.area_mm2, theirs.area_mm2, 0.015 * theirs.area_mm2);
}

INSTANTIATE_TEST_SUITE_P(Cuts, OpenVdbOracle, testing::Range(0, 10));

}  // namespace
}  // namespace osteon::surface
