#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <unistd.h>

#include <gtest/gtest.h>

#include "config/reading/load.h"

// Tests the scenes' files in config/scenes. The shipped scenes must have the expected values. Changed scenes
// must be refused, and the error must give the reason.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using simulation::SceneParams;

const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";

SceneParams Scene(const char* name) { return LoadScene(kConfig / "scenes" / (std::string(name) + ".yaml")); }

TEST(SceneFiles, MolarAndFemoralCanalEqualTheLibrarysDefaults) {
  const auto molar = std::get<simulation::MolarShape>(Scene("molar").shape);
  const simulation::MolarShape tooth;
  EXPECT_DOUBLE_EQ(molar.length_m, tooth.length_m);
  EXPECT_DOUBLE_EQ(molar.enamel_m, tooth.enamel_m);
  EXPECT_DOUBLE_EQ(molar.pulp_width, tooth.pulp_width);
  const auto femur = std::get<simulation::FemurShape>(Scene("femoral_canal").shape);
  const simulation::FemurShape bone;
  EXPECT_DOUBLE_EQ(femur.length_m, bone.length_m);
  EXPECT_DOUBLE_EQ(femur.flare_m, bone.flare_m);
  EXPECT_DOUBLE_EQ(femur.shaft_radius_m, bone.shaft_radius_m);
  EXPECT_DOUBLE_EQ(femur.top_radius_m, bone.top_radius_m);
  EXPECT_DOUBLE_EQ(femur.oval_ratio, bone.oval_ratio);
  EXPECT_DOUBLE_EQ(femur.medial_shift_m, bone.medial_shift_m);
  EXPECT_DOUBLE_EQ(femur.shaft_wall_m, bone.shaft_wall_m);
  EXPECT_DOUBLE_EQ(femur.top_wall_m, bone.top_wall_m);
  EXPECT_DOUBLE_EQ(femur.shaft_lining_m, bone.shaft_lining_m);
  EXPECT_DOUBLE_EQ(femur.top_marrow_radius_m, bone.top_marrow_radius_m);
}

TEST(SceneFiles, TheFemoralHeadEqualsTheLibrarysDefault) {
  const auto head = std::get<simulation::FemoralHeadShape>(Scene("femoral_head").shape);
  const simulation::FemoralHeadShape bone;
  EXPECT_DOUBLE_EQ(head.head_radius_m, bone.head_radius_m);
  EXPECT_DOUBLE_EQ(head.neck_radius_m, bone.neck_radius_m);
  EXPECT_DOUBLE_EQ(head.neck_length_m, bone.neck_length_m);
  EXPECT_NEAR(head.neck_tilt_rad, bone.neck_tilt_rad, 1e-3);
  EXPECT_DOUBLE_EQ(head.cartilage_m, bone.cartilage_m);
  EXPECT_DOUBLE_EQ(head.cortical_m, bone.cortical_m);
}

TEST(SceneFiles, EachMaterialHasOneIndexInLayersAndTissues) {
  const SceneParams sawbone = Scene("sawbone_block");
  const auto& block = std::get<simulation::BlockShape>(sawbone.shape);
  ASSERT_EQ(block.layers.size(), 2u);
  EXPECT_DOUBLE_EQ(block.layers[0].thickness_m, 0.003);
  EXPECT_EQ(std::set<std::string>(sawbone.material_names.begin(), sawbone.material_names.end()).size(),
            sawbone.material_names.size());
  EXPECT_NE(sawbone.material_names.at(block.layers[0].material), sawbone.material_names.at(block.core));
  EXPECT_EQ(sawbone.mesh_tissue.solid.core, block.core) << "the same name, the same index";

  const SceneParams molar = Scene("molar");
  ASSERT_EQ(molar.mesh_tissue.regions.size(), 1u);
  EXPECT_EQ(molar.material_names.at(molar.mesh_tissue.regions[0].tissue.core), "pulp");
  EXPECT_EQ(molar.material_names.at(molar.mesh_tissue.solid.core), "dentine");
  ASSERT_TRUE(Scene("acetabulum").mesh_tissue.lining);
}

class SceneRefusals : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(::testing::TempDir()) / ("osteon_scenes_" + std::to_string(::getpid()));
    fs::remove_all(root_);
    fs::copy(kConfig, root_, fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(root_); }

  /// The error of loading a scene or cell in which one text is replaced.
  std::string Refusal(const char* name, const std::string& from, const std::string& to) {
    const fs::path file = root_ / name;
    std::ostringstream before;
    before << std::ifstream(file, std::ios::binary).rdbuf();
    std::string text = before.str();
    const std::size_t at = text.find(from);
    if (at == std::string::npos) return "the test is out of date: no " + from;
    text.replace(at, from.size(), to);
    std::ofstream(file, std::ios::binary) << text;
    std::string what = "accepted";
    try {
      if (std::string(name).starts_with("cells"))
        static_cast<void>(LoadCell(file));
      else
        static_cast<void>(LoadScene(file));
    } catch (const ConfigError& error) {
      what = std::string(error.what()).substr(root_.string().size() + 1);
      EXPECT_GT(error.line(), 0) << what;
    }
    std::ofstream(file, std::ios::binary) << before.str();
    return what;
  }
  fs::path root_;
};

TEST_F(SceneRefusals, NameTheFileTheLineAndWhatIsAccepted) {
  struct Case {
    const char *file, *from, *to, *expected;
  };
  for (const Case& c : {
           Case{"scenes/molar.yaml", "kind: molar", "kind: premolar",
                "kind: found premolar, accepted acetabulum, molar, femoral_canal, block, femoral_head"},
           Case{"scenes/molar.yaml", "kind: molar", "mind: molar",
                "unknown key \"mind\"; did you mean \"kind\"?"},
           Case{"scenes/molar.yaml", "length_mm: 20.6", "length_mm: 200",
                "length_mm: found 200, accepted 10 … 40"},
           Case{"scenes/molar.yaml", "enamel_mm: 2 ", "enamel_mm: 3 ",
                "shape: molar: enamel thickness: found 3 mm, accepted 0 … 2.472 mm"},
           Case{"scenes/molar.yaml", "pulp_width_ratio: 1 ", "pulp_width_ratio: 5 ",
                "pulp_width_ratio: found 5, accepted 0.6 … 1.3"},
           Case{"scenes/molar.yaml", "radius_mm: 1.75", "radius_mm: 0",
                "radius_mm: found 0, accepted 0.5 … 100"},
           Case{"scenes/molar.yaml", "kind: path", "kind: line",
                "kind: found line, accepted cup, path, surface, everywhere"},
           Case{"scenes/molar.yaml", "kind: path", "kind: cup", "unknown key \"radius_mm\""},
           Case{"scenes/molar.yaml", "at_mm: [0, 0, 3]", "at_mm: [0, 3]",
                "at_mm: found a list of 2, accepted a list of 3 numbers -500 … 500"},
           Case{"scenes/femoral_canal.yaml", "flare_mm: 65", "flare_mm: 165",
                "shape: femur: flare: found 165 mm, accepted 5 … 110 mm"},
           Case{"scenes/femoral_canal.yaml", "shaft_lining_mm: 1.8", "shaft_lining_mm: 9",
                "shape: femur: shaft lining: found 9 mm"},
           Case{"scenes/sawbone_block.yaml", "thickness_mm: 5}", "thickness_mm: 50}",
                "shape: block: layers, in all: found 53 mm, accepted 0 … 30 mm"},
           Case{"scenes/sawbone_block.yaml", "core: ", "material: ", "unknown key \"material\""},
           Case{"scenes/thin_plate.yaml", "height_mm: 2 ", "height_mm: 0 ",
                "height_mm: found 0, accepted 0.1 … 500"},
           Case{"scenes/thin_plate.yaml", "lining: []", "lining: [1, 2]", "lining: found a list"},
           Case{"scenes/acetabulum.yaml", "reach_ratio: 1.25", "reach_ratio: 3",
                "reach_ratio: found 3, accepted 1 … 2"},
           Case{"cells/molar.yaml", "materials: tooth", "materials: bone",
                "materials: found bone.yaml with cartilage, cortical, cancellous, marrow; accepted one with "
                "enamel, which the scene needs"},
       }) {
    const std::string what = Refusal(c.file, c.from, c.to);
    EXPECT_TRUE(what.starts_with(std::string(c.file) + ":")) << what;
    EXPECT_NE(what.find(c.expected), std::string::npos) << what << "\n  expected: " << c.expected;
  }
}

TEST_F(SceneRefusals, NameTheMaterialBeyondTheMaximumOfEight) {
  std::string layers = "layers:";
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"})
    layers += std::string("\n    - {material: ") + name + ", thickness_mm: 0.1}";
  EXPECT_NE(Refusal("scenes/thin_plate.yaml", "layers: []", layers)
                .find("core: found cortical, accepted at most 8 materials a scene"),
            std::string::npos);
}

}  // namespace
}  // namespace osteon::config
