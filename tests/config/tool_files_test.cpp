#include <algorithm>
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "gpu/shaders/layout.h"
#include "simulation/engine/reference_engine.h"
#include "tests/config/cell_text.h"
#include "tests/io/temporary_folder.h"
#include "tests/temporary_path.h"

// Tests the tools' files in config/tools: every size in a set can be built, and wrong sizes are refused.

namespace osteon::config {
namespace {

const std::string kTools = std::string(OSTEON_SOURCE_DIR) + "/config/tools/";
const std::string kDemo = std::string(OSTEON_SOURCE_DIR) + "/config/cells/demo.yaml";

TEST(ReamerSet, EveryDiameterFrom36To68MillimetresBuildsAndMassRises) {
  double mass = 0.0, center = 1.0;
  for (int d = 36; d <= 68; ++d) {
    const ToolConfig config = LoadTool(kTools + "reamer.yaml", d * 1e-3);
    const simulation::Tool& tool = config.tool;
    EXPECT_DOUBLE_EQ(tool.balls.front().radius_m, 0.5e-3 * d);
    EXPECT_DOUBLE_EQ(simulation::CuttingReach(tool), 0.5e-3 * d);
    EXPECT_EQ(tool.name, "hemispherical reamer " + std::to_string(d) + " mm");
    EXPECT_GT(tool.mass_kg, mass);
    // the base plane of every head is 155 mm ahead of the flange
    EXPECT_NEAR(config.X_FT.translation().z(), 0.155 + 0.5e-3 * d, 1e-15);
    EXPECT_NE(tool.center_of_mass_m.z, center);
    EXPECT_LE(tool.balls.size(), gpu::kMaxToolBalls);
    mass = tool.mass_kg;
    center = tool.center_of_mass_m.z;
  }
}

TEST(ReamerSet, KeepsThe50MillimetreReamersBallsBitForBit) {
  const simulation::Tool made = LoadTool(kTools + "reamer.yaml", 0.050).tool;
  const simulation::Tool known = simulation::MakeReamer(0.025, 0.008, 0.120, 0.9, Vector3::Zero());
  ASSERT_EQ(made.balls.size(), known.balls.size());
  for (std::size_t i = 0; i < made.balls.size(); ++i) {
    EXPECT_EQ(made.balls[i].center_m.z, known.balls[i].center_m.z);
    EXPECT_EQ(made.balls[i].radius_m, known.balls[i].radius_m);
    EXPECT_EQ(made.balls[i].cutting, known.balls[i].cutting);
  }
}

TEST(ToolSets, DefaultSizeExistsAndOtherSizesAreRefusedWithTheList) {
  struct Case {
    const char *file, *accepted;
  };
  for (const Case& c : {Case{"reamer.yaml", "36 … 68 in steps of 1"},
                        Case{"round_burr.yaml", "1, 1.4, 1.8, 2.3, 2.9, 3.5, 4, 5, 6, 7, 8"},
                        Case{"twist_drill.yaml", "2, 2.5, 3, 3.2, 3.5, 4, 4.5, 5, 6, 7, 8, 9, 10"},
                        Case{"broach.yaml", "none: this tool comes in one size"}}) {
    EXPECT_NO_THROW(static_cast<void>(LoadTool(kTools + c.file)));
    try {
      static_cast<void>(LoadTool(kTools + c.file, 0.0333));
      ADD_FAILURE() << c.file;
    } catch (const ToolSizeError& error) {
      EXPECT_NE(std::string(error.what()).find(c.accepted), std::string::npos) << error.what();
    }
  }
}

// A neck of 7.7 mm does not fit a burr of 1.4 mm. The error must name the line of this row, not the line of
// the list.
TEST(ToolSets, ARowThatCannotBeBuiltIsRefusedAtItsLine) {
  std::string text = io::test::ReadAll(kTools + "round_burr.yaml");
  const std::string row = "  - {diameter_mm: 1.4, neck_mm: 0.77}";
  const std::size_t at = text.find(row);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, row.size(), "  - {diameter_mm: 1.4, neck_mm: 7.7}");
  const io::test::TemporaryFolder folder;
  const auto file = folder.path() / "burr.yaml";
  io::test::WriteAll(file, text);
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  try {
    static_cast<void>(LoadTool(file, 0.0014));
    ADD_FAILURE();
  } catch (const ConfigError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(file.string() + ":" + std::to_string(line) + ": "))
        << error.what();
  }
  EXPECT_NO_THROW(static_cast<void>(LoadTool(file, 0.0018))) << "the other rows are as they were";
}

// Every size of the shipped burrs, drills and canal reamers must have no more balls than the Vulkan engine
// accepts. Sizes that a set does not contain are skipped.
TEST(ToolSets, BurrsAndDrillsOfEverySizeFitTheEngine) {
  for (const char* file :
       {"round_burr", "pear_burr", "cylinder_burr", "taper_burr", "twist_drill", "canal_reamer"})
    for (int tenths = 10; tenths <= 180; ++tenths) {
      ToolConfig config;
      try {
        config = LoadTool(kTools + file + ".yaml", tenths * 1e-4);
      } catch (const ToolSizeError&) {
        continue;
      }
      EXPECT_LE(config.tool.balls.size(), gpu::kMaxToolBalls) << config.tool.name;
      // the balls of a head may lie below its outline by the accepted gap, which is at most 12 % of the
      // diameter, at flutes
      EXPECT_NEAR(simulation::CuttingReach(config.tool), tenths * 0.5e-4, 0.12 * tenths * 1e-4);
      EXPECT_NEAR(config.X_FT.translation().z(), 0.175, 0.07) << config.tool.name;
    }
}

TEST(DemoCell, CanUseABurrADrillOrABroachInPlaceOfItsReamer) {
  for (const ToolChoice& choice :
       {ToolChoice{kTools + "round_burr.yaml", 0.006}, ToolChoice{kTools + "reamer.yaml", 0.054},
        ToolChoice{kTools + "twist_drill.yaml"}, ToolChoice{kTools + "broach.yaml"}}) {
    const CellConfig cell = LoadCell(kDemo, choice);
    EXPECT_NE(cell.tool.tool.name, "hemispherical reamer 50 mm");
    EXPECT_EQ(cell.tool.tool.name, LoadTool(choice.file, choice.diameter_m).tool.name);
    EXPECT_EQ(simulation::CuttingHead(cell.tool.tool), cell.tool.tool.balls.data())
        << "the first ball is the head";
    const kinematics::LbrArm arm(cell.robot.lbr()->params);
    const Pose X_WT = cell.X_WB * arm.FlangePose(cell.start.q) * cell.tool.X_FT;
    EXPECT_LT((X_WT.matrix() - cell.start.X_WT.matrix()).cwiseAbs().maxCoeff(), 1e-12);
    simulation::ReferenceEngine engine({}, cell.tool.tool, cell.X_WG, cell.cutting);
    EXPECT_EQ(engine.Step({.X_WT = X_WT}).status, simulation::EngineStatus::kOk);
  }
  EXPECT_THROW(static_cast<void>(LoadCell(kDemo, ToolChoice{kTools + "reamer.yaml", 0.080})), ToolSizeError);
}

TEST(DemoCell, LoadsWithoutAToolDiameter) {
  std::string text = CellText("demo");
  const std::size_t at = text.find("tool_diameter_mm");
  ASSERT_NE(at, std::string::npos);
  text.erase(at, text.find('\n', at) + 1 - at);
  const std::string file = TemporaryPath("osteon_cell_without_diameter.yaml").string();
  std::ofstream(file) << text;
  EXPECT_EQ(LoadCell(file).tool.tool.name, "hemispherical reamer 50 mm");
}

}  // namespace
}  // namespace osteon::config
