#include "session/setup/cell_setup.h"

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "simulation/solids/cup_frame.h"
#include "tests/io/temporary_folder.h"
#include "tests/session/set_up_cell.h"
#include "tests/simulation/mesh/mesh_shapes.h"
#include "tests/simulation/packing/packing_samples.h"

namespace osteon::session {
namespace {

const std::filesystem::path kDemoCell = OSTEON_SOURCE_DIR "/config/cells/demo.yaml";

// The error of a value of --cup, or "accepted".
std::string ErrorOf(const std::string& text) {
  const auto cup = ParseCup(text);
  return cup ? "accepted" : cup.error();
}

TEST(ParseCup, ReadsMillimetresAndAnAxisOfAnyLength) {
  const auto cup = ParseCup("8.5,-132,5e2,0,-3,4,21");
  ASSERT_TRUE(cup) << cup.error();
  // one rounding in each factor of 1e-3 and in the norm
  constexpr double kTolerance = 1e-15;
  EXPECT_LT((Vector3(cup->center_m) - Vector3(0.0085, -0.132, 0.5)).norm(), kTolerance);
  EXPECT_LT((Vector3(cup->axis) - Vector3(0.0, -0.6, 0.8)).norm(), kTolerance);
  EXPECT_NEAR(cup->radius_m, 0.021, kTolerance);
}

TEST(ParseCup, AcceptsTheEndsOfItsRangesAndNothingBeyond) {
  EXPECT_TRUE(ParseCup("2000,-2000,0,0,0,1,0.5"));
  EXPECT_TRUE(ParseCup("0,0,0,0,0,-1,60"));
  EXPECT_NE(ErrorOf("2000.1,0,0,0,0,1,21"), "accepted");
  EXPECT_NE(ErrorOf("0,0,0,0,0,1,60.1"), "accepted");
  EXPECT_NE(ErrorOf("0,0,0,0,0,1,0.49"), "accepted");
}

TEST(ParseCup, TheErrorNamesThePartTheValueAndWhatIsAccepted) {
  EXPECT_EQ(ErrorOf("1,2,3"), "--cup: found 3 values in \"1,2,3\", accepted 7: X,Y,Z,NX,NY,NZ,R in mm");
  EXPECT_EQ(ErrorOf("1,2,3,0,0,1,21,8"),
            "--cup: found 8 values in \"1,2,3,0,0,1,21,8\", accepted 7: X,Y,Z,NX,NY,NZ,R in mm");
  EXPECT_EQ(ErrorOf("1,2,3,0,0,1,-21"), "--cup: R: found -21 mm, accepted 0.5 … 60");
  EXPECT_EQ(ErrorOf("1,2,3,0,north,1,21"), "--cup: NY: found \"north\", accepted a number");
  EXPECT_EQ(ErrorOf("1,2,3000,0,0,1,21"), "--cup: Z: found 3000 mm, accepted -2000 … 2000");
  EXPECT_EQ(ErrorOf("1,2,3,0,0,0,21"),
            "--cup: NX,NY,NZ: found a zero vector, accepted the axis out of the opening");
}

TEST(ParseCup, RefusesTextThatIsNotSevenFiniteNumbers) {
  for (const char* text :
       {"", ",,,,,,", "nan,0,0,0,0,1,21", "0,inf,0,0,0,1,21", "0,0,0,0,0,1,nan", "0,0,0,0,0,1e999,21",
        "1mm,0,0,0,0,1,21", "0x10,0,0,0,0,1,21", "0,0,0,0,0,1,21,", "0;0;0;0;0;1;21"})
    EXPECT_TRUE(ErrorOf(text).starts_with("--cup: ")) << '"' << text << '"';
}

TEST(ParseCup, ReturnsAUnitAxisForAnyLengthItAccepts) {
  for (const char* text : {"0,0,0,1e-5,0,0,21", "0,0,0,1e150,0,0,21", "0,0,0,1e300,1e300,0,21"}) {
    const auto cup = ParseCup(text);
    // ParseCup may refuse an axis of extreme length, but any axis that it returns must be a unit vector
    if (cup) {
      EXPECT_NEAR(Vector3(cup->axis).norm(), 1.0, 1e-12) << text;
    }
  }
}

TEST(SetUpCell, PutsTheCupOfAMeshWhereTheScenesCupWouldBe) {
  // a block around a round hollow, far from the origin, its cup along an oblique axis
  const Vector3 center(0.3, -0.2, 0.9), axis = Vector3(1.0, -2.0, 2.0) / 3.0;
  const Vector3 half(0.035, 0.035, 0.035);
  const simulation::TriangleMesh mesh =
      simulation::Join(simulation::MakeBox(center - half, center + half),
                       simulation::InsideOut(simulation::MakeIcosphere(center, 0.024, 3)));
  const simulation::TemporaryFile file(".obj", simulation::ObjText(mesh));
  const simulation::CutSite cup{.center_m = center, .axis = axis, .radius_m = 0.024};

  const auto setup = PrepareCell(kDemoCell, MeshChoice{.file = file.path(), .cup = cup});
  ASSERT_TRUE(setup) << setup.error();
  const Pose X_WC = setup->X_WG * simulation::CupPose(cup);
  EXPECT_LT((X_WC.matrix() - setup->config.X_WG.matrix()).norm(), 1e-12);
  ASSERT_TRUE(setup->solid);
  EXPECT_LT(setup->solid->SignedDistance(center + 0.027 * axis), 0.0) << "around the hollow";
  EXPECT_GT(setup->solid->SignedDistance(center), 0.0) << "in it";
}

TEST(SetUpCell, UsesAPackingFileWithItsOwnSiteOrAGivenOne) {
  const io::test::TemporaryFolder folder;
  const auto file = folder.path() / "bone.osp";
  const simulation::Bone bone = simulation::test::SomeBone();
  ASSERT_TRUE(simulation::WritePackingFile(file, bone, {}));
  const auto setup = SetUpCell(kDemoCell, MeshChoice{.file = file});
  ASSERT_TRUE(setup) << setup.error();
  EXPECT_EQ(setup->bone.balls.size(), bone.balls.size());
  EXPECT_EQ(setup->bone.materials.size(), 3u);
  EXPECT_EQ(setup->solid, nullptr);
  const Pose X_WC = setup->X_WG * simulation::CupPose(bone.site);
  EXPECT_LT((X_WC.matrix() - setup->config.X_WG.matrix()).norm(), 1e-12);

  // a site other than the file's
  const simulation::CutSite other{
      .center_m = Vector3(0.1, 0.2, 0.3), .axis = Vector3(Vector3::UnitX()), .radius_m = 0.01};
  const auto moved = SetUpCell(kDemoCell, MeshChoice{.file = file, .cup = other});
  ASSERT_TRUE(moved) << moved.error();
  EXPECT_EQ(moved->bone.site.radius_m, 0.01);
}

TEST(SetUpCell, NamesWhatAPackingFileLacks) {
  const io::test::TemporaryFolder folder;
  const auto file = folder.path() / "bone.osp";
  const auto refusal = [&](const simulation::Bone& bone) {
    EXPECT_TRUE(simulation::WritePackingFile(file, bone, {}));
    const auto setup = SetUpCell(kDemoCell, MeshChoice{.file = file});
    return setup ? std::string("accepted") : setup.error();
  };
  simulation::Bone bone = simulation::test::SomeBone();
  bone.site.radius_m = 0.0;
  EXPECT_NE(refusal(bone).find("found a packing without a site, accepted one with it, or --cup"),
            std::string::npos);
  EXPECT_NE(refusal(simulation::test::SomeBone(5, 0)).find("without mass points"), std::string::npos);
  io::test::WriteAll(file, "no packing");
  const auto setup = SetUpCell(kDemoCell, MeshChoice{.file = file});
  ASSERT_FALSE(setup);
  EXPECT_NE(setup.error().find("bone.osp: byte 0: found"), std::string::npos) << setup.error();
}

TEST(SetUpCell, KeepsTheConfigurationAsItWasRead) {
  const auto setup = PrepareCell(kDemoCell, std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  for (const char* key : {"# cells/demo.yaml", "# robots/lbr_iiwa_14_r820.yaml", "# tools/reamer.yaml",
                          "# scenes/acetabulum.yaml", "# materials/bone.yaml", "max_force_N: 200"})
    EXPECT_NE(setup->config_text.find(key), std::string::npos) << key;
  // the scene's cup is at its own origin: the bone's frame stays as configured
  EXPECT_LT((setup->X_WG.matrix() - setup->config.X_WG.matrix()).norm(), 1e-12);
}

// Other files in the same folders, such as a note or another cell's scene, are not part of the configuration.
TEST(SetUpCell, KeepsOnlyTheFilesThatTheCellRefersTo) {
  const io::test::TemporaryFolder folder;
  std::filesystem::copy(
      OSTEON_SOURCE_DIR "/config", folder.path(),
      std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
  io::test::WriteAll(folder.path() / "scenes/note.yaml", "password: 1234\n");
  const auto setup = PrepareCell(folder.path() / "cells/demo.yaml", std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  EXPECT_NE(setup->config_text.find("# scenes/acetabulum.yaml"), std::string::npos);
  for (const char* other :
       {"password", "# scenes/molar.yaml", "# robots/kr_16_2.yaml", "# tools/round_burr.yaml"})
    EXPECT_EQ(setup->config_text.find(other), std::string::npos) << other;
}

TEST(SetUpCell, SaysWhyAMeshIsRefused) {
  const simulation::CutSite cup{};
  const auto missing = SetUpCell(kDemoCell, MeshChoice{.file = "missing.obj", .cup = cup});
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().find("missing.obj"), std::string::npos) << missing.error();
}

TEST(MakeEngine, TheCpuEngineNeedsNoDevice) {
  CellSetup setup;
  setup.config = config::LoadCell(kDemoCell);
  const auto engine = MakeEngine(setup, {.engine = "cpu", .device = "no such device"});
  ASSERT_TRUE(engine) << engine.error();
  EXPECT_EQ((*engine)->name(), "cpu");
  EXPECT_EQ((*engine)->device().rfind("one thread, ", 0), 0u) << (*engine)->device();
}

TEST(MakeEngine, TheErrorNamesADeviceThatDoesNotExist) {
  CellSetup setup;
  setup.config = config::LoadCell(kDemoCell);
  const auto engine = MakeEngine(setup, {.engine = "vulkan", .device = "no such device"});
  ASSERT_FALSE(engine);
  EXPECT_NE(engine.error().find("\"no such device\""), std::string::npos) << engine.error();
}

}  // namespace
}  // namespace osteon::session
