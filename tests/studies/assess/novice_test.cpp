#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "base/units.h"
#include "config/reading/load_rubric.h"
#include "session/run/demo.h"
#include "studies/assess/assess_result.h"
#include "tests/temporary_path.h"

// The two scripted hands of `osteon demo --plan`, with the plan's last reamer alone and for a short time.
// With all four reamers and the commands of docs/procedure.md the expert has 100 points and the novice 35.

namespace osteon::app {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";

// The shipped plan without its first three reamers.
fs::path LastReamerAlone() {
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

AssessedSession SessionOf(const std::string& hand) {
  const fs::path out = TemporaryPath("hand_" + hand);
  const DemoOptions options{.seconds = 8.0,
                            .out = out,
                            .cell = kConfig / "cells/demo.yaml",
                            .procedure = {.plan = LastReamerAlone(), .hand = hand},
                            .virtual_time = true,
                            .engine = "cpu",
                            .console = {.on = false}};
  EXPECT_EQ(RunDemo(options), 0);
  auto session = ReadAssessedSession(out / "session");
  EXPECT_TRUE(session) << session.error();
  return std::move(*session);
}

TEST(NoviceAndExpert, AreToldApart) {
  const procedure::Rubric rubric = config::LoadRubric(kConfig / "rubrics/rubric.yaml");
  const auto score = [&](const AssessedSession& session) {
    return procedure::ScoreOf(rubric, procedure::ValuesOf(session.plan.plan, session.assessment),
                              session.assessment.min_wall_m)
        .total;
  };
  const AssessedSession expert = SessionOf("expert"), novice = SessionOf("novice");
  EXPECT_GT(score(expert), 85.0);
  EXPECT_LT(score(novice), score(expert) - 30.0);
  EXPECT_LT(*procedure::AxisError(expert.plan.plan, expert.assessment), 0.5 * kDegree);
  EXPECT_NEAR(*procedure::AxisError(novice.plan.plan, novice.assessment), 14.0 * kDegree, kDegree);
  ASSERT_TRUE(expert.assessment.cavity.fit && novice.assessment.cavity.fit);
  EXPECT_GT(novice.assessment.cavity.from_plan.superior_m,
            expert.assessment.cavity.from_plan.superior_m + 0.5e-3)
      << "it aims aside, toward superior";
  EXPECT_GT(novice.assessment.process.force_peak_N, 2.0 * expert.assessment.process.force_peak_N);
}

}  // namespace
}  // namespace osteon::app
