#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "studies/failures/failures.h"
#include "studies/faults/fault_table.h"
#include "tests/app/command.h"

// Runs `osteon failures` as a user does. tests/studies/failures/failures_test.cpp checks the scenarios'
// findings.

namespace osteon::app {
namespace {

std::string ReadAll(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(FailuresCommand, WritesTableJsonPageAndPictures) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"failures", "22", "19", "--quick", "--engine", "reference", "--out",
                                 "report", "--json", "f.json", "--markdown", "page.md"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_NE(run.out.find("breakthrough"), std::string::npos);
  EXPECT_NE(run.out.find("2 of 2 kept"), std::string::npos) << run.out;

  const nlohmann::json json = ReadJson(folder.path() / "f.json");
  EXPECT_EQ(json["schema"], "osteon.failures/1");
  EXPECT_EQ(json["engine"], "reference");
  ASSERT_EQ(json["scenarios"].size(), 2u);
  EXPECT_EQ(json["scenarios"][0]["id"], 19);  // scenarios are sorted by number, not as on the command line
  EXPECT_EQ(json["scenarios"][1]["id"], 22);
  for (const auto& scenario : json["scenarios"]) {
    for (const char* key :
         {"id", "name", "metric", "unit", "bound", "baseline", "ours", "baseline_fails", "ours_passes"})
      EXPECT_TRUE(scenario.contains(key)) << key;
    EXPECT_TRUE(scenario["baseline_fails"].get<bool>());
    EXPECT_GT(scenario["baseline"].get<double>(), scenario["bound"].get<double>());
    EXPECT_LE(scenario["ours"].get<double>(), scenario["bound"].get<double>());
  }

  const std::string page = ReadAll(folder.path() / "report" / "failures.html");
  EXPECT_NE(page.find("22 frame rate"), std::string::npos);
  EXPECT_NE(page.find("</html>"), std::string::npos);
  for (const char* picture :
       {"19_breakthrough.svg", "19_breakthrough_scene.svg", "22_frame_rate.svg", "22_frame_rate_scene.svg"}) {
    const std::string svg = ReadAll(folder.path() / "report" / picture);
    EXPECT_TRUE(svg.starts_with("<svg xmlns=")) << picture;
    EXPECT_NE(svg.find("ours"), std::string::npos) << picture;
  }

  const std::string markdown = ReadAll(folder.path() / "page.md");
  EXPECT_NE(markdown.find("2 of 2 kept"), std::string::npos) << markdown;
  EXPECT_NE(markdown.find("| 22 | frame rate |"), std::string::npos) << markdown;
  EXPECT_NE(markdown.find("## 19 breakthrough"), std::string::npos) << markdown;
  EXPECT_NE(markdown.find("](report/19_breakthrough.svg)"), std::string::npos) << markdown;
  EXPECT_NE(markdown.find("](report/19_breakthrough_scene.svg)"), std::string::npos) << markdown;
}

TEST(FailuresCommand, RefusesInvalidArguments) {
  const TemporaryFolder folder;
  const auto expect_refused = [&](std::vector<std::string> arguments, const std::string& text) {
    arguments.insert(arguments.begin(), "failures");
    const CommandResult run = RunCommand(folder.path(), arguments);
    EXPECT_EQ(run.exit_code, 2) << run.out << run.err;
    EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
    EXPECT_EQ(run.out, "");
  };
  expect_refused({"98"}, "found 98, accepted 1,");
  expect_refused({"one"}, "found one, accepted 1");
  expect_refused({"1", "--engine", "abacus"}, "found abacus, accepted auto, vulkan, cpu, reference");
  expect_refused({"1", "--device", "no such device"}, "no such device");
  expect_refused({"1", "--json", "nowhere/f.json"}, "no folder nowhere");
  expect_refused({"1", "--out", "report", "--markdown", "nowhere/page.md"}, "no folder nowhere");
  expect_refused({"1", "--markdown", "page.md"}, "--out");
  std::ofstream(folder.path() / "taken") << "a file";
  expect_refused({"1", "--out", "taken"}, "found a file, accepted a folder");
}

TEST(FailuresCommand, FailsIfItsJsonCannotBeWritten) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "f.json");
  const CommandResult run =
      RunCommand(folder.path(), {"failures", "19", "--quick", "--engine", "reference", "--json", "f.json"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_NE(run.err.find("f.json"), std::string::npos) << run.err;
}

TEST(FailuresJson, OneFailedScenarioFailsTheWholeReport) {
  studies::FailureRun good{.result = {.id = 1, .name = "a", .baseline_fails = true, .ours_passes = true}};
  studies::FailureRun kept_by_both{
      .result = {.id = 2, .name = "b", .baseline_fails = false, .ours_passes = true}};
  studies::FailureRun broken{.result = {.id = 3, .name = "c"}, .error = "no memory"};
  EXPECT_TRUE(good.passed());
  EXPECT_FALSE(kept_by_both.passed());  // a scenario in which no baseline fails proves nothing
  EXPECT_FALSE(broken.passed());
  EXPECT_TRUE(
      nlohmann::json::parse(studies::FailuresJson({good}, "vulkan", "d", false))["passed"].get<bool>());
  const auto json = nlohmann::json::parse(studies::FailuresJson({good, broken}, "vulkan", "d", true));
  EXPECT_FALSE(json["passed"].get<bool>());
  EXPECT_EQ(json["size"], "quick");
  EXPECT_EQ(json["scenarios"][1]["error"], "no memory");
}

TEST(FailuresCommand, RunsEveryFaultInEveryState) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"failures", "--faults", "--json", "f.json"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "f.json");
  EXPECT_EQ(json.at("schema"), "osteon.failures/1");
  EXPECT_TRUE(json.at("passed").get<bool>());
  EXPECT_TRUE(json.at("scenarios").empty());
  EXPECT_GE(json.at("faults").size(), 40u * 12u);
  EXPECT_NE(run.out.find(" as stated, "), std::string::npos) << run.out;
  EXPECT_EQ(RunCommand(folder.path(), {"failures", "--faults", "9"}).exit_code, 2);
}

// A fault to which the cell does not react as expected is marked in table, list and JSON.
TEST(FaultTable, MarksAReactionThatDiffersFromTheExpected) {
  studies::FaultVerdict good, bad;
  good.fault = bad.fault = "drive's fault";
  good.state = safety::CellState::kHaptic;
  bad.state = safety::CellState::kCutting;
  bad.expected.reaction = studies::Reaction::kStops;
  bad.wrong = "it moved on";
  const std::vector<studies::FaultVerdict> verdicts{good, bad};
  const std::string text = studies::FaultTableText(verdicts);
  EXPECT_NE(text.find("   1!"), std::string::npos) << text;
  EXPECT_NE(text.find("! drive's fault, cutting: expected it stops: it moved on"), std::string::npos) << text;
  EXPECT_NE(text.find("1 of 2 as stated, 1 faults"), std::string::npos) << text;
  const nlohmann::json json = nlohmann::json::parse(studies::FaultTableJson(verdicts));
  EXPECT_FALSE(json.at("passed").get<bool>());
  EXPECT_EQ(json.at("faults")[1].at("wrong"), "it moved on");
}

}  // namespace
}  // namespace osteon::app
