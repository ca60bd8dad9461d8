#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "config/reading/sections/read_events.h"
#include "config/reading/simulated/read_script.h"

// Tests a cell's section script (the planned motion of the simulated hand), and a scene's section events.

namespace osteon::config {
namespace {

const std::string kCommon =
    "  duration_s: 8\n  push_force_N: 40\n  approach_force_N: 5\n  retract_height_mm: 20\n"
    "  max_target_mm_per_s: 150\n";
const std::string kDrilling = "script:\n  kind: drilling\n" + kCommon +
                              "  full_force_depth_mm: 9\n  peck_count: 3\n  peck_height_mm: 1\n";
const std::string kOpening = "script:\n  kind: opening\n" + kCommon +
                             "  full_force_depth_mm: 4\n  opening_radius_mm: 1.6\n  loop_period_s: 0.7\n"
                             "  turn_count: 2\n";

// The script read from the text of a cell.
hil::ScriptParams ScriptFrom(const std::string& text) {
  Reader reader = Reader::Parse(text, "cell.yaml");
  const Reader section = reader.Section("script");
  const hil::ScriptParams script = ReadScript(section);
  reader.Finish();
  return script;
}

// The error that `run` throws; "accepted" if there is none.
std::string ErrorOf(const std::function<void()>& run) {
  try {
    run();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ScriptSection, DrillingIsConvertedToSI) {
  const auto script = std::get<hil::DrillingScriptParams>(ScriptFrom(kDrilling));
  EXPECT_DOUBLE_EQ(script.seconds, 8.0);
  EXPECT_DOUBLE_EQ(script.push_force_N, 40.0);
  EXPECT_DOUBLE_EQ(script.approach_force_N, 5.0);
  EXPECT_DOUBLE_EQ(script.retract_height_m, 0.020);
  EXPECT_DOUBLE_EQ(script.max_target_m_per_s, 0.15);
  EXPECT_DOUBLE_EQ(script.depth_m, 0.009);
  EXPECT_EQ(script.pecks, 3);
  EXPECT_DOUBLE_EQ(script.peck_height_m, 0.001);
}

TEST(ScriptSection, OpeningIsConvertedToSI) {
  const auto script = std::get<hil::OpeningScriptParams>(ScriptFrom(kOpening));
  EXPECT_DOUBLE_EQ(script.depth_m, 0.004);
  EXPECT_DOUBLE_EQ(script.site_radius_m, 0.0016);
  EXPECT_DOUBLE_EQ(script.loop_period_s, 0.7);
  EXPECT_EQ(script.turns, 2);
}

TEST(ScriptSection, RefusesKeysOfAnotherKind) {
  std::string text = kDrilling;
  text.replace(text.find("drilling"), 8, "opening");
  EXPECT_EQ(ErrorOf([&] { (void)ScriptFrom(text); }),
            "cell.yaml:9: unknown key \"peck_count\", accepted approach_force_N, duration_s, "
            "full_force_depth_mm, kind, loop_period_s, max_target_mm_per_s, opening_radius_mm, push_force_N, "
            "retract_height_mm, turn_count");
  text.replace(text.find("opening"), 7, "boring");
  EXPECT_NE(
      ErrorOf([&] { (void)ScriptFrom(text); }).find("found boring, accepted reaming, drilling, opening"),
      std::string::npos)
      << ErrorOf([&] { (void)ScriptFrom(text); });
}

// The script's force must be below the hand's largest force, and the burr (radius 0.8 mm) must fit into the
// opening (radius 1.6 mm).
TEST(ScriptSection, IsCheckedAgainstToolAndHand) {
  Reader reader = Reader::Parse(kOpening + "operator:\n  max_force_N: 60\n", "cell.yaml");
  const Reader section = reader.Section("script"), hand = reader.Section("operator");
  auto script = std::get<hil::OpeningScriptParams>(ReadScript(section));
  script.head_radius_m = 0.0008;
  EXPECT_EQ(ErrorOf([&] { CheckScript(section, script, hand, 60.0); }), "accepted");
  EXPECT_NE(ErrorOf([&] {
              CheckScript(section, script, hand, 40.0);
            }).find("max_force_N: found 40, accepted more than the script's push_force_N (40)"),
            std::string::npos);
  script.head_radius_m = 0.002;  // this burr is wider than the opening
  const std::string error = ErrorOf([&] { CheckScript(section, script, hand, 60.0); });
  EXPECT_NE(error.find("cell.yaml:2: kind: operator's script: site_radius_m: found 0.0016"),
            std::string::npos)
      << error;
}

TEST(EventsSection, IsConvertedToSI) {
  Reader reader = Reader::Parse(
      "events:\n  regions:\n    - {name: nerve, material: pulp}\n  min_wall_mm: 0.8\n"
      "  opening_widening_ratio: 1.5\n  wall_spacing_mm: 0.4\n",
      "scene.yaml");
  const simulation::SceneEventParams events = ReadEvents(reader.Section("events"));
  reader.Finish();
  ASSERT_EQ(events.regions.size(), 1u);
  EXPECT_EQ(events.regions[0].name, "nerve");
  EXPECT_EQ(events.regions[0].material, "pulp");
  EXPECT_DOUBLE_EQ(events.min_wall_m, 0.0008);
  EXPECT_DOUBLE_EQ(events.opening_widening, 1.5);
  EXPECT_DOUBLE_EQ(events.wall_spacing_m, 0.0004);
}

}  // namespace
}  // namespace osteon::config
