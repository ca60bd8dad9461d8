#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "config/reading/load.h"
#include "config/reading/load_scenario.h"
#include "config/reading/strict/overlay.h"
#include "config/reading/strict/reader.h"
#include "tests/io/temporary_folder.h"

// Tests the scenarios' files in config/scenarios: the shipped scenarios with their golden traces, the
// accepted keys, and the errors of wrong files.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
const fs::path kScenarios = fs::path(OSTEON_SOURCE_DIR) / "config/scenarios";

std::vector<fs::path> ShippedScenarios() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kScenarios))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  return files;
}

// A valid scenario with its required keys only: 5 lines.
const std::string kGood = "shows: something\ncell: " OSTEON_SOURCE_DIR
                          "/config/cells/demo.yaml\nengine: plane\nduration_s: 2\nsample_ms: 20\n";

ScenarioConfig Load(const std::string& text) {
  const io::test::TemporaryFolder folder;
  io::test::WriteAll(folder.path() / "mine.yaml", text);
  return LoadScenario(folder.path() / "mine.yaml");
}

// The error of Load for this text; "taken" if the scenario is accepted.
std::string Refusal(const std::string& text) {
  try {
    static_cast<void>(Load(text));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "taken";
}

// Every shipped scenario must load and have a golden trace of less than 100 kB. Together the scenarios cover
// both laws, both kinds of arm, and injected faults.
TEST(ScenarioFiles, EveryShippedScenarioLoadsWithItsCell) {
  std::set<std::string> cells;
  std::set<ScenarioEngine> engines;
  int faults = 0, impedance = 0, six_axes = 0;
  const auto files = ShippedScenarios();
  EXPECT_GE(files.size(), 20u);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    const ScenarioConfig scenario = LoadScenario(file);
    EXPECT_TRUE(fs::exists(scenario.golden())) << scenario.golden();
    EXPECT_LT(fs::file_size(scenario.golden()), 100'000u);
    Overlay overlay(scenario.cell);
    overlay.SetFromFile(file, kOverridesKey);
    const CellConfig cell = LoadCell(scenario.cell);
    overlay.Finish();
    cells.insert(scenario.cell.stem().string());
    engines.insert(scenario.engine);
    faults += cell.injections.injections.empty() ? 0 : 1;
    impedance += cell.servo.law == control::Law::kImpedance ? 1 : 0;
    six_axes += cell.robot.six_axis() ? 1 : 0;
  }
  for (const char* cell : {"demo", "molar", "femoral_canal", "thin_plate", "sawbone_block",
                           "thin_plate_impedance", "kr_16_thin_plate", "femoral_head"})
    EXPECT_TRUE(cells.contains(cell)) << cell;
  EXPECT_GE(faults, 5);
  EXPECT_GE(impedance, 2);
  EXPECT_GE(six_axes, 2);
  EXPECT_EQ(engines, (std::set{ScenarioEngine::kPlane, ScenarioEngine::kReference}))
      << "traces of a GPU are its own";
}

TEST(ScenarioFiles, AGuidanceGainNeedsAPlan) {
  const std::string plan = "plan: " OSTEON_SOURCE_DIR "/config/plans/acetabulum.yaml\n";
  const ScenarioConfig guided = Load(kGood + plan + "guidance_ratio: 0.5\n");
  EXPECT_EQ(guided.plan.stem(), "acetabulum");
  EXPECT_EQ(guided.guidance, 0.5);
  EXPECT_FALSE(Load(kGood + plan).guidance) << "the plan's own";
  EXPECT_NE(Refusal(kGood + "guidance_ratio: 0.5\n").find("accepted with `plan`"), std::string::npos);
  EXPECT_NE(Refusal(kGood + plan + "guidance_ratio: 1.5\n").find("0 … 1"), std::string::npos);
}

TEST(ScenarioFiles, EveryGoldenTraceHasAScenario) {
  std::set<std::string> names;
  for (const fs::path& file : ShippedScenarios()) names.insert(file.stem().string());
  for (const auto& entry : fs::directory_iterator(kScenarios / "golden"))
    EXPECT_TRUE(names.contains(entry.path().stem().string())) << entry.path();
}

TEST(ScenarioFiles, ReadsEveryKeyAndTheDefaults) {
  const ScenarioConfig scenario =
      Load(kGood +
           "recovery_count: 2\npause_s: 0.5\nresume_s: 1\n"
           "tolerances: {force_N: 0.5, position_um: 3, volume_mm3: 2, event_ms: 4}\n"
           "overrides: {limits.max_force_N: 100}\n");
  EXPECT_EQ(scenario.name, "mine");
  EXPECT_EQ(scenario.shows, "something");
  EXPECT_EQ(scenario.engine, ScenarioEngine::kPlane);
  EXPECT_DOUBLE_EQ(scenario.seconds, 2.0);
  EXPECT_DOUBLE_EQ(scenario.sample_s, 0.02);
  EXPECT_EQ(scenario.recoveries, 2);
  EXPECT_EQ(scenario.pause_s, 0.5);
  EXPECT_EQ(scenario.resume_s, 1.0);
  EXPECT_DOUBLE_EQ(scenario.tolerances.force_N, 0.5);
  EXPECT_DOUBLE_EQ(scenario.tolerances.position_m, 3e-6);
  EXPECT_DOUBLE_EQ(scenario.tolerances.volume_m3, 2e-9);
  EXPECT_DOUBLE_EQ(scenario.tolerances.event_s, 4e-3);
  EXPECT_DOUBLE_EQ(scenario.tolerances.torque_Nm, TraceTolerances{}.torque_Nm);
  EXPECT_EQ(scenario.golden().filename(), "mine.txt");
  EXPECT_DOUBLE_EQ(scenario.frame_s, 0.002) << "as before there was the key";
  EXPECT_FALSE(scenario.planned);
}

TEST(ScenarioFiles, ReadsTheFrameTimeAndTheKindOfPacking) {
  const ScenarioConfig scenario = Load(kGood + "frame_ms: 30\npacking: planned\n");
  EXPECT_DOUBLE_EQ(scenario.frame_s, 0.030);
  EXPECT_TRUE(scenario.planned);
  EXPECT_FALSE(Load(kGood + "packing: scene\n").planned);
}

TEST(ScenarioFiles, ErrorsNameLineAndRange) {
  const auto expect = [](const std::string& text, const std::vector<std::string>& parts) {
    const std::string refusal = Refusal(text);
    for (const std::string& part : parts) EXPECT_NE(refusal.find(part), std::string::npos) << refusal;
  };
  expect(kGood + "duration: 3\n", {"mine.yaml:6", "unknown key \"duration\""});
  expect("shows: x\n", {"missing key \"cell\""});
  expect("shows: x\ncell: nowhere.yaml\n", {"mine.yaml:2", "nowhere.yaml"});
  expect(kGood + "resume_s: 1\n", {"mine.yaml:6: resume_s", "pause_s"});
  expect(kGood + "pause_s: 1\nresume_s: 1\n", {"mine.yaml:7: resume_s: found 1"});
  expect(kGood + "tolerances: {force_N: -1}\n", {"mine.yaml:6: force_N: found -1, accepted 0 … 200"});
  expect(kGood + "frame_ms: 0.5\n", {"mine.yaml:6: frame_ms: found 0.5, accepted 1 … 100"});
  expect(kGood + "packing: fine\n", {"mine.yaml:6: packing: found fine, accepted scene, planned"});
  std::string engine = kGood;
  engine.replace(engine.find("plane"), 5, "brute");
  expect(engine, {"mine.yaml:3: engine: found brute, accepted plane, reference, vulkan"});
}

}  // namespace
}  // namespace osteon::config
