#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "session/setup/cell_setup.h"
#include "simulation/tools/motion_player.h"
#include "tests/app/command.h"
#include "tests/app/short_run.h"

// Tests the motion file that a demo saves, and the events of a scene. The demos run in virtual time.

namespace osteon::app {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";

// Returns the bone's pose in the world, from the cell's file.
Pose BoneInWorld(const std::string& cell) {
  auto setup = session::PrepareCell(kConfig / "cells" / (cell + ".yaml"), std::nullopt);
  if (!setup) throw std::runtime_error(setup.error());
  return setup->X_WG;
}

// Belongs to the suite VirtualDemo because its tests share one run, SharedShortRun.
TEST(VirtualDemo, SavesTheCommandedMotionToFiveMicrometres) {
  const auto& [folder, run] = SharedShortRun();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto motion = simulation::LoadMotion(folder.path() / "motion.csv");
  ASSERT_TRUE(motion) << motion.error();
  const simulation::MotionCurve curve(motion->samples);
  const io::Recording recording = ReadComplete(folder.path() / "a/b/recording.mcap");
  const Pose X_GW = BoneInWorld("demo").inverse();

  std::size_t ticks = 0;
  rt::Nanoseconds start = 0;
  double worst_m = 0.0, worst_lever_m = 0.0, path_m = 0.0;
  Vector3 last = Vector3::Zero();
  for (const control::TickRecord& tick : recording.ticks) {
    if (tick.phase != control::Phase::kHaptic) continue;
    if (ticks++ == 0) start = tick.stamp;
    const Pose X_GT = X_GW * Pose(tick.X_WT_cmd), found = curve.X_GT(rt::ToSeconds(tick.stamp - start));
    // a point 100 mm from the apex, at which a wrong rotation becomes visible
    const Vector3 lever(0, 0, -0.1);
    worst_m = std::max(worst_m, (found.translation() - X_GT.translation()).norm());
    worst_lever_m = std::max(worst_lever_m, (found * lever - X_GT * lever).norm());
    if (ticks > 1) path_m += (X_GT.translation() - last).norm();
    last = X_GT.translation();
    EXPECT_NEAR(curve.SpindleAt(rt::ToSeconds(tick.stamp - start)), tick.spindle_rad_per_s, 1e-4);
  }
  EXPECT_GE(ticks, 1500u);  // 1.5 s at 1 kHz
  EXPECT_GT(path_m, 0.02) << "the hand did nothing";
  EXPECT_LT(worst_m, 5e-6);
  EXPECT_LT(worst_lever_m, 10e-6);
  std::printf("[ MEASURED ] %zu ticks, %zu samples, %zu bytes: %.2f um, %.2f um at 100 mm\n", ticks,
              motion->samples.size(), io::test::ReadAll(folder.path() / "motion.csv").size(), worst_m * 1e6,
              worst_lever_m * 1e6);

  // no event happened. The thinnest wall is half the block's width (40 mm) minus the reamer's radius
  const nlohmann::json summary = ReadJson(folder.path() / "a/b/summary.json");
  EXPECT_TRUE(summary.at("events").empty());
  EXPECT_NEAR(summary.at("least_wall_mm").get<double>(), 40.0 - 25.0, 1.0);

  // the file states its author, method and quality
  EXPECT_NE(motion->origin.made_by.find("simulated operator"), std::string::npos);
  EXPECT_EQ(motion->origin.cell, "config/cells/demo.yaml");
  EXPECT_EQ(motion->origin.clock, "virtual time");
  EXPECT_NE(motion->origin.command.find("demo --virtual-time --seconds 1.5"), std::string::npos);
  EXPECT_NE(motion->origin.error.find("recorded at 1000 Hz"), std::string::npos) << motion->origin.error;
}

TEST(SavedMotion, NamesAFolderThatDoesNotExist) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"demo", "--virtual-time", "--save-motion", "none/m.csv"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("--save-motion none/m.csv: no folder none"), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(folder.path() / "demo_out"));
}

// Copies config/ and replaces a text in the file of one scene. The text must occur there.
void CopyConfig(const fs::path& to, const std::string& scene, const std::string& from_text,
                const std::string& to_text) {
  fs::copy(kConfig, to, fs::copy_options::recursive);
  const fs::path file = to / "scenes" / (scene + ".yaml");
  std::string text = io::test::ReadAll(file);
  const std::size_t at = text.find(from_text);
  ASSERT_NE(at, std::string::npos) << from_text;
  io::test::WriteAll(file, text.replace(at, from_text.size(), to_text));
}

TEST(DemoEvents, BothEnginesReportTheSameEvent) {
  const TemporaryFolder folder;
  // the limit exceeds the wall's thickness beside the cup, so the first cut raises an event
  CopyConfig(folder.path() / "config", "acetabulum", "min_wall_mm: 2 ", "min_wall_mm: 20 ");
  nlohmann::json summaries[2];
  for (const int i : {0, 1}) {
    const std::string engine = i == 0 ? "vulkan" : "reference";
    const CommandResult run =
        RunCommand(folder.path(), {"--config-root", "config", "demo", "--virtual-time", "--seconds", "0.8",
                                   "--engine", engine, "--out", engine});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.out.find("wall too thin at "), std::string::npos) << run.out;
    summaries[i] = ReadJson(folder.path() / engine / "summary.json");

    // recording and report contain the event as well
    const io::Recording recording = ReadComplete(folder.path() / engine / "recording.mcap");
    const auto event = std::ranges::find_if(
        recording.events, [](const io::RecordedEvent& e) { return e.text.starts_with("wall too thin: "); });
    ASSERT_NE(event, recording.events.end());
    EXPECT_NEAR(summaries[i].at("events")[0].at("time_s").get<double>(),
                rt::ToSeconds(event->stamp - recording.ticks.front().stamp), 1e-12);
    EXPECT_NE(io::test::ReadAll(folder.path() / engine / "report.html").find("wall too thin"),
              std::string::npos);
  }
  for (const nlohmann::json& summary : summaries) {
    ASSERT_EQ(summary.at("events").size(), 1u) << summary.at("events");
    EXPECT_EQ(summary.at("events")[0].at("name"), "wall too thin");
    EXPECT_EQ(summary.at("events")[0].at("unit"), "mm");
  }
  // tolerances: the duration of a frame (2 ms), and single precision of the proxy's position
  EXPECT_NEAR(summaries[0].at("events")[0].at("time_s").get<double>(),
              summaries[1].at("events")[0].at("time_s").get<double>(), 0.010);
  EXPECT_NEAR(summaries[0].at("events")[0].at("value").get<double>(),
              summaries[1].at("events")[0].at("value").get<double>(), 0.05);
  EXPECT_NEAR(summaries[0].at("least_wall_mm").get<double>(), summaries[1].at("least_wall_mm").get<double>(),
              0.05);
}

}  // namespace
}  // namespace osteon::app
