// Compares the score that the console shows during a session with `osteon assess` of the same passes.

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

// Writes a plan with the last two reamers of the shipped plan only, for a shorter session.
fs::path WriteTwoReamerPlan() {
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

// The score shown after this many passes.
struct ShownScore {
  std::size_t passes;
  nlohmann::json score;
};

// Runs a session in `folder` and returns the score shown at its start and after each pass.
std::vector<ShownScore> RunSession(const fs::path& folder) {
  const fs::path cell = kConfig / "cells/demo.yaml";
  const session::ProcedureChoice choice{
      .plan = WriteTwoReamerPlan(), .session = folder, .hand = "expert", .virtual_time = true};
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
  std::vector<ShownScore> said{{0, nlohmann::json::parse(running.ScoreJson())}};
  const auto store_new_score = [&] {
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
                          if (tick.tick % 10 == 0) store_new_score();
                        }});
  EXPECT_TRUE(run) << run.error().what;
  store_new_score();
  return said;
}

// A copy of the session's folder that ends after its first `passes` passes.
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

TEST(LiveScore, EqualsTheAssessmentsScoreExceptForOpenItems) {
  const fs::path folder = TemporaryPath("live_score");
  const std::vector<ShownScore> all = RunSession(folder);
  ASSERT_GE(all.size(), 3u) << "a pass of each reamer";
  EXPECT_EQ(all.front().score.at("known"), false);
  EXPECT_EQ(all.front().score.at("why"), "");
  const procedure::Rubric rubric = config::LoadRubric(kConfig / "rubrics/rubric.yaml");
  for (const ShownScore& said : all) {
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
  // most items depend on the last reamer: they stay open until this reamer has cut
  const nlohmann::json &first = all[1].score, &last = all.back().score;
  EXPECT_TRUE(ItemOf(first, "axis_error").at("open"));
  EXPECT_TRUE(ItemOf(first, "diameter_error").at("open"));
  EXPECT_FALSE(ItemOf(first, "over_reamed").at("open")) << "bone that is gone does not come back";
  EXPECT_NE(first.at("unfinished"), "");
  EXPECT_FALSE(ItemOf(last, "axis_error").at("open"));
  EXPECT_EQ(last.at("open_points"), 0.0);
  EXPECT_GT(last.at("total"), 85.0);
}

// After a session is resumed, the thinnest wall of earlier passes is not known, so the score assumes a
// breach.
TEST(LiveScore, AssumesABreachForPassesOfAnEarlierProcess) {
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
  // a metric that needs the recordings of the whole session stays open until the session ends
  procedure::Rubric own = rubric;
  own.items.push_back({.metric = "tremor", .weight = 5.0, .full = 0.0, .zero = 1.0, .source = "a test"});
  const auto with_tremor = session::ScoreOfNow(plan, own, passes, assessment, true);
  EXPECT_TRUE(with_tremor.open.back());
  EXPECT_EQ(with_tremor.score.items.back().points, 0.0);
  EXPECT_EQ(with_tremor.score.total, known.score.total);
}

}  // namespace
}  // namespace osteon::studies
