#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "tests/app/command.h"
#include "tests/config/cell_text.h"

// Runs `osteon capability` as a user does, on a small task.

namespace osteon::app {
namespace {

std::string ReadText(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// The task's volume is larger than the workspace. Poses outside are counted but not judged, and the verdict
// is not good. 243 poses: 3 heights with 9 places each, and 9 tilts at each place.
TEST(Capability, PosesOutsideTheWorkspacePreventAGoodVerdict) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"capability", "demo", "--no-search", "--nodes", "3",
                                                       "--radius-mm", "200", "--out", "cap"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "cap" / "capability.json");
  EXPECT_EQ(json.at("verdict").at("level"), "look");
  const nlohmann::json& task = json.at("task");
  EXPECT_EQ(task.at("poses").get<int>() + task.at("outside_workspace").get<int>(), 243);
  EXPECT_GT(task.at("outside_workspace").get<int>(), 100);
  EXPECT_NE(run.out.find("outside the cell's workspace and were not judged"), std::string::npos) << run.out;
}

TEST(Capability, WritesTheDocumentedKeysAndABaseThatTheCellAccepts) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"capability", "demo", "--out", "cap", "--json", "copy.json", "--nodes", "7",
                                 "--x-mm", "100,300", "--y-mm=-100,100", "--z-mm", "300,600"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* name :
       {"capability.svg", "capability.png", "capability_own_angle.svg", "capability_own_angle.png",
        "base.svg", "base.png", "capability.csv", "capability.html", "base.yaml"}) {
    ASSERT_TRUE(std::filesystem::is_regular_file(folder.path() / "cap" / name)) << name;
    EXPECT_GT(std::filesystem::file_size(folder.path() / "cap" / name), 100u) << name;
  }
  const nlohmann::json json = ReadJson(folder.path() / "cap" / "capability.json");
  EXPECT_EQ(json, ReadJson(folder.path() / "copy.json"));
  EXPECT_EQ(json.at("schema"), "osteon.capability/1");
  EXPECT_GT(json.at("axial_min_N").get<double>(), 200.0);
  EXPECT_GT(json.at("lateral_min_N").get<double>(), 100.0);
  EXPECT_LE(json.at("own_arm_angle").at("need_factor_min").get<double>(),
            json.at("best_arm_angles").at("need_factor_min").get<double>() * (1.0 + 1e-9));
  const nlohmann::json& base = json.at("best_base");
  EXPECT_TRUE(base.at("sufficient").get<bool>());
  EXPECT_GE(base.at("joint_room_min_deg").get<double>(), 4.0)
      << "the margin, but for the base's rounded turn";
  for (const char* key : {"axial_min_N", "lateral_min_N", "guaranteed_axial_N", "arm_angle_deg"})
    EXPECT_TRUE(base.at(key).is_number()) << key;
  EXPECT_NE(run.out.find("Verdict                        good"), std::string::npos) << run.out;
  EXPECT_EQ(json.at("verdict").at("level"), "good");

  // plan view and side view must show the best base on the same side of the site
  const std::string svg = ReadText(folder.path() / "cap" / "base.svg");
  std::vector<double> from_site;
  for (std::size_t site = svg.find(">site<"), best = svg.find(">best<"); best != std::string::npos;
       site = svg.find(">site<", site + 1), best = svg.find(">best<", best + 1)) {
    // x of the label whose text is found at position `end` of the SVG
    const auto left = [&svg](std::size_t end) {
      return std::stod(svg.substr(svg.rfind("<text x=", end) + 9));
    };
    from_site.push_back(left(best) - left(site));
  }
  ASSERT_EQ(from_site.size(), 2u);
  EXPECT_LT(from_site[0], 0.0);
  EXPECT_LT(from_site[1], 0.0);

  // a cell with this base in its file can be loaded
  std::string cell = config::CellText("demo");
  const std::string yaml = ReadText(folder.path() / "cap" / "base.yaml");
  // replaces the line of a key in the cell by the line that the key has in the text `in`
  const auto replace = [&](const std::string& key, const std::string& in) {
    const std::string value = in.substr(in.find(key), in.find('\n', in.find(key)) - in.find(key));
    cell.replace(cell.find(key), cell.find('\n', cell.find(key)) - cell.find(key), value);
  };
  replace("position_mm:", yaml);
  replace("rpy_deg:", yaml);
  replace("arm_angle_deg:", yaml);
  std::ofstream(folder.path() / "moved.yaml") << cell;
  const config::CellConfig moved = config::LoadCell(folder.path() / "moved.yaml");
  EXPECT_NEAR(1e3 * moved.X_WB.translation().x(), base.at("position_mm")[0].get<double>(), 1e-6);

  // a second study with this base must find the force that the first study promised
  const CommandResult again = RunCommand(
      folder.path(), {"capability", "moved.yaml", "--no-search", "--nodes", "5", "--out", "moved"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const nlohmann::json there = ReadJson(folder.path() / "moved" / "capability.json");
  EXPECT_EQ(there.at("own_arm_angle").at("unreachable"), 0);
  EXPECT_TRUE(there.at("best_base").is_null());
  EXPECT_NEAR(there.at("own_arm_angle").at("need_factor_min").get<double>(),
              base.at("need_factor_min").get<double>(), 0.01 * base.at("need_factor_min").get<double>());
}

TEST(Capability, NamesTheLimitingJointIfTheForceIsTooHigh) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"capability", "demo", "--out", "cap", "--lateral-N", "180", "--nodes", "3",
                                 "--x-mm", "100,200", "--y-mm", "0,0", "--z-mm", "0,300"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(ReadJson(folder.path() / "cap" / "capability.json").at("verdict").at("level"), "bad")
      << "the cell's own base does not hold it either";
  EXPECT_NE(run.out.find("are not to be had"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("A6 limits"), std::string::npos) << run.out;
  EXPECT_FALSE(
      ReadJson(folder.path() / "cap" / "capability.json").at("best_base").at("sufficient").get<bool>());
}

TEST(Capability, SaysThatNoBaseInTheRangesReachesTheTask) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"capability", "demo", "--out", "cap", "--nodes", "3", "--x-mm", "3000,3100",
                                 "--y-mm", "0,0", "--z-mm", "0,0"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("the task can be done from nowhere in the ranges"), std::string::npos) << run.out;
  EXPECT_TRUE(ReadJson(folder.path() / "cap" / "capability.json").at("best_base").is_null());
}

TEST(Capability, RefusesInvalidArguments) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  struct Case {
    std::vector<std::string> arguments;
    const char* said;
  };
  const std::vector<Case> cases{
      {{}, "cell"},
      {{"no_such_cell"}, "no file"},
      {{"kr_16_thin_plate"}, "found a KR 16-2, accepted an LBR"},
      {{"demo", "--axial-N", "0"}, "--axial-N: found 0, accepted 1"},
      {{"demo", "--x-mm", "300,100"}, "--x-mm: found 300,100, accepted FROM at most TO"},
      {{"demo", "--mount", "wall"}, "found wall, accepted cell, floor, ceiling"},
      {{"demo", "--out", "file"}, "found a file, accepted a folder"},
      {{"demo", "--recording", "file"}, "--recording"},
      {{"demo", "--node", "9"}, "did you mean --nodes?"}};
  for (const Case& each : cases) {
    std::vector<std::string> arguments{"capability"};
    arguments.insert(arguments.end(), each.arguments.begin(), each.arguments.end());
    const CommandResult run = RunCommand(folder.path(), arguments);
    EXPECT_EQ(run.exit_code, 2) << each.said << run.err;
    EXPECT_NE(run.err.find(each.said), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("osteon capability: "), std::string::npos) << run.err;
  }
}

}  // namespace
}  // namespace osteon::app
