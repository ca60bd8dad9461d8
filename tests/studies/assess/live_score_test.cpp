// The score that the console shows while a session goes on, beside `osteon assess` of the same passes.

#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/reading/load_rubric.h"
#include "session/planning/planned_cell.h"
#include "session/procedure/live_score.h"
#include "session/procedure/prepare_session.h"
#include "session/run/cell_run.h"
#include "studies/assess/assess_result.h"
#include "tests/temporary_path.h"

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";

// The shipped plan with its last two reamers.
fs::path TwoReamers() {
  std::ifstream stream(kConfig / "plans/acetabulum.yaml");
  std::string plan, line;
  while (std::getline(stream, line)) {
    if (line.starts_with("scene: acetabulum"))
      line = "scene: " + (kConfig / "scenes/acetabulum.yaml").string();
    if (!line.starts_with("  - {diameter_mm: 44") && !line.starts_with("  - {diameter_mm: 46"))
      plan += line + "\n";
  }
  const fs::path file = TemporaryPath("two_reamers.yaml");
  std::ofstream(file) << plan;
  return file;
}

// A score as it was said after so many passes.
struct Said {
  std::size_t passes;
  nlohmann::json score;
};

// Runs a session, and keeps what was said of its score after each pass.
std::vector<Said> RunSession(const fs::path& folder) {
  const fs::path cell = kConfig / "cells/demo.yaml";
  const session::ProcedureChoice choice{
      .plan = TwoReamers(), .session = folder, .hand = "expert", .virtual_time = true};
  const auto procedure = session::OpenProcedure(choice, cell, std::nullopt);
  EXPECT_TRUE(procedure) << procedure.error();
  auto setup = session::PrepareCell(cell, std::nullopt, procedure->tool);
  EXPECT_TRUE(setup) << setup.error();
  const session::EngineChoice engine_choice{.engine = "cpu"};
  EXPECT_TRUE(session::PackCell(*setup, {}, engine_choice, false));
  auto engine = session::MakeEngine(*setup, engine_choice);
  EXPECT_TRUE(engine) << engine.error();
  auto made = session::MakeSession(*procedure, choice, cell, {}, engine_choice, true, true, *setup, *engine);
  EXPECT_TRUE(made) << made.error();
  session::ProcedureSession& running = **made;
  std::vector<Said> said{{0, nlohmann::json::parse(running.ScoreJson())}};
  const auto look = [&] {
    const std::size_t passes = running.File().passes.size();
    if (passes > said.back().passes) said.push_back({passes, nlohmann::json::parse(running.ScoreJson())});
  };
  const auto run =
      session::RunCell(*setup, **engine,
                       {.seconds = 16.0,
                        .virtual_time = true,
                        .recording = folder / procedure->recording,
                        .procedure = &running,
                        .ticked = [&](const control::TickRecord& tick, const simulation::ContactModel&) {
                          if (tick.tick % 10 == 0) look();
                        }});
  EXPECT_TRUE(run) << run.error().what;
  look();
  return said;
}

// The session as it was after its first passes.
fs::path CopyWithPasses(const fs::path& folder, std::size_t passes) {
  const fs::path copy = TemporaryPath("after_" + std::to_string(passes));
  fs::copy(folder, copy);
  auto file = session::ReadSession(copy);
  EXPECT_TRUE(file);
  file->passes.resize(passes);
  EXPECT_TRUE(session::WriteSession(copy, *file));
  return copy;
}

const nlohmann::json& ItemOf(const nlohmann::json& score, const std::string& metric) {
  for (const nlohmann::json& item : score.at("items"))
    if (item.at("metric") == metric) return item;
  ADD_FAILURE() << metric;
  return score;
}

TEST(LiveScore, IsTheAssessmentsOwnAndNeverAboveIt) {
  const fs::path folder = TemporaryPath("live_score");
  const std::vector<Said> all = RunSession(folder);
  ASSERT_GE(all.size(), 3u) << "a pass of each reamer";
  EXPECT_EQ(all.front().score.at("known"), false);
  EXPECT_EQ(all.front().score.at("why"), "");
  const procedure::Rubric rubric = config::LoadRubric(kConfig / "rubrics/rubric.yaml");
  for (const Said& said : all) {
    if (said.passes == 0) continue;
    SCOPED_TRACE(said.passes);
    const nlohmann::json& score = said.score;
    ASSERT_EQ(score.at("known"), true);
    EXPECT_EQ(score.at("of"), 100.0);
    const auto assessed = ReadAssessedSession(CopyWithPasses(folder, said.passes));
    ASSERT_TRUE(assessed) << assessed.error();
    const auto values = procedure::ValuesOf(assessed->plan.plan, assessed->assessment);
    const procedure::Score whole = procedure::ScoreOf(rubric, values, assessed->assessment.min_wall_m);
    EXPECT_LE(score.at("total").get<double>(), whole.total + 1e-6);
    EXPECT_EQ(score.at("unfinished"), UnfinishedOf(*assessed).text);
    EXPECT_EQ(score.at("deductions").size(), whole.deductions.size());
    double open = 0.0;
    for (const procedure::ScoredItem& scored : whole.items) {
      const nlohmann::json& item = ItemOf(score, scored.item.metric);
      if (item.at("open").get<bool>()) {
        open += scored.item.weight;
        EXPECT_TRUE(item.at("value").is_null());
        EXPECT_EQ(item.at("points"), 0.0);
      } else {
        EXPECT_NEAR(item.at("points").get<double>(), scored.points, 1e-6) << scored.item.metric;
      }
    }
    EXPECT_EQ(score.at("open_points"), open);
  }
  // the last reamer decides most of it: until it has cut, that is open
  const nlohmann::json &first = all[1].score, &last = all.back().score;
  EXPECT_TRUE(ItemOf(first, "axis_error").at("open"));
  EXPECT_TRUE(ItemOf(first, "diameter_error").at("open"));
  EXPECT_FALSE(ItemOf(first, "over_reamed").at("open")) << "bone that is gone does not come back";
  EXPECT_NE(first.at("unfinished"), "");
  EXPECT_FALSE(ItemOf(last, "axis_error").at("open"));
  EXPECT_EQ(last.at("open_points"), 0.0);
  EXPECT_GT(last.at("total"), 85.0);
}

// An item that is not known of a session that is resumed is open, and a breach in the dark is assumed.
TEST(LiveScore, OfAnotherProcessesPassesTheWallsAreNotTrusted) {
  const procedure::Rubric rubric = config::LoadRubric(kConfig / "rubrics/rubric.yaml");
  procedure::SurgicalPlan plan;
  plan.tools = {{.diameter_m = 0.05}};
  procedure::Assessment assessment;
  assessment.min_wall_m = 0.01;
  assessment.cavity.coverage = 1.0;
  std::vector<session::SessionPass> passes(1);
  passes[0].number = 1;
  passes[0].to_go_mm = 0.0;
  const auto known = session::ScoreOfNow(plan, rubric, passes, assessment, true);
  const auto unknown = session::ScoreOfNow(plan, rubric, passes, assessment, false);
  EXPECT_TRUE(known.score.deductions.empty());
  ASSERT_EQ(unknown.score.deductions.size(), 1u);
  EXPECT_EQ(unknown.score.deductions[0].name, "breach (assumed)");
  EXPECT_LT(unknown.score.total, known.score.total);
  EXPECT_GE(known.open_points, 30.0) << "the axis is not known";
  // what needs the whole session's recordings is open to its end
  procedure::Rubric own = rubric;
  own.items.push_back({.metric = "tremor", .weight = 5.0, .full = 0.0, .zero = 1.0, .source = "a test"});
  const auto with_tremor = session::ScoreOfNow(plan, own, passes, assessment, true);
  EXPECT_TRUE(with_tremor.open.back());
  EXPECT_EQ(with_tremor.score.items.back().points, 0.0);
  EXPECT_EQ(with_tremor.score.total, known.score.total);
}

}  // namespace
}  // namespace osteon::studies
