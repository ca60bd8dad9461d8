#include "studies/assess/assess_result.h"

#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "config/reading/strict/config_error.h"
#include "io/recording/recording_reader.h"
#include "session/planning/planned_cell.h"
#include "session/procedure/session_bone.h"
#include "session/run/cell_run.h"
#include "simulation/files/carved_file.h"
#include "studies/assess/assess_page.h"
#include "tests/io/temporary_folder.h"

// Tests `osteon assess` on a session that the test makes in virtual time: the demo's scripted operator reams
// the demo's cup with the plan's last reamer.

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";

std::string ReadAll(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Makes FOLDER/session.json with its recording and its last state.
void MakeSession(const fs::path& folder) {
  fs::create_directories(folder);
  const std::string plan = [] {
    std::string text = ReadAll(kConfig / "plans/acetabulum.yaml");
    const std::string scene = "scene: acetabulum";
    return text.replace(text.find(scene), scene.size(),
                        "scene: " + (kConfig / "scenes/acetabulum.yaml").string());
  }();
  std::ofstream(folder / "plan.yaml") << plan;
  auto setup = session::PrepareCell(kConfig / "cells/demo.yaml", std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  const session::EngineChoice choice{.engine = "cpu"};
  ASSERT_TRUE(session::PackCell(*setup, {}, choice, false));
  auto engine = session::MakeEngine(*setup, choice);
  ASSERT_TRUE(engine) << engine.error();
  const auto run = session::RunCell(
      *setup, **engine, {.seconds = 6.0, .virtual_time = true, .recording = folder / "run_1.mcap"});
  ASSERT_TRUE(run) << run.error().what;
  ASSERT_TRUE(simulation::WriteCarvedState(folder / "state_1.carved", run->after, setup->bone));
  ASSERT_TRUE(session::WriteSessionBone(folder, setup->bone));
  const auto recording = io::ReadRecording(folder / "run_1.mcap");
  ASSERT_TRUE(recording) << recording.error();
  const rt::Nanoseconds end = recording->frames.back().model.pose_stamp;

  session::SessionFile file;
  file.cell = "demo";
  file.plan_checksum = session::TextChecksum(plan);
  file.cell_checksum = session::TextChecksum("");
  file.bone_checksum = fmt::format("{:016x}", 0);
  file.scene = "acetabulum";
  file.tool = "reamer";
  file.diameters_mm = {44.0, 46.0, 48.0, 50.0};
  file.clock = "virtual";
  file.gains.law = "admittance";
  file.ended = true;
  const std::string hash = fmt::format("{:016x}", simulation::HashState(run->after));
  file.segments = {{.tool_index = 3,
                    .recording = "run_1.mcap",
                    .begin = 0,
                    .end = end,
                    .begin_state = "",
                    .begin_state_hash = file.bone_checksum,
                    .end_state = "state_1.carved",
                    .end_state_hash = hash}};
  file.passes = {{.number = 1,
                  .segment = 0,
                  .tool_index = 3,
                  .begin = 0,
                  .end = end,
                  .removed_mm3 = 1e9 * run->after.removed_volume_m3,
                  .state = "state_1.carved",
                  .state_hash = hash,
                  .to_go_mm = 0.0}};
  ASSERT_TRUE(session::WriteSession(folder, file));
}

class Assess : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<io::test::TemporaryFolder>();
    MakeSession(folder_->path() / "session_1");
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static fs::path Session() { return folder_->path() / "session_1"; }
  // Copies the session and lets `change` edit the copy's session.json.
  template <class Change>
  static fs::path CopyWith(const char* name, const Change& change) {
    const fs::path copy = folder_->path() / name;
    fs::copy(Session(), copy);
    auto file = session::ReadSession(copy);
    EXPECT_TRUE(file);
    change(*file);
    EXPECT_TRUE(session::WriteSession(copy, *file));
    return copy;
  }
  static AssessOptions Options() { return {.session = Session(), .rubric = kConfig / "rubrics/rubric.yaml"}; }

  static std::unique_ptr<io::test::TemporaryFolder> folder_;
};
std::unique_ptr<io::test::TemporaryFolder> Assess::folder_;

TEST(ValueText, RoundsEachMetricToAReadablePrecision) {
  const auto text = [](double si, const char* metric) {
    return ValueText(si, procedure::MetricNamed(metric));
  };
  EXPECT_EQ(text(0.00002, "axis_error"), "0.0°");
  EXPECT_EQ(text(0.2479, "axis_error"), "14.2°");
  EXPECT_EQ(text(1.45e-6, "diameter_error"), "0.00 mm");
  EXPECT_EQ(text(1.363e-3, "superior_shift"), "1.36 mm");
  EXPECT_EQ(text(0.3323, "coverage"), "33.2 %");
  EXPECT_EQ(text(309.4e-9, "under_reamed"), "309 mm³");
  EXPECT_EQ(text(2.43e-9, "over_reamed"), "2.4 mm³");
  EXPECT_EQ(text(12.34, "time"), "12.3 s");
}

TEST_F(Assess, MeasuresWhatTheScriptedOperatorReamed) {
  const auto session = ReadAssessedSession(Session());
  ASSERT_TRUE(session) << session.error();
  const procedure::Assessment& found = session->assessment;
  ASSERT_TRUE(found.cavity.fit) << found.cavity.fit_refused;
  EXPECT_NEAR(2e3 * found.cavity.fit->radius_m, 50.0, 0.3);
  EXPECT_NEAR(1e3 * found.cavity.from_plan.medial_m, 0.0, 3.0);
  ASSERT_TRUE(procedure::AxisError(session->plan.plan, found));
  EXPECT_LT(*procedure::AxisError(session->plan.plan, found), 0.1)
      << "the script points along the cup's axis";
  EXPECT_NEAR(found.cavity.removed_m3, 1e-9 * session->passes.front().pass.removed_mm3,
              1e-3 * found.cavity.removed_m3);
  EXPECT_NEAR(found.process.time_s, 6.0, 0.1);
  EXPECT_GT(found.process.cutting_s, 0.5);
  EXPECT_LT(found.process.cutting_s, 6.0);
  EXPECT_NEAR(found.process.force_peak_N, 120.0, 15.0) << "the script pushes with 120 N";
  EXPECT_EQ(session->tools[3].passes, 1);
  EXPECT_EQ(session->tools[0].figures.time_s, 0.0);
  ASSERT_TRUE(found.min_wall_m);
  EXPECT_NEAR(1e3 * *found.min_wall_m, 15.0, 1.0);
}

TEST_F(Assess, WithoutTheStoredBoneTheSameBoneIsPacked) {
  const fs::path copy = folder_->path() / "without_bone";
  fs::copy(Session(), copy);
  fs::remove(copy / session::kSessionBoneName);
  const auto kept = ReadAssessedSession(Session()), packed = ReadAssessedSession(copy);
  ASSERT_TRUE(kept && packed);
  ASSERT_EQ(kept->bone.balls.size(), packed->bone.balls.size());
  ASSERT_EQ(kept->bone.materials.size(), packed->bone.materials.size());
  EXPECT_EQ(Vector3(kept->bone.site.axis), Vector3(packed->bone.site.axis));
  EXPECT_EQ(procedure::ValuesOf(kept->plan.plan, kept->assessment),
            procedure::ValuesOf(packed->plan.plan, packed->assessment));
  fs::remove_all(copy);
}

TEST_F(Assess, WritesPageAndResultAndExitsByTheScore) {
  AssessOptions options = Options();
  ASSERT_EQ(RunAssess(options), 0);
  const auto json = nlohmann::json::parse(ReadAll(Session() / "assess.json"));
  EXPECT_EQ(json["schema"], "osteon.assess/1");
  for (const char* key : {"plan", "result", "process", "score", "guided", "norms"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["guided"], false);
  double points = 0.0;
  for (const auto& item : json["score"]["items"]) points += item["points"].get<double>();
  EXPECT_NEAR(json["score"]["total"].get<double>(), points, 1e-9);
  EXPECT_EQ(json["process"]["by_tool"].size(), 4u);
  const std::string page = ReadAll(Session() / "assess.html");
  for (const char* words : {"without guidance", "Coronal section", "Axial section", "The planned hemisphere",
                            "The session", "Assumptions", "PMC3261258", "Bone left (under-reamed)",
                            "mm³ that the plan takes away are still there", "as much as a layer of",
                            "the last reamer came to its planned depth", "shown only"})
    EXPECT_NE(page.find(words), std::string::npos) << words;

  options.pass_at = json["score"]["total"].get<double>() + 0.01;
  EXPECT_EQ(RunAssess(options), 1);
  options.pass_at = json["score"]["total"].get<double>() - 0.01;
  EXPECT_EQ(RunAssess(options), 0);
}

TEST_F(Assess, ASessionAsItsOwnNormGivesItsFiguresAsMedians) {
  AssessOptions options = Options();
  options.norms = {Session()};
  ASSERT_EQ(RunAssess(options), 0);
  const auto json = nlohmann::json::parse(ReadAll(Session() / "assess.json"));
  EXPECT_EQ(json["norms"]["path"]["sessions"], 1);
  EXPECT_EQ(json["norms"]["path"]["median"], json["process"]["path_mm"]);
  EXPECT_EQ(json["norms"]["coverage"]["median"], json["result"]["coverage"]);
}

TEST_F(Assess, NormsThatAreUnfinishedOrGuidedDifferentlyAreRefused) {
  const fs::path guided =
      CopyWith("guided", [](session::SessionFile& file) { file.segments.front().guidance_gain = 0.5; });
  const fs::path unfinished =
      CopyWith("unfinished", [](session::SessionFile& file) { file.passes.front().to_go_mm = 1.4; });
  const auto norms = ReadNorms({Session(), guided}, false);
  ASSERT_FALSE(norms);
  EXPECT_EQ(norms.error().find("--norms " + guided.string() +
                               ": found a session with guidance (gain 0.5), accepted sessions without"),
            0u)
      << norms.error();
  EXPECT_TRUE(ReadNorms({guided}, true));
  EXPECT_FALSE(ReadNorms({Session()}, true));
  const auto short_of_it = ReadNorms({unfinished}, false);
  ASSERT_FALSE(short_of_it);
  EXPECT_NE(short_of_it.error().find("not finished (its last tool stopped 1.4 mm short"), std::string::npos)
      << short_of_it.error();
  AssessOptions options = Options();
  options.norms = {unfinished};
  EXPECT_EQ(RunAssess(options), 2);
  fs::remove_all(guided);
  fs::remove_all(unfinished);
}

TEST_F(Assess, AGuidedSessionBesideAnUnguidedOneIsMarkedAndNotRanked) {
  const fs::path guided =
      CopyWith("helped", [](session::SessionFile& file) { file.segments.front().guidance_gain = 0.5; });
  AssessOptions options = Options();
  options.against = guided;
  testing::internal::CaptureStdout();
  ASSERT_EQ(RunAssess(options), 0);
  const std::string printed = testing::internal::GetCapturedStdout();
  for (const char* words : {"(without guidance)", "(helped, with guidance (gain 0.5))",
                            "Not to be ranked: session_1 was reamed "}) {
    EXPECT_NE(printed.find(words), std::string::npos) << words << "\n" << printed;
  }
  const std::string page = ReadAll(Session() / "compare.html");
  for (const char* words : {"<strong>Not to be ranked: session_1 was reamed without guidance, helped with",
                            ">with guidance (gain 0.5)</text>", ">without guidance</text>",
                            "<td>guidance</td><td>without guidance</td><td>with guidance (gain 0.5)</td>"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  fs::remove_all(guided);
}

TEST_F(Assess, TheTrendShowsEarlierSessionsOfTheSamePlanOnly) {
  ASSERT_EQ(RunAssess(Options()), 0);
  const fs::path other = folder_->path() / "session_0";
  fs::create_directories(other);
  auto json = nlohmann::ordered_json::parse(ReadAll(Session() / "assess.json"));
  json["score"]["total"] = 12.5;
  std::ofstream(other / "assess.json") << json;
  ASSERT_EQ(RunAssess(Options()), 0);
  EXPECT_NE(ReadAll(Session() / "assess.html").find("<h2>Trend</h2>"), std::string::npos);
  json["plan"]["checksum"] = "another";
  std::ofstream(other / "assess.json") << json;
  ASSERT_EQ(RunAssess(Options()), 0);
  EXPECT_EQ(ReadAll(Session() / "assess.html").find("<h2>Trend</h2>"), std::string::npos);
  fs::remove_all(other);
}

// The trend finds results in the folders beside the session's folder, even if each session's folder is called
// "session", as in the demo.
TEST_F(Assess, TheTrendIsOrderedByStartTimeOrByNumbersInNames) {
  ASSERT_EQ(RunAssess(Options()), 0);
  auto json = nlohmann::ordered_json::parse(ReadAll(Session() / "assess.json"));
  const fs::path around = folder_->path() / "trainee";
  const auto add = [&](const fs::path& folder, double score, const char* began) {
    fs::create_directories(folder);
    auto other = json;
    other["score"]["total"] = score;
    other["began"] = *began != '\0' ? nlohmann::ordered_json(began) : nlohmann::ordered_json();
    std::ofstream(folder / "assess.json") << other;
  };
  const fs::path own = around / "try_2" / "session";
  fs::create_directories(around / "try_2");
  fs::copy(Session(), own);
  add(around / "try_10" / "session", 50.0, "");
  add(around / "try_1" / "session", 40.0, "2026-11-29T09:30:00Z");
  const auto names = [&](const std::vector<fs::path>& named) {
    AssessOptions options = Options();
    options.session = own;
    options.trend = named;
    EXPECT_EQ(RunAssess(options), 0);
    std::string text;
    const nlohmann::json written = nlohmann::json::parse(ReadAll(own / "assess.json"));
    for (const auto& point : written.at("trend")) text += point["session"].get<std::string>() + " ";
    return text;
  };
  EXPECT_EQ(names({}), "try_1 try_2 try_10 ");
  const std::string table = ReadAll(own / "trend.csv");
  EXPECT_EQ(table.find("session,began,score,guided,finished\ntry_1,2026-11-29T09:30:00Z,40.00,false,true\n"),
            0u)
      << table;
  add(around / "try_10" / "session", 50.0, "2026-11-28T09:30:00Z");
  auto file = session::ReadSession(own);
  ASSERT_TRUE(file);
  file->began = "2026-11-30T09:30:00Z";
  ASSERT_TRUE(session::WriteSession(own, *file));
  EXPECT_EQ(names({}), "try_10 try_1 try_2 ");
  add(folder_->path() / "elsewhere" / "a" / "session", 60.0, "2026-12-01T09:30:00Z");
  EXPECT_EQ(names({folder_->path() / "elsewhere" / "a" / "session"}), "try_10 try_1 try_2 a ");
  AssessOptions options = Options();
  options.trend = {folder_->path() / "elsewhere"};
  EXPECT_EQ(RunAssess(options), 2) << "no result there";
  fs::remove_all(around);
  fs::remove_all(folder_->path() / "elsewhere");
}

TEST_F(Assess, ThePageShowsTheCorridorAndPublishedShifts) {
  ASSERT_EQ(RunAssess(Options()), 0);
  const std::string page = ReadAll(Session() / "assess.html");
  for (const char* words : {"corridor, free", "corridor, the spindle stops", "class=\"panel\" data-area",
                            "medial shift, as published", "PMID 27909120"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  const auto json = nlohmann::json::parse(ReadAll(Session() / "assess.json"));
  EXPECT_EQ(json["published"][0]["shift"], "medial");
  EXPECT_EQ(json["published"][0]["value_mm"], json["result"]["shift_from_native"]["medial_mm"]);
  EXPECT_EQ(json["published"][0]["standard_reaming"]["mean_mm"], 5.0);
}

TEST_F(Assess, ComparesASecondSessionOfTheSamePlanOnly) {
  const fs::path second = folder_->path() / "second", other_plan = folder_->path() / "other_plan";
  fs::copy(Session(), second);
  AssessOptions options = Options();
  options.against = second;
  ASSERT_EQ(RunAssess(options), 0);
  const std::string page = ReadAll(Session() / "compare.html");
  for (const char* words : {"session_1", "second", "coronal", "into the opening", "axis error", "tremor"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  EXPECT_EQ(ReadAll(Session() / "compare.png").substr(1, 3), "PNG");

  fs::copy(Session(), other_plan);
  std::string plan = ReadAll(other_plan / "plan.yaml") + "# another\n";
  std::ofstream(other_plan / "plan.yaml") << plan;
  auto file = session::ReadSession(other_plan);
  ASSERT_TRUE(file);
  file->plan_checksum = session::TextChecksum(plan);
  ASSERT_TRUE(session::WriteSession(other_plan, *file));
  options.against = other_plan;
  EXPECT_EQ(RunAssess(options), 2);
  fs::remove_all(second);
  fs::remove_all(other_plan);
}

TEST(AssessUnfinished, APlanIsFinishedByAPassOfItsLastToolAtItsDepth) {
  procedure::SurgicalPlan plan;
  plan.tools = {{.diameter_m = 0.048}, {.diameter_m = 0.050}};
  std::vector<session::SessionPass> passes(2);
  passes[0].to_go_mm = 0.0;
  EXPECT_EQ(UnfinishedOf(plan, {}).text, "no pass of its last tool, 50 mm, counts");
  EXPECT_TRUE(UnfinishedOf(plan, passes).by_a_tool) << "two passes of the first tool";
  passes[1].tool_index = 1;
  passes[1].to_go_mm = 0.9;
  EXPECT_EQ(UnfinishedOf(plan, passes).text, "");
  passes[1].to_go_mm = 1.4;
  EXPECT_NE(UnfinishedOf(plan, passes).text.find("1.4 mm short"), std::string::npos);
  EXPECT_FALSE(UnfinishedOf(plan, passes).by_a_tool);
  passes[1].to_go_mm.reset();
  EXPECT_NE(UnfinishedOf(plan, passes).text.find("not in session.json"), std::string::npos);
  EXPECT_FALSE(UnfinishedOf(plan, passes).by_a_tool);
  passes[1].undone = true;
  EXPECT_TRUE(UnfinishedOf(plan, passes).by_a_tool);
}

// A torn recording must not improve a session's score: the gap is reported and the session does not pass.
TEST_F(Assess, AnIncompleteRecordingIsReportedAndNeverPasses) {
  const fs::path copy = folder_->path() / "torn";
  fs::copy(Session(), copy);
  const auto whole = ReadAssessedSession(copy);
  ASSERT_TRUE(whole) << whole.error();
  EXPECT_EQ(whole->missing, "");
  AssessOptions options = Options();
  options.session = copy;
  options.pass_at = 1.0;
  EXPECT_EQ(RunAssess(options), 0);
  fs::resize_file(copy / "run_1.mcap", fs::file_size(copy / "run_1.mcap") / 2);
  const auto torn = ReadAssessedSession(copy);
  ASSERT_TRUE(torn) << torn.error();
  EXPECT_EQ(torn->missing.find("of pass 1 run_1.mcap holds "), 0u) << torn->missing;
  EXPECT_EQ(RunAssess(options), 1);
  const auto json = nlohmann::json::parse(ReadAll(copy / "assess.json"));
  EXPECT_EQ(json.at("recordings_whole"), false);
  EXPECT_EQ(json.at("passed"), false);
  EXPECT_EQ(json.at("finished"), true);
  fs::remove_all(copy);
}

TEST_F(Assess, AStateWithAnotherHashIsRefused) {
  const fs::path copy = folder_->path() / "other_state";
  fs::copy(Session(), copy);
  auto file = session::ReadSession(copy);
  ASSERT_TRUE(file) << file.error();
  const std::string hash = std::exchange(file->passes.front().state_hash, "0123456789abcdef");
  ASSERT_TRUE(session::WriteSession(copy, *file));
  const auto other = ReadAssessedSession(copy);
  ASSERT_FALSE(other);
  EXPECT_NE(
      other.error().find("state_1.carved: found a state of " + hash + ", accepted that of 0123456789abcdef"),
      std::string::npos)
      << other.error();
  fs::remove_all(copy);
}

TEST_F(Assess, AChangedPlanIsRefused) {
  const fs::path copy = folder_->path() / "changed";
  fs::copy(Session(), copy);
  std::ofstream(copy / "plan.yaml", std::ios::app) << "# changed\n";
  const auto session = ReadAssessedSession(copy);
  ASSERT_FALSE(session);
  EXPECT_NE(session.error().find("the plan was changed"), std::string::npos) << session.error();
  fs::remove_all(copy);
}

TEST_F(Assess, AFolderWithoutASessionIsRefused) { EXPECT_FALSE(ReadAssessedSession(folder_->path())); }

}  // namespace
}  // namespace osteon::studies
