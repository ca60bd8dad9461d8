#include "simulation/surface/surface_export.h"

#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>
#include <unistd.h>

#include "simulation/solids/box_solid.h"
#include "simulation/surface/bone_solid.h"
#include "tests/simulation/surface/surface_shapes.h"

namespace osteon::surface {
namespace {

namespace fs = std::filesystem;

class SurfaceExport : public testing::Test {
 protected:
  SurfaceExport() : folder_(fs::temp_directory_path() / ("osteon_surface_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~SurfaceExport() override { fs::remove_all(folder_); }

  static CarvedField CutBlock() {
    CarvedField field(BlockField(6.0F, 6.0F, 0.5F));
    std::mt19937 random(31);
    field.Carve(RandomToolPath(random, 2.0F, 3.0F, 30));
    return field;
  }

  fs::path folder_;
};

TEST_F(SurfaceExport, WritesClosedMeshesThatLoadWithTheSameVolume) {
  const CarvedField field = CutBlock();
  for (const char* name : {"a.stl", "a.PLY", "a.obj"}) {
    SCOPED_TRACE(name);
    const auto written = WriteSurface(folder_ / name, field);
    ASSERT_TRUE(written) << written.error().Text();
    EXPECT_TRUE(written->watertight);
    const auto read = simulation::LoadMesh(folder_ / name);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->mesh.triangles.size(), written->triangles);
    EXPECT_FALSE(read->report.flipped);
    // A file's quads are split along one diagonal, VolumeOf splits them along the other.
    EXPECT_NEAR(1e9 * simulation::SignedVolume_m3(read->mesh), written->volume_mm3,
                0.002 * written->volume_mm3);
  }
}

TEST_F(SurfaceExport, WritesAnEmptyMeshWhereNothingIsLeft) {
  CarvedField field(BallField(3.0F, 0.5F));
  const Capsule all{{0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}, 10.0F};
  field.Carve({&all, 1});
  const auto written = WriteSurface(folder_ / "none.stl", field);
  ASSERT_TRUE(written);
  EXPECT_EQ(written->triangles, 0U);
  EXPECT_FALSE(written->watertight);
  EXPECT_EQ(fs::file_size(folder_ / "none.stl"), 84U);  // header and count
}

TEST_F(SurfaceExport, RefusesAMissingFolderAndAnUnknownFormat) {
  EXPECT_FALSE(WriteSurface(folder_ / "missing" / "a.stl", CutBlock()));
  EXPECT_EQ(ValidateSurfaceName("bone.Stl"), "");
  EXPECT_NE(ValidateSurfaceName("bone.step").find("found bone.step"), std::string::npos);
}

TEST(BoneSolid, SamplesASolidInMillimetres) {
  const simulation::BoxSolid box(simulation::BlockShape{});
  const auto field = SampleSolid(box, 0.5F);
  const Vector3 size_mm = 1e3 * box.Bounds().sizes();
  const double volume_mm3 = VolumeOf(WeldSurface(CarvedField(field)));
  EXPECT_NEAR(volume_mm3, size_mm.prod(), 0.01 * size_mm.prod());
}

TEST(BoneSolid, GivesEachCutVertexItsTissue) {
  const auto block = std::make_shared<const simulation::BoxSolid>(
      Vector3(0, 0, -0.01), Vector3(0.01, 0.01, 0), std::vector<simulation::TissueLayer>{{2, 0.003}}, 1);
  CarvedField field(SampleSolid(*block, 0.5F));
  const Capsule drill{{5.0F, 5.0F, 5.0F}, {5.0F, 5.0F, -5.0F}, 2.0F};
  field.Carve({&drill, 1});
  const MaterialAt tissue = TissueOf(block);
  std::size_t layer = 0, core = 0;
  SurfaceChunk chunk;
  for (BrickIndex brick = 0; brick < field.layout().Count(); ++brick) {
    ExtractChunk(field, brick, chunk, {}, tissue);
    for (const SurfaceVertex& v : chunk.vertices) {
      // at the layers' boundary, z = -3 mm, either tissue is right
      if (!v.cut || std::abs(v.p_mm.z + 3.0F) < 0.1F) continue;
      ASSERT_EQ(v.material, v.p_mm.z > -3.0F ? 2 : 1);
      ++(v.material == 2 ? layer : core);
    }
  }
  EXPECT_GT(layer, 50U);
  EXPECT_GT(core, 50U);
}

TEST(BoneSolid, MakesTheUnionOfAPackingsBalls) {
  simulation::Bone bone;
  bone.balls.push_back({.center_m = Vector3(0.1, 0, 0), .radius_m = 0.005});
  bone.balls.push_back({.center_m = Vector3(0.1, 0, 0), .radius_m = 0.0});
  const double volume_mm3 = VolumeOf(WeldSurface(CarvedField(UnionOfBalls(bone, 0.25F))));
  EXPECT_NEAR(volume_mm3, 4.0 / 3.0 * std::numbers::pi * 125.0, 3.0);
  bone.balls.clear();
  EXPECT_THROW((void)UnionOfBalls(bone, 0.25F), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::surface
