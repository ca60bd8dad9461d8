#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/app/command.h"

// Runs `osteon identify` as a user does. What it finds: tests/studies/identify.

namespace osteon::app {
namespace {

TEST(IdentifyCommand, MeasuresTheSimulatedCellThenTheSameFromItsRecording) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(
      folder.path(), {"identify", "demo", "--simulated", "--do", "free", "--axes", "z", "--speeds", "50"});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_NE(run.out.find("dead time 3.000"), std::string::npos) << run.out;
  for (const char* file : {"identified.yaml", "identify.json", "identify.html", "free_z_50.mcap"})
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "identify" / file)) << file;
  const CommandResult again = RunCommand(
      folder.path(), {"identify", "demo", "--recording", "identify/free_z_50.mcap", "--out", "again"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  const auto without_comment = [&](const char* file) {
    const std::string text = io::test::ReadAll(folder.path() / file);
    return text.substr(text.find("identified:\n"));
  };
  EXPECT_EQ(without_comment("again/identified.yaml"), without_comment("identify/identified.yaml"))
      << "a recording says the same as the run";

  // the recording of one cell is none of another's, and takes the file of before away
  const CommandResult other = RunCommand(folder.path(), {"identify", "sawbone_block", "--recording",
                                                         "identify/free_z_50.mcap", "--out", "again"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_NE(other.out.find("another cell's recording: found the tool"), std::string::npos) << other.out;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "again/identified.yaml"));

  // the loop held still meanwhile, so that the recording replays
  EXPECT_EQ(RunCommand(folder.path(), {"replay", "identify/free_z_50.mcap"}).exit_code, 0);
}

TEST(IdentifyCommand, RefusesWhatItCannotUse) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "no.mcap") << "no recording";
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--recording", "no.mcap"}).exit_code, 2);
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--validate", "no.mcap"}).exit_code, 2);
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--axes", "w"}).exit_code, 2);
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--do", "validate"}).exit_code, 2);
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--wall-time"}).exit_code, 2);
}

}  // namespace
}  // namespace osteon::app
