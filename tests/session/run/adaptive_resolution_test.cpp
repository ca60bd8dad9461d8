#include "session/run/adaptive_resolution.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <ostream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulation/fidelity/accuracy.h"
#include "simulation/fidelity/carved_shape.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/tools/swept_tool.h"
#include "tests/session/run/virtual_run.h"
#include "tests/session/set_up_cell.h"

// A planned cell, and the adaptive resolution, which coarsens the packing's zones if frames take too long. On
// Vulkan; the tests give the frame times, so that no clock is involved.

namespace osteon::session {
namespace {

using testing::HasSubstr;

constexpr double kRate_hz = 250.0;                      // a frame may take 4000 us
constexpr double kSlow_us = 4600.0, kFast_us = 1000.0;  // given frame times

std::filesystem::path CellFile(const std::string& name) {
  return std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells" / (name + ".yaml");
}

// A shipped cell with its bone packed as the plan says.
CellSetup Planned(const std::string& name, const FidelityChoice& choice = {}) {
  auto setup = PrepareCell(CellFile(name), std::nullopt);
  EXPECT_TRUE(setup) << setup.error();
  const auto packed = PackCell(*setup, choice, {}, false);
  EXPECT_TRUE(packed) << packed.error();
  return std::move(*setup);
}

/// A shipped cell, planned once for the tests of this process.
const CellSetup& Shipped(const std::string& name) {
  static std::map<std::string, CellSetup> planned;
  const auto found = planned.find(name);
  return found != planned.end() ? found->second : planned.emplace(name, Planned(name)).first->second;
}

/// Sets the plan's predicted frame time to `us`; a fifth of it does not depend on the number of balls.
void SetFrameTimes(CellSetup& setup, double us) {
  auto planned = std::make_shared<PlannedCell>(*setup.planned);
  planned->request.timed = true;
  planned->request.rate_hz = kRate_hz;
  planned->plan.active_balls = 1000.0;
  planned->plan.cost = {.base_us = 0.2 * us, .ball_us = 0.8e-3 * us};
  planned->plan.frame_us = us;
  setup.planned = std::move(planned);
}

/// The results of a cell's run in virtual time.
struct MeasuredRun {
  CellRunResult result;
  RunSummary summary;
  io::Recording recording;
  std::size_t balls{0};    ///< before any coarsening
  double promised_m{0.0};  ///< error of the cut that the last packing promises
  double error_m{0.0};     ///< error of the cut, measured against the proxy's sweep
};

// Plans a cell's packing for an error of the cut of error_m, runs the cell in virtual time, and measures the
// error of its cut. @param slow  the first 300 frames in contact take kSlow_us, all others kFast_us; false:
// all frames take kFast_us
MeasuredRun RunAndMeasure(const std::string& name, double error_m, double seconds, bool slow) {
  CellSetup setup = Planned(name, {.as_packed = false, .error_m = error_m, .rate_hz = {}});
  SetFrameTimes(setup, 2000.0);
  auto engine = MakeEngine(setup, {});
  EXPECT_TRUE(engine) << engine.error();
  AdaptiveResolution adaptive_resolution(setup,
                                         {.rate_hz = kRate_hz, .window = 50, .engine = {}, .at_once = true});
  const io::test::TemporaryFolder folder;
  int contacts = 0;
  CellRunParams params{.seconds = seconds, .virtual_time = true, .recording = folder.path() / "r.mcap"};
  params.adaptive_resolution = &adaptive_resolution;
  params.frame_us = [&](const simulation::FrameRecord& record) {
    contacts += record.model.contact_count > 0;
    return slow && contacts < 300 ? kSlow_us : kFast_us;
  };
  auto result = RunCell(setup, **engine, params);
  EXPECT_TRUE(result) << result.error().what;
  auto recording = io::ReadRecording(params.recording);
  EXPECT_TRUE(recording) << recording.error();
  MeasuredRun finished;
  const RunAccumulator run = AccumulateRun(setup, *recording);
  finished.summary = Summarise(setup, **engine, params, *result, run);
  const auto& last = result->rezoned;
  finished.promised_m = last.empty() ? setup.planned->plan.promised_m : last.back().zones.promised_m;
  const simulation::CutAccuracy cut = simulation::MeasureCut(
      *setup.solid, simulation::BallUnion(last.empty() ? setup.bone.balls : last.back().bone.balls),
      simulation::BallUnion(simulation::LiveBalls(result->after)),
      simulation::SweptTool(setup.config.tool.tool, run.path.X_GP()),
      {.probe_radii_m = {}, .surface_cells = 12'000, .probe_samples = 1});
  finished.error_m = cut.depth_error_m + cut.MeanLeft_m();
  finished.result = std::move(*result);
  finished.recording = std::move(*recording);
  finished.balls = setup.bone.balls.size();
  return finished;
}

struct Case {
  const char* cell;
  double error_mm;
  bool whole;  ///< the run cuts along the scene's whole path; a cut that has only begun has a larger error
};

void PrintTo(const Case& of, std::ostream* out) { *out << of.cell; }

class AdaptiveResolutionRun : public testing::TestWithParam<Case> {};

TEST_P(AdaptiveResolutionRun, CoarsensZonesUnderLoadWithoutAStepInForceOrRemoval) {
  const Case asked = GetParam();
  const MeasuredRun finished = RunAndMeasure(asked.cell, 1e-3 * asked.error_mm, 3.0, true),
                    calm = RunAndMeasure(asked.cell, 1e-3 * asked.error_mm, 3.0, false);
  EXPECT_TRUE(calm.result.rezoned.empty());
  ASSERT_FALSE(finished.result.rezoned.empty());
  const Rezoned& first = finished.result.rezoned.front();
  EXPECT_LT(first.bone.balls.size(), finished.balls);
  EXPECT_EQ(first.bone.points.size(), finished.summary.points);
  EXPECT_EQ(first.seen_us, kSlow_us);
  EXPECT_LE(first.zones.frame_us, 0.9e6 / kRate_hz);
  EXPECT_EQ(finished.result.after.balls.size(), 4 * finished.result.rezoned.back().bone.balls.size());

  EXPECT_EQ(finished.result.end, control::RunEnd::kSeconds);
  EXPECT_EQ(finished.result.faults.bits(), 0u);
  EXPECT_LE(finished.summary.peak_force_N, finished.summary.force_limit_N);

  std::printf("%s: error %.4f mm of %.4f, coarsened %.4f mm of %.4f\n", asked.cell, calm.error_m * 1e3,
              calm.promised_m * 1e3, finished.error_m * 1e3, finished.promised_m * 1e3);
  if (asked.whole) {
    EXPECT_LE(calm.error_m, calm.promised_m);
    EXPECT_LE(finished.error_m, finished.promised_m);
  }
  EXPECT_GT(finished.promised_m, calm.promised_m);

  // the removed volume never jumps or falls, and ends at what the finer zones would have removed
  const auto& frames = finished.recording.frames;
  ASSERT_EQ(frames.size(), calm.recording.frames.size());
  double last_m3 = 0.0, most_m3 = 0.0, calm_most_m3 = 0.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double now_m3 = frames[i].model.removed_volume_m3;
    ASSERT_GE(now_m3, last_m3);
    most_m3 = std::max(most_m3, now_m3 - last_m3);
    last_m3 = now_m3;
    if (i > 0)
      calm_most_m3 = std::max(calm_most_m3, calm.recording.frames[i].model.removed_volume_m3 -
                                                calm.recording.frames[i - 1].model.removed_volume_m3);
  }
  EXPECT_LT(most_m3, 2.0 * calm_most_m3 + 1e-12);
  EXPECT_NEAR(last_m3, calm.result.after.removed_volume_m3, 0.1 * calm.result.after.removed_volume_m3);

  // Largest change of the coupling force from tick to tick, within 50 ms after the first exchange of
  // packings. With the exchange it may be at most 3 N larger than without.
  const auto max_force_step_N = [&](const MeasuredRun& of) {
    double most_N = 0.0;
    const auto& ticks = of.recording.ticks;
    for (std::size_t i = 1; i < ticks.size(); ++i)
      if (ticks[i].stamp > first.stamp && ticks[i].stamp <= first.stamp + 50'000'000)
        most_N = std::max(
            most_N, (Vector3(ticks[i].F_coupling_T_W.f) - Vector3(ticks[i - 1].F_coupling_T_W.f)).norm());
    return most_N;
  };
  // coupling force in the first tick after the first exchange
  const auto force_after_exchange_N = [&](const MeasuredRun& of) {
    for (const control::TickRecord& tick : of.recording.ticks)
      if (tick.stamp > first.stamp) return Vector3(tick.F_coupling_T_W.f).norm();
    return 0.0;
  };
  std::printf("%s: at %.0f N, step of a tick %.2f N, %.2f N without; %zu -> %zu balls\n", asked.cell,
              force_after_exchange_N(calm), max_force_step_N(finished), max_force_step_N(calm),
              finished.balls, first.bone.balls.size());
  EXPECT_GT(force_after_exchange_N(calm), 1.0) << "in contact";
  EXPECT_LT(max_force_step_N(finished), max_force_step_N(calm) + 3.0);

  // the recording's events and the summary name the coarser zones
  const auto told = [&](const char* text) {
    return std::ranges::any_of(finished.recording.events,
                               [&](const auto& event) { return event.text.find(text) != std::string::npos; });
  };
  EXPECT_TRUE(told("packing: "));
  EXPECT_TRUE(told("coarser zones are made"));
  EXPECT_TRUE(told("zones coarsened: "));
  const auto json = nlohmann::json::parse(ToJson(finished.summary, "osteon.demo/1"));
  EXPECT_EQ(json["rezoned"].size(), finished.result.rezoned.size());
  EXPECT_EQ(json["rezoned"][0]["spheres"], first.bone.balls.size());
  EXPECT_EQ(json["planned"]["rate_hz"], kRate_hz);
}

INSTANTIATE_TEST_SUITE_P(Cells, AdaptiveResolutionRun,
                         testing::Values(Case{"demo", 0.1, true}, Case{"femoral_canal", 0.06, false}),
                         [](const auto& of) { return std::string(of.param.cell); });

/// Runs a shipped cell over its whole script, planned for the error that its scene asks for.
class PlannedScript : public testing::TestWithParam<const char*> {};

TEST_P(PlannedScript, KeepsTheErrorThatItsSceneAsksFor) {
  const auto setup = PrepareCell(CellFile(GetParam()), std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  const double asked_m = setup->config.scene.fidelity.value().error_m;
  const MeasuredRun finished = RunAndMeasure(GetParam(), asked_m, 9.0, false);
  std::printf("%s: error %.4f mm of %.4f, %zu balls\n", GetParam(), finished.error_m * 1e3, asked_m * 1e3,
              finished.balls);
  EXPECT_EQ(finished.result.faults.bits(), 0u);
  EXPECT_LE(finished.error_m, asked_m);
  EXPECT_GT(finished.error_m, 0.2 * asked_m) << "much finer than it has to be";
}

INSTANTIATE_TEST_SUITE_P(Cells, PlannedScript,
                         testing::Values("demo", "molar", "thin_plate", "sawbone_block", "femoral_canal"),
                         [](const auto& of) { return std::string(of.param); });

TEST(AdaptiveResolution, GivesEqualStatesInEqualRuns) {
  const MeasuredRun a = RunAndMeasure("demo", 0.1e-3, 1.5, true),
                    b = RunAndMeasure("demo", 0.1e-3, 1.5, true);
  ASSERT_FALSE(a.result.rezoned.empty());
  EXPECT_EQ(a.summary.state_hash, b.summary.state_hash);
}

/// Steps the engine along the scene's path, frame by frame, and reports each frame with a given time.
class Driven : public testing::Test {
 protected:
  Driven() : setup_(Shipped("demo")) {
    SetFrameTimes(setup_, 2000.0);
    auto made = MakeEngine(setup_, {});
    EXPECT_TRUE(made) << made.error();
    engine_ = std::move(*made);
  }

  /// Runs up to `frames` frames that take `us` each. @returns true, and uses the replacement from then on,
  /// once the adaptive resolution has one
  bool Drive(AdaptiveResolution& adaptive_resolution, double us, std::size_t frames) {
    const auto& way = setup_.planned->scene.work.frames;
    for (std::size_t k = 0; k < frames; ++k, ++at_) {
      simulation::FrameInput input = way[std::min(at_, setup_.planned->scene.work.cut_end - 1)];
      input.X_WT = setup_.X_WG * Pose(input.X_WT);
      simulation::FrameRecord record;
      record.model = (made_ ? *made_->engine : *engine_).Step(input);
      EXPECT_EQ(record.model.status, simulation::EngineStatus::kOk);
      adaptive_resolution.ObserveFrame(record, us);
      if (auto coarser = adaptive_resolution.TakeReplacement(made_ ? *made_->engine : *engine_)) {
        made_ = std::move(coarser);
        return true;
      }
    }
    return false;
  }

  CellSetup setup_;
  std::unique_ptr<simulation::CuttingEngine> engine_;
  std::optional<AdaptiveResolution::Made> made_;
  std::size_t at_{0};
};

TEST_F(Driven, TheNewPackingIsMadeInAThreadAndContinuesTheRunsState) {
  AdaptiveResolution adaptive_resolution(setup_, {.rate_hz = kRate_hz, .window = 50, .engine = {}});
  EXPECT_FALSE(Drive(adaptive_resolution, kFast_us, 200)) << "in time";
  EXPECT_EQ(adaptive_resolution.TakeNotice(), "");
  EXPECT_FALSE(Drive(adaptive_resolution, kSlow_us, 60)) << "made in a thread of its own";
  EXPECT_THAT(adaptive_resolution.TakeNotice(),
              HasSubstr("frames take 4600 us, 4000 us at 250 Hz: coarser zones"));
  // the run continues meanwhile, and the new packing is carved along that path as well
  bool taken = false;
  for (int look = 0; look < 3000 && !taken; ++look) {
    taken = Drive(adaptive_resolution, kFast_us, 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_TRUE(taken);
  EXPECT_LT(made_->rezoned.bone.balls.size(), setup_.bone.balls.size());
  const simulation::CarvedState before = engine_->Snapshot(), after = made_->engine->Snapshot();
  EXPECT_EQ(after.cleared, before.cleared);
  EXPECT_EQ(after.frame, before.frame);
  EXPECT_EQ(after.removed_volume_m3, before.removed_volume_m3);
  // the run continues with the new packing
  EXPECT_FALSE(Drive(adaptive_resolution, kFast_us, 100));
}

TEST_F(Driven, SaysOnceThatNoCoarserZonesWouldReachTheRate) {
  AdaptiveResolution adaptive_resolution(setup_,
                                         {.rate_hz = kRate_hz, .window = 50, .engine = {}, .at_once = true});
  EXPECT_FALSE(Drive(adaptive_resolution, 100.0 * kSlow_us, 400));
  EXPECT_THAT(adaptive_resolution.TakeNotice(), HasSubstr("no coarser zones would have the rate"));
  EXPECT_FALSE(Drive(adaptive_resolution, 100.0 * kSlow_us, 100));
  EXPECT_EQ(adaptive_resolution.TakeNotice(), "");
}

TEST_F(Driven, EveryThirdFrameBeingSlowCoarsensNothing) {
  AdaptiveResolution adaptive_resolution(setup_,
                                         {.rate_hz = kRate_hz, .window = 50, .engine = {}, .at_once = true});
  for (int k = 0; k < 400; ++k) EXPECT_FALSE(Drive(adaptive_resolution, k % 3 == 0 ? kSlow_us : kFast_us, 1));
  EXPECT_EQ(adaptive_resolution.TakeNotice(), "");
}

TEST_F(Driven, CanBeEndedWhileItMakesAPacking) {
  AdaptiveResolution adaptive_resolution(setup_, {.rate_hz = kRate_hz, .window = 50, .engine = {}});
  Drive(adaptive_resolution, kSlow_us, 60);
  EXPECT_THAT(adaptive_resolution.TakeNotice(), HasSubstr("coarser zones are made"));
  adaptive_resolution.End();
  EXPECT_EQ(adaptive_resolution.TakeNotice(), "the run ended before the coarser zones were there");
  EXPECT_FALSE(Drive(adaptive_resolution, kSlow_us, 60)) << "nothing is made any more";
  EXPECT_EQ(adaptive_resolution.TakeNotice(), "");
}

TEST(PackCell, PlansIfTheSceneOrTheChoiceAsksForAnError) {
  const CellSetup& planned = Shipped("demo");
  ASSERT_TRUE(planned.planned);
  EXPECT_EQ(planned.planned->request.error_m, planned.config.scene.fidelity->error_m);
  EXPECT_EQ(planned.bone.balls.size(), planned.planned->plan.packed.balls.size());
  EXPECT_LE(planned.planned->plan.error_m, planned.planned->request.error_m);
  EXPECT_GT(planned.bone.points.size(), 1000u);
  EXPECT_FALSE(MakeAdaptiveResolution(planned, {})) << "by the closed forms alone: no clock";

  const CellSetup finer = Planned("demo", {.as_packed = false, .error_m = 0.05e-3, .rate_hz = {}});
  EXPECT_EQ(finer.planned->request.error_m, 0.05e-3);
  EXPECT_GT(finer.bone.balls.size(), 2 * planned.bone.balls.size());

  const CellSetup as_packed = Planned("demo", {.as_packed = true, .error_m = {}, .rate_hz = {}});
  EXPECT_FALSE(as_packed.planned);
  const auto plain = SetUpCell(CellFile("demo"), std::nullopt);
  ASSERT_TRUE(plain);
  EXPECT_EQ(as_packed.bone.balls.size(), plain->bone.balls.size());
}

// A plan that is made without a clock predicts frame times by closed forms instead of measuring them, so that
// the machine's load does not change it.
TEST(PackCell, WithoutAClockThePlanIsRepeatable) {
  const CellSetup &a = Shipped("thin_plate"), b = Planned("thin_plate");
  ASSERT_EQ(a.bone.balls.size(), b.bone.balls.size());
  for (std::size_t i = 0; i < a.bone.balls.size(); ++i)
    ASSERT_EQ(a.bone.balls[i].radius_m, b.bone.balls[i].radius_m);
}

TEST(PackCell, EveryShippedCellsDemandsAreMet) {
  for (const auto& entry : std::filesystem::directory_iterator(CellFile("demo").parent_path())) {
    const std::string name = entry.path().stem().string();
    const CellSetup& setup = Shipped(name);
    ASSERT_TRUE(setup.planned) << name;
    EXPECT_TRUE(setup.planned->plan.unmet.empty()) << name;
    std::printf("%s: %s, %zu balls\n", name.c_str(), PlannedText(*setup.planned).c_str(),
                setup.bone.balls.size());
  }
}

TEST(PackCell, RefusesAZoneOrABoneThatCannotBePlanned) {
  auto setup = PrepareCell(CellFile("demo"), std::nullopt);
  ASSERT_TRUE(setup);
  setup->config.scene.zone.kind = simulation::ZoneParams::Kind::kEverywhere;
  const auto packed = PackCell(*setup, {}, {}, false);
  ASSERT_FALSE(packed);
  EXPECT_THAT(packed.error(), HasSubstr("accepted cup, path"));
  EXPECT_FALSE(setup->planned);

  auto loaded = PrepareCell(CellFile("demo"), std::nullopt);
  ASSERT_TRUE(loaded);
  loaded->solid = nullptr;
  EXPECT_TRUE(PackCell(*loaded, {}, {}, false));
  const auto asked = PackCell(*loaded, {.as_packed = false, .error_m = 1e-4, .rate_hz = {}}, {}, false);
  ASSERT_FALSE(asked);
  EXPECT_THAT(asked.error(), HasSubstr("--error-mm"));
}

}  // namespace
}  // namespace osteon::session
