#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "config/reading/load_identified.h"
#include "tests/app/command.h"
#include "tests/config/cell_text.h"
#include "tests/studies/tune/identified_sample.h"

// Runs `osteon tune` as a user does, at a small size.

namespace osteon::app {
namespace {

// A tune with three damping values, the smallest number that is accepted.
const std::vector<std::string> kSmall{"tune", "demo", "--out", "t", "--nodes", "3", "--json", "copy.json"};

TEST(Tune, WritesTheDocumentedKeysAndGainsThatTheCellAccepts) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), kSmall);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::filesystem::path out = folder.path() / "t";
  for (const char* name : {"tune.svg", "tune.png", "tune_width.svg", "tune_width.png", "tune_trade.svg",
                           "tune_trade.png", "tune.csv", "tune.html", "gains.yaml"}) {
    ASSERT_TRUE(std::filesystem::is_regular_file(out / name)) << name;
    EXPECT_GT(std::filesystem::file_size(out / name), 100u) << name;
  }
  // the legend must have each name once, even if some walls are only known as lower bounds
  const std::string svg = io::test::ReadAll(out / "tune_width.svg");
  for (const std::string name : {">simulated<", ">with commands lost and late<", ">at least so much:"}) {
    const std::size_t at = svg.find(name);
    ASSERT_NE(at, std::string::npos) << name;
    EXPECT_EQ(svg.find(name, at + 1), std::string::npos) << name << " twice";
  }
  const nlohmann::json json = ReadJson(out / "tune.json");
  EXPECT_EQ(json, ReadJson(folder.path() / "copy.json"));
  EXPECT_EQ(json.at("schema"), "osteon.tune/1");
  EXPECT_DOUBLE_EQ(json.at("margin").get<double>(), 1.1);
  ASSERT_EQ(json.at("boundary").size(), 4u) << "three dampings and the recommended one";
  int compared = 0;
  for (const nlohmann::json& point : json.at("boundary")) {
    const double predicted = point.at("stiffness_predicted"), simulated = point.at("stiffness_simulated");
    EXPECT_GT(point.at("damping").get<double>(), 0.0);
    if (predicted == 0.0) {
      EXPECT_EQ(simulated, 0.0);
    } else {
      EXPECT_NEAR(simulated, predicted, 0.02 * predicted);
      ++compared;
    }
  }
  EXPECT_GE(compared, 2);
  const nlohmann::json& recommended = json.at("recommended");
  EXPECT_GE(recommended.at("margin").get<double>(), 1.1);
  EXPECT_TRUE(json.at("check").at("grew").empty());
  EXPECT_TRUE(json.at("bar").at("met").is_boolean());

  const config::CellConfig cell = config::LoadCell(
      std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml", {}, out / "gains.yaml");
  EXPECT_EQ(cell.servo.admittance.mass_kg.z(), recommended.at("mass_kg").get<double>());
  EXPECT_EQ(cell.servo.admittance.damping_Ns_per_m.x(), recommended.at("damping_Ns_per_m").get<double>());

  // the second call computes nothing anew and gives the same result
  const CommandResult again = RunCommand(folder.path(), kSmall);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  nlohmann::json same = ReadJson(out / "tune.json"), before = json;
  EXPECT_EQ(same.at("results").at("computed"), 0);
  EXPECT_GT(same.at("results").at("from_before"), 10);
  same.erase("results");
  before.erase("results");
  EXPECT_EQ(same, before);
}

// With a margin of 4, a jitter of 28 ms and hands of 50 N/mm no gains are stable.
TEST(Tune, RecommendsNothingIfNoGainsAreStable) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(
      folder.path(), {"tune", "demo", "--out", "t", "--nodes", "3", "--margin", "4", "--jitter-ms", "28",
                      "--worst-age-ms", "60", "--grip", "50000", "--stiffest-grip", "50000"});
  EXPECT_EQ(run.exit_code, 1) << run.out;
  EXPECT_NE(run.out.find("none"), std::string::npos) << run.out;
  EXPECT_TRUE(ReadJson(folder.path() / "t/tune.json").at("recommended").is_null());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "t/gains.yaml"));
}

// Without --jitter-ms, the jitter is assumed to be one period of the cell, here 4 ms (RSI). A cell's name may
// end in .yaml.
TEST(Tune, AssumesAJitterOfOnePeriodOfTheCell) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"tune", "kr_16_thin_plate.yaml", "--nodes", "4"});
  ASSERT_NE(run.exit_code, 2) << run.err;
  EXPECT_EQ(ReadJson(folder.path() / "tune/tune.json").at("stands").at("jitter_ms"), 4.0);
}

// Figures, response and hands from a file of `osteon identify` replace assumed values.
TEST(Tune, UsesMeasuredFiguresAndRefusesThoseOfAnotherCell) {
  const TemporaryFolder folder;
  const config::CellConfig demo =
      config::LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml");
  const studies::ResponseModel truth{.arm = {.bandwidth_hz = 14.0, .damping_ratio = 1.1, .dead_cycles = 3.4}};
  std::ofstream(folder.path() / "identified.yaml")
      << config::WriteIdentified(studies::IdentifiedOf(demo, truth), "");
  const CommandResult run = RunCommand(
      folder.path(), {"tune", "demo", "--out", "t", "--nodes", "3", "--identified", "identified.yaml"});
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "t/tune.json");
  EXPECT_EQ(json.at("identified"), true);
  EXPECT_NEAR(json.at("arm").at("dead_cycles"), 3.4, 1e-9);
  EXPECT_EQ(json.at("arm").at("bandwidth_hz"), 14.0);
  ASSERT_FALSE(json.at("margins").empty());
  int recommended = 0;
  for (const nlohmann::json& margin : json.at("margins")) {
    if (margin.at("gains") != "recommended") continue;
    ++recommended;
    EXPECT_EQ(margin.at("stable"), true) << margin.dump();
    EXPECT_EQ(margin.at("robust"), true) << margin.dump();
  }
  EXPECT_GT(recommended, 60) << "each hand and contact";
  EXPECT_TRUE(std::filesystem::is_regular_file(folder.path() / "t/tune_nyquist.svg"));
  // the key `identified` in a cell's file has the same effect as the option
  std::ofstream(folder.path() / "mine.yaml") << "identified: identified.yaml\n" << config::CellText("demo");
  const config::CellConfig mine = config::LoadCell(folder.path() / "mine.yaml");
  EXPECT_EQ(mine.simulated.servo.bandwidth_hz, 14.0);
  EXPECT_NEAR(mine.simulated.servo.dead_cycles, 3.4, 1e-9);

  const CommandResult other =
      RunCommand(folder.path(), {"tune", "molar", "--out", "o", "--identified", "identified.yaml"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("this is another cell's file"), std::string::npos) << other.err;
}

TEST(Tune, TunesACellWithTheImpedanceLaw) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(
      folder.path(), {"tune", "thin_plate_impedance", "--out", "t", "--nodes", "3", "--grip", "500"});
  const nlohmann::json json = ReadJson(folder.path() / "t/tune.json");
  EXPECT_EQ(json.at("law"), "impedance") << run.err;
  ASSERT_EQ(json.at("boundary").size(), 3u);
  for (const nlohmann::json& point : json.at("boundary")) {
    const double predicted = point.at("stiffness_predicted");
    EXPECT_NEAR(point.at("stiffness_simulated"), predicted, 0.1 * predicted) << point.dump();
  }
  ASSERT_FALSE(json.at("recommended").is_null());
  EXPECT_GE(json.at("recommended").at("margin"), 1.1);
  EXPECT_TRUE(json.at("check").at("grew").empty());
  for (const char* name : {"tune.html", "tune.svg", "tune.csv", "gains.yaml"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder.path() / "t" / name)) << name;
}

TEST(Tune, RefusesInvalidArguments) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  for (const auto& [arguments, said] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{}, "cell is required"},
           {{"elbow"}, "elbow: no file"},
           {{"thin_plate_impedance", "--plan", "acetabulum"}, "--plan: found with the impedance law"},
           {{"thin_plate_impedance", "--jitter-ms", "0.5"}, "--jitter-ms: found 0.5, accepted a multiple"},
           {{"demo", "--margin", "0.5"}, "--margin: found 0.5, accepted 1"},
           {{"demo", "--jitter-ms", "0.5"},
            "--jitter-ms: found 0.5, accepted a multiple of the cell's period"},
           {{"demo", "--jitter-ms", "30"}, "--jitter-ms: found 30, accepted at most 29"},
           {{"demo", "--grip", "20000"}, "--grip: found 20000, accepted at most --stiffest-grip (10000)"},
           {{"demo", "--out", "file"}, "--out file: found a file, accepted a folder"}}) {
    std::vector<std::string> all{"tune"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult run = RunCommand(folder.path(), all);
    EXPECT_EQ(run.exit_code, 2) << said;
    EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
  }
  EXPECT_NE(RunCommand(folder.path(), {"tune", "--help"}).out.find("Examples:"), std::string::npos);
}

}  // namespace
}  // namespace osteon::app
