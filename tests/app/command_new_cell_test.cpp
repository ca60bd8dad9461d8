#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "config/reading/config_file_tracker.h"
#include "config/reading/load.h"
#include "tests/app/command.h"

// Runs `osteon new-cell` as a user does, and loads the cells that it writes.

namespace osteon::app {
namespace {

namespace fs = std::filesystem;

class NewCellTest : public testing::Test {
 protected:
  NewCellTest() { config::SetShippedFolder(fs::path(OSTEON_SOURCE_DIR) / "config"); }
  TemporaryFolder folder_;
};

TEST_F(NewCellTest, WritesAShortCellThatLoads) {
  const CommandResult made = RunCommand(folder_.path(), {"new-cell", "lab/my_cell"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const fs::path file = folder_.path() / "lab/my_cell.yaml";
  const std::string text = io::test::ReadAll(file);
  EXPECT_LE(std::ranges::count(text, '\n'), 25);
  const config::CellConfig mine = config::LoadCell(file),
                           demo = config::LoadCell(config::ShippedFolder() / "cells/demo.yaml");
  EXPECT_EQ(mine.servo.wrench.max_force_N, demo.servo.wrench.max_force_N);
  EXPECT_EQ(mine.start.q, demo.start.q);
}

TEST_F(NewCellTest, CopiesACellThatExtendsAnother) {
  const CommandResult made = RunCommand(folder_.path(), {"new-cell", "tooth.yaml", "--from", "molar"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(config::LoadCell(folder_.path() / "tooth.yaml").scene.name, "molar");
}

TEST_F(NewCellTest, ReportsTheNewFileAsJson) {
  const CommandResult made =
      RunCommand(folder_.path(), {"new-cell", "lab/tooth", "--from", "molar", "--json", "made.json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const nlohmann::json json = ReadJson(folder_.path() / "made.json");
  EXPECT_EQ(json.at("schema"), "osteon.new_cell/1");
  EXPECT_EQ(json.at("file"), "lab/tooth.yaml");
  EXPECT_EQ(json.at("from"), "molar");
  EXPECT_EQ(json.at("copied"), true);
}

TEST_F(NewCellTest, DoesNotOverwriteAFile) {
  io::test::WriteAll(folder_.path() / "mine.yaml", "x");
  const CommandResult made = RunCommand(folder_.path(), {"new-cell", "mine"});
  EXPECT_EQ(made.exit_code, 2);
  EXPECT_NE(made.err.find("mine.yaml, accepted a name that no file has yet"), std::string::npos) << made.err;
  EXPECT_EQ(io::test::ReadAll(folder_.path() / "mine.yaml"), "x");
  const CommandResult unknown = RunCommand(folder_.path(), {"new-cell", "other", "--from", "nosuch"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("--from nosuch"), std::string::npos) << unknown.err;
}

// A name without ending, as in `--cell mine`, means config/cells/mine.yaml. That file does not exist, so the
// error suggests the user's own file.
TEST_F(NewCellTest, ABareNameMeansAShippedCellAndTheOwnFileIsSuggested) {
  ASSERT_EQ(RunCommand(folder_.path(), {"new-cell", "mine"}).exit_code, 0);
  const CommandResult run = RunCommand(folder_.path(), {"demo", "--cell", "mine", "--virtual-time"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("did you mean mine.yaml?"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace osteon::app
