#include <chrono>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/replay/replay.h"
#include "session/setup/recorded_config.h"
#include "tests/session/run/virtual_run.h"
#include "tests/session/set_up_cell.h"

// Runs in virtual time with other gains: a file of gains that is saved again during the run, and a drill with
// locked axes.

namespace osteon::session {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// The output of a run: its result, its recording, and the notices to the operator.
struct GainsRun {
  CellRunResult result;
  io::Recording recording;
  std::vector<std::string> notices;
};

// Writes a file whose modification time differs for each version, even if the file system stores times
// coarsely.
void Save(const fs::path& file, const std::string& text, int version) {
  std::ofstream(file) << text;
  fs::last_write_time(file,
                      fs::file_time_type(std::chrono::hours(24 * 365 * 40) + std::chrono::seconds(version)));
}

// Runs the cell "thin_plate". The gains are saved twice: at 1.5 s with good values, at 3.5 s with a mass of
// 0.
GainsRun RunWithSavedGains() {
  const io::test::TemporaryFolder folder;
  const fs::path gains = folder.path() / "gains.yaml";
  Save(gains, "admittance:\n  damping_Ns_per_m: [150, 150, 140]\n", 0);
  auto setup =
      SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt, std::nullopt, gains);
  EXPECT_TRUE(setup) << setup.error();
  auto engine = MakeEngine(*setup, {});
  EXPECT_TRUE(engine) << engine.error();
  GainsRun finished;
  int saved = 0;
  const auto edit = [&](double at_s) {
    if (saved == 0 && at_s > 1.5) {
      Save(gains, "admittance:\n  mass_kg: [2, 2, 2]\ncoupling:\n  stiffness_N_per_mm: 60\n", ++saved);
    } else if (saved == 1 && at_s > 3.5) {
      Save(gains, "admittance:\n  mass_kg: [2, 2, 0]\n", ++saved);
    }
  };
  const CellRunParams params{.seconds = 5.5,
                             .virtual_time = true,
                             .recording = folder.path() / "r.mcap",
                             .gains = gains,
                             .notice = [&](const std::string& text) { finished.notices.push_back(text); },
                             .progress = edit};
  auto result = RunCell(*setup, **engine, params);
  EXPECT_TRUE(result) << result.error().what;
  finished.result = std::move(*result);
  auto recording = io::ReadRecording(params.recording);
  EXPECT_TRUE(recording) << recording.error();
  finished.recording = std::move(*recording);
  return finished;
}

TEST(GainsRun, GoodGainsSavedDuringARunActBadOnesDoNotAndTheRunReplaysBitForBit) {
  const GainsRun finished = RunWithSavedGains();
  EXPECT_EQ(finished.result.faults.bits(), 0u);
  ASSERT_EQ(finished.notices.size(), 2u);
  EXPECT_THAT(finished.notices[0],
              AllOf(HasSubstr("mass_x 3 -> 2 kg"), HasSubstr("damping_z 140 -> 150 Ns_per_m"),
                    HasSubstr("coupling_stiffness 80000 -> 60000 N_per_m")));
  EXPECT_THAT(finished.notices[1],
              AllOf(HasSubstr("gains stay as they are"), HasSubstr(":2: mass_kg: found 0")));

  int taken = 0;
  double step_N = 0.0, peak_N = 0.0;
  const auto& ticks = finished.recording.ticks;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    if (ticks[i].input.has_gains) {
      ++taken;
      EXPECT_EQ(ticks[i].input.gains.mass_kg.x, 2.0);
      EXPECT_EQ(ticks[i].input.gains.max_stiffness_N_per_m, 60e3);
      EXPECT_EQ(ticks[i].phase, control::Phase::kHaptic);
    }
    peak_N = std::max(peak_N, Vector3(ticks[i].F_coupling_T_W.f).norm());
    step_N = std::max(step_N,
                      (Vector3(ticks[i].F_coupling_T_W.f) - Vector3(ticks[i - 1].F_coupling_T_W.f)).norm());
  }
  EXPECT_EQ(taken, 1) << "the wrong file was not taken";
  EXPECT_GT(peak_N, 10.0) << "in contact";

  const auto cell = LoadRecordedCell(finished.recording.session.config);
  ASSERT_TRUE(cell) << cell.error();
  const ReplayResult replay = Replay(finished.recording, *cell);
  EXPECT_TRUE(replay.identical) << replay.why_not;
  EXPECT_EQ(replay.ticks, ticks.size());
}

// All axes of the drill except the drilling axis are locked, while the simulated hand also pulls sideways.
TEST(GainsRun, ADrillWithLockedAxesStaysOnItsLineThroughoutTheRun) {
  config::CellConfig cell;
  const VirtualRun finished = RunInVirtualTime("thin_plate", 10.0, [&](config::CellConfig& config) {
    config.servo.admittance.locked = {true, true, false, true, true, true};
    cell = config;
  });
  EXPECT_EQ(finished.result.end, control::RunEnd::kSeconds);
  EXPECT_EQ(finished.result.faults.bits(), 0u);
  EXPECT_GT(finished.result.after.removed_volume_m3, 5e-9) << "it has drilled";
  const Pose* first = nullptr;
  Pose X_first;
  double off_m = 0.0, off_rad = 0.0, deep_m = 0.0, aside_N = 0.0;
  for (const control::TickRecord& tick : finished.recording.ticks) {
    if (tick.phase != control::Phase::kHaptic) continue;
    if (!first) {
      X_first = tick.X_WT_cmd;
      first = &X_first;
    }
    const Pose X = tick.X_WT_cmd;
    const Vector3 off_T = X_first.linear().transpose() * (X.translation() - X_first.translation());
    const Vector3 f_T = X_first.linear().transpose() * Vector3(tick.F_operator_T_W.f);
    off_m = std::max(off_m, std::hypot(off_T.x(), off_T.y()));
    off_rad = std::max(off_rad, LogRotation(X_first.linear().transpose() * X.linear()).norm());
    deep_m = std::max(deep_m, off_T.z());
    aside_N = std::max(aside_N, std::hypot(f_T.x(), f_T.y()));
  }
  RecordProperty("drift_um", std::to_string(1e6 * off_m));
  RecordProperty("drift_rad", std::to_string(off_rad));
  EXPECT_GT(deep_m, 0.015) << "down and through";
  EXPECT_LT(off_m, 10e-6);
  EXPECT_LT(off_rad, 1e-4);
  EXPECT_GT(aside_N, 1.0) << "the hand does pull aside";
}

}  // namespace
}  // namespace osteon::session
