#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "config/reading/load.h"

// Tests optional keys in a cell's section cutting: the splitting of bone balls, the choice of the tool balls
// that cut, and the force of the cutting edges.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SplitKeys : public testing::Test {
 protected:
  void SetUp() override {
    fs::copy(fs::path(OSTEON_SOURCE_DIR) / "config", folder_, fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(folder_); }
  // Loads a copy of a shipped cell with these lines added to its section cutting.
  CellConfig LoadWith(const std::string& added_lines, const std::string& name = "demo") const {
    const fs::path cell = folder_ / "cells" / (name + ".yaml");
    std::stringstream text;
    text << std::ifstream(cell).rdbuf();
    std::string edited = text.str();
    const std::string before = name == "demo" ? "  engaged_layer_mm: 0.5" : "  max_slide_um: 400";
    const std::size_t at = edited.find(before);
    if (at == std::string::npos) throw std::logic_error("the cell has changed");
    edited.insert(at, added_lines);
    std::ofstream(cell) << edited;
    return LoadCell(cell);
  }
  const fs::path folder_ =
      fs::temp_directory_path() / ("osteon_split_keys_" + std::to_string(::getpid()) + "_" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(SplitKeys, SplittingIsOffByDefault) { EXPECT_FALSE(LoadWith("").cutting.split.on); }

TEST_F(SplitKeys, ReachTheEnginesParameters) {
  const simulation::SplitParams split =
      LoadWith("  split: {min_radius_mm: 0.3, child_count: 32, pool_count: 500}\n").cutting.split;
  EXPECT_TRUE(split.on);
  EXPECT_DOUBLE_EQ(split.min_radius_m, 0.3e-3);
  EXPECT_EQ(split.children, 32);
  EXPECT_EQ(split.pool_blocks, 500u);
}

TEST_F(SplitKeys, AllBallsCutByDefault) {
  EXPECT_EQ(LoadWith("").cutting.cutters, simulation::Cutters::kAll);
  EXPECT_EQ(LoadWith("  cutters: all\n").cutting.cutters, simulation::Cutters::kAll);
}

TEST_F(SplitKeys, CuttersMayBeTheContactSphereAlone) {
  EXPECT_EQ(LoadWith("  cutters: contact_sphere\n").cutting.cutters, simulation::Cutters::kContactSphere);
}

TEST_F(SplitKeys, EdgeForceNeedsAToolWithEdges) {
  EXPECT_FALSE(LoadWith("", "thin_plate").cutting.edge_force);
  const CellConfig drill = LoadWith("  edge_force: true\n", "thin_plate");
  EXPECT_TRUE(drill.cutting.edge_force);
  EXPECT_EQ(simulation::CuttingEdges(drill.tool.tool), 2) << "a twist drill's lips";
  EXPECT_TRUE(LoadWith("  edge_force: true\n", "sawbone_block").cutting.edge_force);
  try {
    static_cast<void>(LoadWith("  edge_force: true\n"));
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("edge_force: found true with reamer.yaml, accepted with a tool that "
                                        "has edge_count"));
  }
}

TEST_F(SplitKeys, RefusalOutOfRangeNamesWhatIsAccepted) {
  try {
    static_cast<void>(LoadWith("  split: {min_radius_mm: 0.3, child_count: 65, pool_count: 500}\n"));
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("child_count: found 65, accepted a whole number 8 … 64"));
  }
}

}  // namespace
}  // namespace osteon::config
