#include "session/gains/tune_advice.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/reading/load.h"
#include "session/gains/gains_panel.h"
#include "tests/temporary_path.h"

// Reading a result of `osteon tune`, and its figures on the console's panel of gains.

namespace osteon::session {
namespace {

using testing::HasSubstr;

config::CellConfig Demo() { return config::LoadCell(OSTEON_SOURCE_DIR "/config/cells/demo.yaml"); }

// The parts of a tune.json of the demo that the panel reads.
nlohmann::json TuneResult(const config::CellConfig& cell) {
  const double mass_kg = cell.servo.admittance.mass_kg.z(), drag = cell.servo.admittance.damping_Ns_per_m.z();
  return {{"schema", "osteon.tune/1"},
          {"cell", "demo"},
          {"law", "admittance"},
          {"arm", {{"period_ms", 1e3 * cell.servo.period_s}}},
          {"stands", {{"wall_N_per_m", cell.servo.coupling.max_stiffness_N_per_m}, {"worst_age_ms", 2.0}}},
          {"margin", 1.1},
          {"own", {{"mass_kg", mass_kg}, {"damping_Ns_per_m", drag}, {"margin", 1.12}}},
          {"recommended", {{"mass_kg", mass_kg}, {"damping_Ns_per_m", drag - 2.0}, {"margin", 1.11}}},
          {"boundary",
           {{{"damping", drag}, {"stiffness_predicted", 40e3}},
            {{"damping", 2.0 * drag}, {"stiffness_predicted", 90e3}},
            {{"damping", 3.0 * drag}, {"stiffness_predicted", 70e3}}}}};
}

std::filesystem::path Write(const nlohmann::json& json) {
  const std::filesystem::path file = TemporaryPath("tune.json");
  std::ofstream(file) << json;
  return file;
}

TEST(TuneAdvice, AResultOfAnotherCellOrOtherGainsIsRefused) {
  const config::CellConfig cell = Demo();
  const nlohmann::json own = TuneResult(cell);
  ASSERT_TRUE(ReadTuneAdvice(Write(own), cell, "demo"));
  EXPECT_THAT(ReadTuneAdvice(TemporaryPath("none.json"), cell, "demo").error(),
              HasSubstr("found no file, accepted a result of `osteon tune demo`"));
  EXPECT_THAT(ReadTuneAdvice(Write({{"schema", "osteon.demo/1"}}), cell, "demo").error(),
              HasSubstr("found another file"));
  EXPECT_THAT(ReadTuneAdvice(Write(own), cell, "molar").error(),
              HasSubstr("found a result of the cell demo, accepted one of `osteon tune molar`"));
  nlohmann::json other = own;
  other["law"] = "impedance";
  EXPECT_THAT(ReadTuneAdvice(Write(other), cell, "demo").error(), HasSubstr("found the impedance law"));
  for (const char* key : {"mass_kg", "damping_Ns_per_m"}) {
    other = own;
    other["own"][key] = 0.9 * own["own"][key].get<double>();
    EXPECT_THAT(ReadTuneAdvice(Write(other), cell, "demo").error(), HasSubstr("run `osteon tune demo` again"))
        << key;
  }
  other = own;
  other["stands"]["wall_N_per_m"] = 1e3;
  EXPECT_THAT(ReadTuneAdvice(Write(other), cell, "demo").error(),
              HasSubstr("found a coupling's stiffness of 1000 N/m"));
}

TEST(TuneAdvice, ThePanelShowsTheMarginOfThePresentGains) {
  const config::CellConfig cell = Demo();
  const double drag = cell.servo.admittance.damping_Ns_per_m.z();
  GainsPanel panel(cell);
  panel.SetTune(ReadTuneAdvice(Write(TuneResult(cell)), cell, "demo"));
  const auto tune = [&] { return nlohmann::json::parse(panel.Json()).at("tune"); };
  EXPECT_EQ(tune().at("margin"), 1.12);
  EXPECT_EQ(tune().at("wall_N_per_m"), 40e3);
  EXPECT_EQ(tune().at("recommended").at("drag_Ns_per_m"), drag - 2.0);
  // a larger drag keeps the margin; between two drags of tune's map, the panel states the softer of their two
  // walls
  using Kind = console::GainsRequest::Kind;
  ASSERT_TRUE(panel.Request({.kind = Kind::kDrag, .value = 2.5 * drag}).done);
  EXPECT_EQ(tune().at("margin"), 1.12);
  EXPECT_EQ(tune().at("wall_N_per_m"), 70e3);
  ASSERT_TRUE(panel.Request({.kind = Kind::kDrag, .value = 4.0 * drag}).done);
  EXPECT_TRUE(tune().at("wall_N_per_m").is_null()) << "beyond the map";
  // a gains file may set a mass for which tune computed no margin
  control::Gains lighter = control::GainsOf(cell.servo.admittance, cell.servo.coupling);
  lighter.mass_kg.z *= 0.5;
  panel.SetPresent(lighter);
  EXPECT_TRUE(tune().at("margin").is_null());
}

TEST(TuneAdvice, WithoutAResultThePanelNamesTheCommandThatMakesOne) {
  const config::CellConfig cell = Demo();
  GainsPanel panel(cell);
  panel.SetTune(ReadTuneAdvice(TemporaryPath("none.json"), cell, "demo"));
  const auto json = nlohmann::json::parse(panel.Json());
  EXPECT_TRUE(json.at("tune").is_null());
  EXPECT_THAT(json.at("tune_why").get<std::string>(), HasSubstr("`osteon tune demo`"));
}

}  // namespace
}  // namespace osteon::session
