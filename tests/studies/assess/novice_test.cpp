#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "base/units.h"
#include "config/reading/load_rubric.h"
#include "session/planning/planned_cell.h"
#include "session/procedure/prepare_session.h"
#include "session/run/cell_run.h"
#include "studies/assess/assess_result.h"
#include "tests/temporary_path.h"

// The two scripted hands of `osteon demo --plan`, here with the plan's last reamer only, for 8 s. With all
// four reamers, as in docs/procedure.md, the expert reaches 100 points and the novice 35.

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";

// Writes the shipped plan without its first three reamers.
fs::path WriteLastReamerPlan() {
  std::ifstream stream(kConfig / "plans/acetabulum.yaml");
  std::string plan, line;
  while (std::getline(stream, line)) {
    if (line.starts_with("scene: acetabulum"))
      line = "scene: " + (kConfig / "scenes/acetabulum.yaml").string();
    if (!line.starts_with("  - {diameter_mm: 4")) plan += line + "\n";
  }
  const fs::path file = TemporaryPath("last_reamer.yaml");
  std::ofstream(file) << plan;
  return file;
}

// Runs a session of a scripted hand as `osteon demo --plan … --virtual-time` does, and assesses it.
AssessedSession RunAssessedSession(const std::string& hand) {
  const fs::path cell = kConfig / "cells/demo.yaml";
  const session::ProcedureChoice choice{.plan = WriteLastReamerPlan(),
                                        .session = TemporaryPath("hand_" + hand),
                                        .hand = hand,
                                        .virtual_time = true};
  const auto procedure = session::OpenProcedure(choice, cell, std::nullopt);
  EXPECT_TRUE(procedure) << procedure.error();
  EXPECT_EQ(procedure->file.began, "") << "the same session of every run, whatever the clock says";
  session::ProcedureChoice by_the_clock = choice;
  by_the_clock.virtual_time = false;
  EXPECT_EQ(session::OpenProcedure(by_the_clock, cell, std::nullopt)->file.began.size(), 20u);
  auto setup = session::PrepareCell(cell, std::nullopt, procedure->tool);
  EXPECT_TRUE(setup) << setup.error();
  const session::EngineChoice engine_choice{.engine = "cpu"};
  EXPECT_TRUE(session::PackCell(*setup, {}, engine_choice, false));
  auto engine = session::MakeEngine(*setup, engine_choice);
  EXPECT_TRUE(engine) << engine.error();
  auto session =
      session::MakeSession(*procedure, choice, cell, {}, engine_choice, true, true, *setup, *engine);
  EXPECT_TRUE(session) << session.error();
  const auto run = session::RunCell(*setup, **engine,
                                    {.seconds = 8.0,
                                     .virtual_time = true,
                                     .recording = choice.session / procedure->recording,
                                     .procedure = session->get()});
  EXPECT_TRUE(run) << run.error().what;
  EXPECT_FALSE(run->faults.Any());
  auto assessed = ReadAssessedSession(choice.session);
  EXPECT_TRUE(assessed) << assessed.error();
  return std::move(*assessed);
}

TEST(NoviceAndExpert, DifferInScoreAxisAndForce) {
  const procedure::Rubric rubric = config::LoadRubric(kConfig / "rubrics/rubric.yaml");
  const auto score = [&](const AssessedSession& session) {
    return procedure::ScoreOf(rubric, procedure::ValuesOf(session.plan.plan, session.assessment),
                              session.assessment.min_wall_m)
        .total;
  };
  const AssessedSession expert = RunAssessedSession("expert"), novice = RunAssessedSession("novice");
  EXPECT_GT(score(expert), 85.0);
  EXPECT_LT(score(novice), score(expert) - 30.0);
  // the cutting time that the session counted while it ran is that of its recording
  for (const AssessedSession* session : {&expert, &novice})
    for (const PassFigures& pass : session->passes)
      EXPECT_NEAR(pass.figures.cutting_s, pass.pass.cutting_s, 0.01 * pass.pass.cutting_s)
          << pass.pass.number;
  EXPECT_LT(*procedure::AxisError(expert.plan.plan, expert.assessment), 0.5 * kDegree);
  EXPECT_NEAR(*procedure::AxisError(novice.plan.plan, novice.assessment), 14.0 * kDegree, kDegree);
  ASSERT_TRUE(expert.assessment.cavity.fit && novice.assessment.cavity.fit);
  const auto superior_offset_m = [](const AssessedSession& session) {  // offset from the plan's axis
    const procedure::SurgicalPlan& plan = session.plan.plan;
    const Vector3 off_m = Vector3(session.assessment.cavity.fit->centre_m) - plan.centre_m;
    return (off_m - off_m.dot(plan.axis_G) * plan.axis_G).dot(plan.pelvis.superior);
  };
  EXPECT_GT(superior_offset_m(novice), superior_offset_m(expert) + 0.5e-3);
  EXPECT_GT(novice.assessment.process.force_peak_N, 1.1 * expert.assessment.process.force_peak_N)
      << "140 N against the cell's own 120 N";
}

}  // namespace
}  // namespace osteon::studies
