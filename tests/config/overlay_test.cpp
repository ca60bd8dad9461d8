#include "config/reading/strict/overlay.h"

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "tests/io/temporary_folder.h"

// Tests the overlay, which replaces single values in a cell's files by dotted names ("limits.max_force_N").
// No other value changes, and an error names the file that gave the value.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";
const fs::path kCell = kConfig / "cells/demo.yaml";

class OverlayTest : public testing::Test {
 protected:
  /// Loads the demo cell with a file of overrides.
  CellConfig Load(const std::string& overrides) {
    io::test::WriteAll(File(), "shows: a test\n" + overrides);
    Overlay overlay(kCell);
    overlay.SetFromFile(File(), "overrides");
    CellConfig cell = LoadCell(kCell);
    overlay.Finish();
    return cell;
  }
  /// The error of loading with these overrides; "taken" if they are accepted.
  std::string Refusal(const std::string& overrides) {
    try {
      static_cast<void>(Load(overrides));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "taken";
  }
  /// Expects an error at this line of the overrides' file. The error must contain all the texts. Line 1 of
  /// the file is the key `shows`.
  void ExpectRefused(const std::string& overrides, int line, const std::vector<std::string>& texts) {
    const std::string refusal = Refusal(overrides);
    EXPECT_TRUE(refusal.starts_with(File().string() + ":" + std::to_string(line) + ": ")) << refusal;
    for (const std::string& text : texts) EXPECT_NE(refusal.find(text), std::string::npos) << refusal;
  }
  [[nodiscard]] fs::path File() const { return folder_.path() / "scenario.yaml"; }

  io::test::TemporaryFolder folder_;
};

TEST_F(OverlayTest, AnAssignmentReplacesOneOverrideOfTheFileAndLeavesTheOthers) {
  io::test::WriteAll(
      File(), "overrides:\n  operator.tremor_N: 3\n  tool.spindle_rpm: 300\n  limits.max_force_N: 150\n");
  Overlay overlay(kCell);
  overlay.SetFromFile(File(), "overrides");
  overlay.Set("operator.tremor_N=0.5", "--set");
  const CellConfig cell = LoadCell(kCell);
  overlay.Finish();
  EXPECT_DOUBLE_EQ(cell.simulated.hand.tremor_N, 0.5);
  EXPECT_DOUBLE_EQ(cell.servo.wrench.max_force_N, 150.0);
}

TEST_F(OverlayTest, ReplacesValuesInTheCellAndInTheFilesThatTheCellNames) {
  const CellConfig cell = Load(
      "overrides:\n"
      "  limits.max_force_N: 150\n"
      "  tool_diameter_mm: 52\n"
      "  scene.packing.spacing_mm: 3\n"
      "  tool.spindle_rpm: 300\n"
      "  injections: [{wire: arm, direction: both, from_s: 1, to_s: 2, silence: true}]\n"
      "  operator.incidents:\n"
      "    - {kind: startled_release, at_s: 1, jerk_N: 4, jerk_ms: 50, jerk_axis: [0, 0, 1], release_ms: "
      "30, away_ms: 200, return_ms: 300}\n");
  const CellConfig shipped = LoadCell(kCell);
  EXPECT_DOUBLE_EQ(cell.servo.wrench.max_force_N, 150.0);
  EXPECT_DOUBLE_EQ(shipped.servo.wrench.max_force_N, 200.0)
      << "once it is gone nothing is laid over anything";
  EXPECT_DOUBLE_EQ(cell.tool.tool.balls.front().radius_m, 0.026);
  EXPECT_DOUBLE_EQ(cell.scene.packing.lattice.finest_m, 0.003);
  EXPECT_DOUBLE_EQ(cell.scene.packing.min_radius_m, shipped.scene.packing.min_radius_m);
  EXPECT_NEAR(cell.tool.spindle_rad_per_s, 300.0 * 2.0 * 3.14159265358979 / 60.0, 1e-9);
  EXPECT_EQ(cell.injections.injections.size(), 1u);
  EXPECT_EQ(cell.simulated.hand.incidents.count, 1u);
  EXPECT_EQ(cell.servo.wrench.max_torque_Nm, shipped.servo.wrench.max_torque_Nm);
}

TEST_F(OverlayTest, ARelativePathStartsAtTheFolderOfTheOverridesFile) {
  fs::copy_file(kConfig / "tools/reamer.yaml", folder_.path() / "own.yaml");
  EXPECT_EQ(Load("overrides:\n  tool: own.yaml\n  tool.spindle_rpm: 100\n").tool.tool.name.empty(), false);
  ExpectRefused("overrides:\n  tool: nowhere.yaml\n", 3, {"tool", "nowhere.yaml", "existing file"});
}

TEST_F(OverlayTest, ErrorsNameFileAndLineOfTheOverride) {
  ExpectRefused("overrides:\n  limits.max_torque_Nm: 15\n  limits.max_force_N: 999\n", 4,
                {"max_force_N: found 999, accepted", "200"});
  ExpectRefused("overrides:\n  limits.max_forc_N: 150\n", 3, {"unknown key \"max_forc_N\"", "max_force_N"});
  ExpectRefused("overrides:\n  limit.max_force_N: 150\n", 3, {"unknown key \"limit\"", "limits"});
  ExpectRefused("overrides:\n  scene.packing.spacing_mm: 1e9\n", 3, {"spacing_mm", "accepted 0.2 … 20"});
  ExpectRefused("overrides:\n  injections: [{wire: arm, direction: both, from_s: 1, to_s: 2}]\n", 3,
                {"accepted"});
  ExpectRefused("overrides:\n  limits.max_force_N.peak: 150\n", 3, {"limits.max_force_N.peak", "demo.yaml"});
  ExpectRefused("overrides:\n  limits..max_force_N: 150\n", 3, {"limits..max_force_N", "dots"});
  ExpectRefused("overrides:\n  start.height_mm: 1\n  start.height_mm: 2\n", 4, {"start.height_mm", "again"});
  ExpectRefused("overrides: 5\n", 2, {"overrides", "no mapping"});
}

// A check that compares two keys reports one of them. The error must name the file that contains the reported
// key.
TEST_F(OverlayTest, AnErrorAtAKeyOfTheCellNamesTheCell) {
  const std::string refusal = Refusal("overrides:\n  start.height_mm: 499\n");
  EXPECT_TRUE(refusal.starts_with(File().string() + ":3: height_mm")) << refusal;
  const std::string other = Refusal("overrides:\n  limits.max_tool_speed_mm_per_s: 20\n");
  EXPECT_NE(other.find("demo.yaml"), std::string::npos) << other;
}

TEST_F(OverlayTest, ACommandLineAssignmentReplacesOneValue) {
  Overlay overlay(kCell);
  overlay.Set("limits.max_force_N=120", "--set");
  EXPECT_DOUBLE_EQ(LoadCell(kCell).servo.wrench.max_force_N, 120.0);
  overlay.Set("limits.max_force_N=110", "--set");
  EXPECT_DOUBLE_EQ(LoadCell(kCell).servo.wrench.max_force_N, 110.0) << "the last one counts";
  overlay.Set("limits.max_force_N=nothing", "--set");
  try {
    static_cast<void>(LoadCell(kCell));
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("--set limits.max_force_N=nothing")) << error.what();
  }
  for (const char* wrong : {"", "limits.max_force_N", "=5", "a.=5", "a=[1"})
    EXPECT_THROW(overlay.Set(wrong, "--set"), ConfigError) << wrong;
}

TEST_F(OverlayTest, ASecondOverlayInOneThreadIsRefused) {
  const Overlay overlay(kCell);
  EXPECT_THROW(const Overlay second(kCell), std::logic_error);
}

}  // namespace
}  // namespace osteon::config
