#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/app/command.h"

// Runs `osteon identify` as a user does. The tests in tests/studies/identify check the identified values.

namespace osteon::app {
namespace {

TEST(IdentifyCommand, FindsTheSameInARunAndInItsRecording) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"identify", "demo", "--simulated", "--do",
                                                       "free,tremor", "--axes", "z", "--speeds", "50"});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_NE(run.out.find("dead time 3.000"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("the simulated hand has no tremor"), std::string::npos)
      << "the others give their file all the same: " << run.out;
  for (const char* file : {"identified.yaml", "identify.json", "identify.html", "free_z_50.mcap"})
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "identify" / file)) << file;
  const CommandResult again = RunCommand(
      folder.path(), {"identify", "demo", "--recording", "identify/free_z_50.mcap", "--out", "again"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("again/identified.yaml: osteon tune CELL --identified again/identified.yaml"),
            std::string::npos)
      << "a command to copy: " << again.out;
  const auto without_comment = [&](const char* file) {
    const std::string text = io::test::ReadAll(folder.path() / file);
    return text.substr(text.find("identified:\n"));
  };
  EXPECT_EQ(without_comment("again/identified.yaml"), without_comment("identify/identified.yaml"))
      << "a recording says the same as the run";

  // a recording of another cell is refused, and the earlier result is removed
  const CommandResult other = RunCommand(folder.path(), {"identify", "sawbone_block", "--recording",
                                                         "identify/free_z_50.mcap", "--out", "again"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_NE(other.out.find("another cell's recording: found the tool"), std::string::npos) << other.out;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "again/identified.yaml"));

  // `osteon capability` uses the measured lag along z, and assumes the lags along the other axes
  const CommandResult force =
      RunCommand(folder.path(), {"capability", "demo", "--no-search", "--nodes", "3", "--out", "cap",
                                 "--identified", "identify/identified.yaml"});
  ASSERT_EQ(force.exit_code, 0) << force.err;
  const nlohmann::json axes = ReadJson(folder.path() / "cap/capability.json").at("rendering").at("axes");
  EXPECT_EQ(axes.at(0).at("lag_ms").at("source"), "assumed");
  EXPECT_EQ(axes.at(2).at("lag_ms").at("source"), "measured");
  EXPECT_NEAR(axes.at(2).at("lag_ms").at("value"), 24.22, 0.02);
  EXPECT_NE(force.out.find("Rendered along z"), std::string::npos) << force.out;
  EXPECT_NE(io::test::ReadAll(folder.path() / "cap/capability.html").find("Rendered along z"),
            std::string::npos);

  // refused are: a recording that is given twice, validation with the data of the fit, a torn recording
  const std::string file = "identify/free_z_50.mcap";
  const auto expect_refused = [&](std::vector<std::string> words, const std::string& why) {
    words.insert(words.begin(), {"identify", "demo", "--out", "none", "--recording", file});
    const CommandResult wrong = RunCommand(folder.path(), words);
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_NE(wrong.err.find(why), std::string::npos) << wrong.err;
  };
  expect_refused({"--recording", file}, "again, accepted each once");
  expect_refused({"--validate", file}, "accepted each once, and other data to validate with");
  expect_refused({"--simulated"}, "--simulated with --recording, accepted one of them");
  const std::string whole = io::test::ReadAll(folder.path() / file);
  io::test::WriteAll(folder.path() / "torn.mcap", whole.substr(0, whole.size() / 2));
  expect_refused({"--recording", "torn.mcap"}, "torn.mcap: it ends early, at byte ");

  // the recording that the measurement made can be replayed
  EXPECT_EQ(RunCommand(folder.path(), {"replay", "identify/free_z_50.mcap"}).exit_code, 0);
}

TEST(IdentifyCommand, FindsTheSameForEachJointInARunAndInItsRecording) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"identify", "demo", "--simulated", "--do", "joints", "--joints", "7,2"});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_NE(run.out.find("free run, joint A2 at 8.6 deg/s"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("lag 24.221"), std::string::npos) << run.out;
  const CommandResult again =
      RunCommand(folder.path(), {"identify", "demo", "--recording", "identify/joint_A2_8.6.mcap",
                                 "--recording", "identify/joint_A7_8.6.mcap", "--out", "again"});
  ASSERT_EQ(again.exit_code, 0) << again.err << again.out;
  const nlohmann::json joints = ReadJson(folder.path() / "identify/identify.json").at("joints");
  ASSERT_EQ(joints.size(), 2u);
  EXPECT_EQ(joints.at(0).at("joint"), "A2");
  EXPECT_EQ(ReadJson(folder.path() / "again/identify.json").at("joints"), joints);
  EXPECT_EQ(RunCommand(folder.path(), {"replay", "identify/joint_A2_8.6.mcap"}).exit_code, 0);
  const CommandResult compared =
      RunCommand(folder.path(), {"diff", "identify/joint_A2_8.6.mcap", "identify/joint_A7_8.6.mcap", "--out",
                                 "compared", "--json", "diff.json"});
  EXPECT_EQ(compared.exit_code, 1) << "before, no figure differed";
  EXPECT_NE(compared.out.find("the excitation differs: free run, joint A2 at 8.6 deg/s"), std::string::npos)
      << compared.out;
  EXPECT_EQ(ReadJson(folder.path() / "diff.json").at("responses").size(), 27u);

  const auto expect_refused = [&](std::vector<std::string> words, const std::string& why) {
    words.insert(words.begin(), "identify");
    const CommandResult wrong = RunCommand(folder.path(), words);
    EXPECT_EQ(wrong.exit_code, 2) << wrong.out;
    EXPECT_NE(wrong.err.find(why), std::string::npos) << wrong.err;
  };
  expect_refused({"thin_plate_impedance", "--simulated", "--do", "joints"},
                 "found law: impedance, accepted law: admittance");
  expect_refused({"kr_16_thin_plate", "--simulated", "--do", "joints", "--joints", "7"},
                 "found 7, accepted 1 … 6");
  expect_refused({"demo", "--simulated", "--do", "free", "--joints", "1"},
                 "without --do joints, accepted both");
}

// The `osteon` commands in one section of a page. Each is split into the words after `osteon`.
std::vector<std::vector<std::string>> CommandsOf(const std::string& page, const std::string& heading) {
  const std::string text = io::test::ReadAll(std::filesystem::path(OSTEON_SOURCE_DIR) / page);
  std::vector<std::vector<std::string>> commands;
  std::istringstream section(text.substr(std::min(text.size(), text.find(heading))));
  std::string line;
  std::getline(section, line);
  while (std::getline(section, line) && !line.starts_with("## ")) {
    if (!line.starts_with("    osteon ")) continue;
    std::istringstream words(line);
    std::string word;
    words >> word;
    commands.emplace_back();
    while (words >> word) commands.back().push_back(word);
  }
  return commands;
}

// The first command of the example on the page makes recordings. The second command must need nothing but
// these.
TEST(IdentifyCommand, TheWorkedExampleOfTheTuningPageRunsAsWritten) {
  const TemporaryFolder folder;
  const auto commands = CommandsOf("docs/tuning.md", "## A worked example");
  ASSERT_GE(commands.size(), 3u);
  EXPECT_EQ(commands[1][2], "--recording");
  for (const std::vector<std::string>& command : commands) {
    const CommandResult run = RunCommand(folder.path(), command);
    std::string written;
    for (const std::string& word : command) written += " " + word;
    ASSERT_EQ(run.exit_code, 0) << "osteon" << written << "\n" << run.err << run.out;
  }
  const nlohmann::json tuned = ReadJson(folder.path() / "tune_measured/tune.json");
  EXPECT_EQ(tuned.at("identified"), true);
  EXPECT_NEAR(tuned.at("arm").at("bandwidth_hz"), 15.0, 0.05);
  EXPECT_FALSE(tuned.at("margins").empty());
  EXPECT_GT(ReadJson(folder.path() / "measured/identify.json").at("estimation").at("data_s"), 60.0);
}

TEST(IdentifyCommand, RefusesUnusableRecordingsAndOptions) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "no.mcap") << "no recording";
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--recording", "no.mcap"}).exit_code, 2);
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--validate", "no.mcap"}).exit_code, 2);
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--axes", "w"}).exit_code, 2);
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--do", "validate"}).exit_code, 2);
  EXPECT_EQ(RunCommand(folder.path(), {"identify", "demo", "--wall-time"}).exit_code, 2);
  const CommandResult tremor =
      RunCommand(folder.path(), {"identify", "demo", "--simulated", "--do", "tremor"});
  EXPECT_EQ(tremor.exit_code, 1);
  EXPECT_NE(tremor.out.find("the simulated hand has no tremor; found operator: tremor_N: 0"),
            std::string::npos)
      << tremor.out;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "identify/identified.yaml"));
}

}  // namespace
}  // namespace osteon::app
