#include "studies/soak/wall_soak.h"

#include <unistd.h>

#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/reading/load.h"
#include "config/reading/load_surgical_plan.h"
#include "hil/operator/procedure_script.h"
#include "session/procedure/prepare_session.h"
#include "tests/report/report_markup.h"

// The soak in wall time: its seeded script, the judgement of its episodes, its page and JSON. The processes
// themselves run in tests/app/soak_wall_test.cpp.

namespace osteon::studies {
namespace {

using testing::Contains, testing::HasSubstr, testing::IsEmpty, testing::SizeIs;

TEST(WallScript, DependsOnTheSeedOnlyAndHasEveryEvent) {
  std::set<WallEvent> events;
  std::set<std::string> kills;
  bool differs = false, loses = false;
  for (int index = 0; index < 300; ++index) {
    const WallEpisode episode = WallEpisodeAt(3, index);
    EXPECT_EQ(episode.text, WallEpisodeAt(3, index).text);
    EXPECT_EQ(episode.at_s, WallEpisodeAt(3, index).at_s);
    differs |= episode.text != WallEpisodeAt(4, index).text;
    loses |= episode.life.loss_ratio > 0.0;
    events.insert(episode.event);
    if (IsKill(episode.event)) kills.insert(fmt::format("{} {}", NameOf(episode.event), episode.in_contact));
    EXPECT_LT(episode.at_s, episode.seconds);
    for (const WallPause& pause : episode.pauses) EXPECT_LT(pause.begin_s, episode.seconds) << episode.text;
    EXPECT_TRUE(episode.event != WallEvent::kEngineKill || episode.life.engine_process);
    EXPECT_EQ(episode.event == WallEvent::kTools, episode.life.plan);
    EXPECT_EQ(std::ranges::count_if(episode.pauses, &WallPause::next_tool),
              episode.event == WallEvent::kTools ? static_cast<int>(kToolsOfPlan) - 1 : 0);
    // after a kill in contact the tool is in bone, so no controller may start there
    EXPECT_TRUE(!episode.in_contact || episode.ends_life);
    EXPECT_EQ(episode.life.index != WallEpisodeAt(3, index + 1).life.index, episode.ends_life) << index;
  }
  EXPECT_THAT(events, SizeIs(kWallEvents));
  EXPECT_THAT(kills, SizeIs(7)) << "three processes in contact and clear of bone, the cell once";
  EXPECT_TRUE(differs);
  EXPECT_TRUE(loses);
}

TEST(WallScript, ASoakShorterThanAnEpisodeIsOneShortReaming) {
  for (const auto& [soak_s, episode_s] :
       {std::pair(3.6, kMinWallReaming_s), {12.0, 12.0}, {3600.0, kWallReaming_s}}) {
    const WallEpisode episode = FirstWallEpisode(3, soak_s);
    EXPECT_EQ(episode.event, WallEvent::kReaming);
    EXPECT_EQ(episode.seconds, episode_s);
    EXPECT_EQ(episode.life.seconds, episode_s) << "the hand's script";
    EXPECT_TRUE(soak_s >= kWallReaming_s || episode.seconds >= soak_s) << "no other one follows";
  }
}

// Each pause for a change of tool must lie in the phase in which the scripted hand changes the tool.
TEST(WallScript, ToolsAreChangedDuringTheHandsChangePhases) {
  int index = 0;
  while (!WallEpisodeAt(3, index).life.plan) ++index;
  const WallEpisode episode = WallEpisodeAt(3, index);
  const std::filesystem::path shipped = OSTEON_SOURCE_DIR "/config";
  config::CellConfig cell = config::LoadCell(shipped / "cells" / "demo.yaml");
  session::UseHandOfPlan(config::LoadSurgicalPlan(shipped / "plans" / "acetabulum.yaml").plan, "expert",
                         Pose::Identity(), {}, 0, cell);
  auto params = std::get<hil::ProcedureScriptParams>(cell.script);
  params.seconds = episode.seconds;
  const hil::HandScript script = hil::MakeProcedureScript(params);
  ASSERT_THAT(episode.pauses, SizeIs(kToolsOfPlan - 1));
  double paused_s = 0.0;  // length of the pauses so far: the script continues during them
  for (std::size_t tool = 0; tool < episode.pauses.size(); ++tool) {
    const WallPause& pause = episode.pauses[tool];
    const std::string change = fmt::format("change {}", tool + 1);
    EXPECT_EQ(script.PhaseName(pause.begin_s + paused_s), change);
    paused_s += pause.length_s + 0.5;
    EXPECT_EQ(script.PhaseName(pause.begin_s + paused_s), change) << "at the pause's end";
  }
}

// The result of an episode without any defect.
WallResult FaultlessEpisode(WallEvent event) {
  WallResult result;
  result.episode.event = event;
  result.episode.seconds = 20.0;
  result.outcome = {.exit = 0, .event_done = true, .messages = {300, 310, 0}};
  result.outcome.half = {.memory_MB = 100.0};
  for (ProcessUse& use : result.outcome.use) use = {.memory_MB = 110.0, .files = 20, .threads = 30};
  result.ended = "completed";
  result.ticks = result.figures.ticks = 20000;
  result.removed_mm3 = 6860.0;
  result.depth_mm = 8.356;
  result.figures.removed_m3 = 6860e-9;
  result.figures.complete = true;
  result.figures.peak_rendered_N = 120.0;
  result.figures.edge_work_J = result.figures.cutting_work_J = 100.0;
  if (event == WallEvent::kTools) result.passes = kToolsOfPlan;
  if (event == WallEvent::kHaltedCell) result.faults = {"arm message stale"};
  if (!IsKill(event)) return result;
  result.ended = "fault";
  result.outcome.cell = CellReport{.plc_blocks = "controller's heartbeat lost"};
  result.outcome.exit = 1;
  result.faults = {event == WallEvent::kEngineKill ? "contact model stale" : "arm message stale"};
  if (event != WallEvent::kControllerKill) return result;
  result.ended = "";
  result.outcome.exit = 137;
  result.faults = {};
  result.figures.complete = false;
  return result;
}

// The findings on a faultless episode to which `change` was applied.
std::vector<std::string> JudgedWith(WallEvent event, const std::function<void(WallResult&)>& change) {
  const WallResult first = FaultlessEpisode(WallEvent::kReaming);
  WallResult result = FaultlessEpisode(event);
  change(result);
  return JudgeWallEpisode(result, &first);
}

TEST(WallSoak, FindsEachDefectOfAnEpisode) {
  using R = WallResult;
  for (int i = 0; i < kWallEvents; ++i)
    EXPECT_THAT(JudgedWith(static_cast<WallEvent>(i), [](R&) {}), IsEmpty()) << i;
  const auto reaming = WallEvent::kReaming;
  const auto expect_finding = [](WallEvent event, const std::function<void(R&)>& change, const char* wrong) {
    EXPECT_THAT(JudgedWith(event, change), Contains(HasSubstr(wrong)));
  };
  expect_finding(
      reaming, [](R& r) { r.outcome.error = "the controller did not end"; }, "no episode");
  expect_finding(
      reaming, [](R& r) { r.faults = {"tracking error"}; }, "not injected");
  expect_finding(
      reaming, [](R& r) { r.ended = "fault"; }, "ended: fault");
  expect_finding(
      reaming, [](R& r) { r.outcome.exit = 139; }, "ended with 139");
  expect_finding(
      reaming, [](R& r) { r.figures.complete = false; }, "no end");
  expect_finding(
      reaming, [](R& r) { r.figures.missing_ticks = 2; }, "misses 2 ticks");
  expect_finding(
      reaming, [](R& r) { r.dropped_records = 1; }, "1 records were dropped");
  expect_finding(
      reaming, [](R& r) { r.figures.peak_rendered_N = 200.1; }, "200.1 N");
  expect_finding(
      reaming, [](R& r) { r.figures.max_model_age_s = 0.3; }, "300 ms");
  expect_finding(
      reaming, [](R& r) { r.figures.max_sensor_age_s = 0.2; }, "200 ms");
  expect_finding(
      reaming, [](R& r) { r.figures.momentum_residual = 0.03; }, "momentum");
  expect_finding(
      reaming, [](R& r) { r.figures.edge_work_J = 90.0; }, "energy");
  expect_finding(
      reaming, [](R& r) { r.cutting_debt_J = 5.0; }, "energy");
  expect_finding(
      reaming, [](R& r) { r.figures.removed_falls = true; }, "fell");
  expect_finding(
      reaming, [](R& r) { r.figures.rest_error_m = 1e-3; }, "at rest");
  expect_finding(
      reaming, [](R& r) { r.removed_mm3 += 1.0; }, "in the summary");
  expect_finding(
      reaming, [](R& r) { r.depth_mm += 0.2; }, "8.556 mm deep");
  expect_finding(
      reaming, [](R& r) { r.outcome.messages[1] = 0; }, "page 2 got nothing");
  expect_finding(
      WallEvent::kPages, [](R& r) { r.removed_mm3 = 1e9 * (r.figures.removed_m3 *= 1.02); }, "by the first");
  expect_finding(
      WallEvent::kHaltedCell, [](R& r) { r.faults.clear(); }, "no fault, injected");
  expect_finding(
      WallEvent::kPause, [](R& r) { r.outcome.event_done = false; }, "did not take place");
  expect_finding(
      WallEvent::kTools, [](R& r) { r.passes = 3; }, "3 passes");
  expect_finding(
      WallEvent::kGuardKill,
      [](R& r) {
        r.episode.ends_life = true;
        r.outcome.cell.reset();
      },
      "left no report");
  expect_finding(
      WallEvent::kControllerKill, [](R& r) { r.outcome.exit = 0; }, "ended with 0");
  expect_finding(
      WallEvent::kControllerKill, [](R& r) { r.outcome.cell->plc_permits = true; }, "permits");
  expect_finding(
      WallEvent::kGuardKill, [](R& r) { r.outcome.cell->spindle_rad_per_s = 9.0; }, "turns still");
  expect_finding(
      WallEvent::kGuardKill, [](R& r) { r.faults.clear(); }, "named no fault");
  expect_finding(
      WallEvent::kEngineKill, [](R& r) { r.faults = {"tool speed"}; }, "not stopped for the engine");
}

TEST(WallSoak, DistinguishesGrowingFromFlatResources) {
  std::vector<WallResult> results(16, FaultlessEpisode(WallEvent::kReaming));
  EXPECT_THAT(JudgeGrowth(results), IsEmpty());
  for (std::size_t i = 0; i < results.size(); ++i) {
    results[i].outcome.use[0].memory_MB = 100.0 + 4.0 * static_cast<double>(i);
    results[i].outcome.use[3].files = static_cast<int>(i);
  }
  EXPECT_THAT(JudgeGrowth(results), SizeIs(2));
  EXPECT_THAT(JudgeGrowth(results), Contains(HasSubstr("controller: the memory grew")));
  EXPECT_THAT(JudgeGrowth(results), Contains(HasSubstr("cell: 8 open files")));
  WallResult longest = FaultlessEpisode(WallEvent::kLong);
  longest.outcome.use[0].memory_MB = 150.0;
  EXPECT_THAT(JudgeGrowth(std::vector{longest}), Contains(HasSubstr("in its second half")));
}

TEST(WallSoak, PageAndJsonNameTheDefects) {
  std::vector<WallResult> results;
  for (int i = 0; i < kWallEvents; ++i) results.push_back(FaultlessEpisode(static_cast<WallEvent>(i)));
  results[3].wrong = {"no fault, injected: arm message stale"};
  SoakOptions options;
  options.command_line = "osteon soak --wall";
  const nlohmann::json json = nlohmann::json::parse(WallSoakJson(results, options));
  EXPECT_EQ(json.at("wrong_episodes"), 1);
  EXPECT_EQ(json.at("episodes").size(), results.size());
  EXPECT_EQ(json["episodes"][6]["exit"], 137);
  const std::string page = WallSoakPage(results, options);
  EXPECT_EQ(report::MarkupError(page), "");
  EXPECT_THAT(page, HasSubstr("no fault, injected: arm message stale"));
}

TEST(WallSoak, ReadsTheResourcesOfAProcess) {
  const ProcessUse use = UseOf(getpid());
  EXPECT_GT(use.memory_MB, 1.0);
  EXPECT_GE(use.files, 3);
  EXPECT_GE(use.threads, 1);
  EXPECT_EQ(UseOf(0).memory_MB, 0.0);
}

}  // namespace
}  // namespace osteon::studies
