#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "config/reading/strict/overlay.h"
#include "session/planning/planned_cell.h"
#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "tests/io/temporary_folder.h"

// Cutting convex bone in its planned packing, in virtual time. Between two frames the contact planes may
// change much while the proxy hardly moves. This must not step the force so far that the cell trips, for any
// duration of a frame.

namespace osteon::session {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = OSTEON_SOURCE_DIR "/config";
constexpr int kSeeds = 10;  // seeds of the tremor, one for each frame duration

// A tool's file under config/tools, and its diameter.
struct Tool {
  const char* name;
  double diameter_m;
};

// The cell "femoral_head" with this tool, its bone packed as planned; with a mesh, that bone instead of the
// head.
CellSetup PlannedHead(const Tool& tool, const std::optional<MeshChoice>& mesh = std::nullopt) {
  // start near the bone, because slow frames limit the tool's speed (model sight); the reamer starts higher,
  // because its centre is a radius above its apex
  const fs::path cell = kConfig / "cells/femoral_head.yaml";
  config::Overlay overlay(cell);
  overlay.Set(fmt::format("start.height_mm={}", tool.diameter_m > 0.02 ? 28 : 4), "the test");
  auto setup = PrepareCell(cell, mesh,
                           config::ToolChoice{.file = kConfig / "tools" / (std::string(tool.name) + ".yaml"),
                                              .diameter_m = tool.diameter_m});
  EXPECT_TRUE(setup) << setup.error();
  overlay.Finish();
  const auto packed = PackCell(*setup, {}, {}, false);
  EXPECT_TRUE(packed) << packed.error();
  EXPECT_TRUE(setup->planned);
  return std::move(*setup);
}

// The results of a run.
struct FinishedRun {
  CellRunResult result;
  double max_step{0.0};  ///< largest change of the force per tick, as a fraction of the trip's limit
  double peak_N{0.0};
};

/// Runs the cell with frames of the simulation that take frame_ms each. @param seed  for the hand's tremor
FinishedRun RunBriefly(CellSetup& setup, double seconds, int frame_ms, int seed) {
  setup.config.simulated.hand.tremor_seed = static_cast<std::uint64_t>(seed);
  auto engine = MakeEngine(setup, {});
  EXPECT_TRUE(engine) << engine.error();
  const io::test::TemporaryFolder folder;
  FinishedRun finished;
  const CellRunParams params{
      .seconds = seconds,
      .virtual_time = true,
      .frame_s = 1e-3 * frame_ms,
      .recording = folder.path() / "r.mcap",
      .ticked = [&](const control::TickRecord& tick, const simulation::ContactModel&) {
        if (tick.wrench_step_limit_N > 0.0)
          finished.max_step = std::max(finished.max_step, tick.wrench_step_N / tick.wrench_step_limit_N);
        finished.peak_N = std::max(finished.peak_N, Vector3(tick.F_coupling_T_W.f).norm());
      }};
  auto result = RunCell(setup, **engine, params);
  EXPECT_TRUE(result) << result.error().what;
  finished.result = std::move(*result);
  return finished;
}

// Length of a run that reaches the bone: with slow frames the tool approaches more slowly (model sight).
double SecondsToBone(int frame_ms) { return frame_ms <= 12 ? 2.0 : 4.0; }

class FemoralHead : public ::testing::TestWithParam<Tool> {};

TEST_P(FemoralHead, IsCutWithoutATripForAnyFrameDuration) {
  CellSetup setup = PlannedHead(GetParam());
  double max_step = 0.0, min_peak_N = 1e9;
  const int frames_ms[] = {1, 2, 4, 6, 8, 12, 16, 20, 25, 30};
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const int frame_ms = frames_ms[seed % 10];
    SCOPED_TRACE(fmt::format("seed {}, frames of {} ms", seed, frame_ms));
    const FinishedRun finished = RunBriefly(setup, SecondsToBone(frame_ms), frame_ms, seed);
    EXPECT_EQ(finished.result.end, control::RunEnd::kSeconds);
    EXPECT_EQ(finished.result.faults.bits(), 0u);
    if (frame_ms < 30) {  // with frames of 30 ms the force fades to zero
      EXPECT_GT(finished.result.after.removed_volume_m3, 0.0);
    }
    EXPECT_EQ(finished.result.statistics.limits.Of(safety::Limit::kPassivity).events, 0u);
    EXPECT_EQ(finished.result.statistics.limits.Of(safety::Limit::kTank).events, 0u);
    max_step = std::max(max_step, finished.max_step);
    if (frame_ms <= 12) min_peak_N = std::min(min_peak_N, finished.peak_N);
  }
  RecordProperty("most_step", std::to_string(max_step));
  EXPECT_GT(min_peak_N, 30.0) << "it is pressed";
}

INSTANTIATE_TEST_SUITE_P(Tools, FemoralHead,
                         ::testing::Values(Tool{"twist_drill", 0.004}, Tool{"round_burr", 0.006},
                                           Tool{"reamer", 0.050}),
                         [](const auto& param) { return std::string(param.param.name); });

// The coupling turns the force gradually from the old to the new frame's planes, by turn_m_per_s. At 10 m/s
// the force turns within one tick, which must give larger steps. Otherwise the test above would prove
// nothing.
TEST(FemoralHeadSteps, AreLargerIfTheForceTurnsToNewPlanesWithinOneTick) {
  CellSetup setup = PlannedHead({"twist_drill", 0.004});
  const double shipped = RunBriefly(setup, 2.0, 4, 1).max_step;
  setup.config.servo.coupling.turn_m_per_s = 10.0;
  double at_once = 0.0;
  for (const int frame_ms : {4, 8, 16, 30})
    at_once = std::max(at_once, RunBriefly(setup, 2.0, frame_ms, 1).max_step);
  RecordProperty("shipped", std::to_string(shipped));
  RecordProperty("at_once", std::to_string(at_once));
  EXPECT_GT(at_once, shipped);
}

// Three places on the outer faces of a hip bone from CT, which are convex as well.
TEST(HipBoneOuterFaces, AreDrilledWithoutATrip) {
  const char* data = std::getenv("OSTEON_DATA_DIR");
  const fs::path mesh = fs::path(data ? data : "") / "hip_bone_left.obj";
  if (!data || !fs::exists(mesh)) GTEST_SKIP() << "skipped, no anatomical meshes";
  struct Site {
    const char* name;
    Vector3 p_mm, axis;
  };
  const Site sites[] = {{"iliac crest", {61.619, -164.138, 633.985}, {-0.197, -0.659, 0.726}},
                        {"ischium, behind", {27.689, -156.454, 451.099}, {0.600, -0.637, -0.484}},
                        {"ischium, below", {10.640, -128.568, 436.205}, {0.067, 0.125, -0.990}}};
  int seed = 1;
  for (const Site& site : sites) {
    SCOPED_TRACE(site.name);
    CellSetup setup = PlannedHead(
        {"twist_drill", 0.004},
        MeshChoice{
            .file = mesh,
            .cup = simulation::CutSite{.center_m = 1e-3 * site.p_mm, .axis = site.axis, .radius_m = 0.002}});
    for (const int frame_ms : {2, 8, 20}) {
      const FinishedRun finished = RunBriefly(setup, SecondsToBone(frame_ms), frame_ms, seed++);
      EXPECT_EQ(finished.result.end, control::RunEnd::kSeconds) << frame_ms;
      EXPECT_EQ(finished.result.faults.bits(), 0u) << frame_ms;
      EXPECT_GT(finished.peak_N, 30.0) << frame_ms;
    }
  }
}

}  // namespace
}  // namespace osteon::session
