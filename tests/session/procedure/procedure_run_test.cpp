// A procedure of two reamers on the simulated cell in virtual time: passes, change of tool, undo, resume,
// replay.

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/recording/recording_reader.h"
#include "safety/cell_state.h"
#include "session/procedure/procedure_panel.h"
#include "session/procedure/session_bone.h"
#include "session/replay/recorded_surface.h"
#include "session/replay/replay.h"
#include "session/setup/recorded_config.h"
#include "session/view/carved_keys.h"
#include "session/view/recorded_cut.h"
#include "session/view/recorded_procedure.h"
#include "simulation/engine/tool_change.h"
#include "simulation/files/carved_file.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/welded_surface.h"
#include "tests/session/procedure/procedure_rig.h"

namespace osteon::session {
namespace {

namespace fs = std::filesystem;
using safety::CellState;

// Expects that the state of each pass can be read from its file and has the hash in the session's file.
void ExpectStatesWhole(const fs::path& folder, const SessionFile& session, const simulation::Bone& bone) {
  for (const SessionPass& pass : session.passes) {
    const auto state = simulation::ReadCarvedState(folder / pass.state, bone);
    ASSERT_TRUE(state) << state.error().Text();
    EXPECT_EQ(HashText(*state), pass.state_hash) << pass.state;
  }
}

class ProcedureRun : public testing::Test {
 protected:
  // One run for several tests: two reamers, and a copy of the folder as it was after the first pass.
  static void SetUpTestSuite() {
    rig_ = new Rig("two_reamers", 14.0);
    rig_->params.progress = [](double) {
      const fs::path copy = TemporaryPath("killed");
      if (fs::exists(copy) || rig_->session->File().passes.empty()) return;
      fs::copy(rig_->folder, copy, fs::copy_options::recursive);
    };
    rig_->Run();
    auto read = io::ReadRecording(rig_->params.recording);
    ASSERT_TRUE(read) << read.error();
    recording_ = new io::Recording(std::move(*read));
  }
  static void TearDownTestSuite() {
    delete rig_;
    delete recording_;
  }
  static inline Rig* rig_ = nullptr;
  static inline io::Recording* recording_ = nullptr;
};

TEST_F(ProcedureRun, TheToolChangesInAPauseAndTheJointsStayBitEqual) {
  int changes = 0;
  for (std::size_t i = 1; i < recording_->ticks.size(); ++i) {
    const control::TickRecord &before = recording_->ticks[i - 1], &tick = recording_->ticks[i];
    if (tick.input.tool_index == before.input.tool_index) continue;
    ++changes;
    EXPECT_EQ(tick.q_cmd, before.q_cmd);
    EXPECT_EQ(before.cell_state, static_cast<std::uint8_t>(CellState::kPaused));
    const Vector3 step = Pose(tick.X_WT_cmd).translation() - Pose(before.X_WT_cmd).translation();
    EXPECT_NEAR(step.norm(), 0.001, 1e-9) << "the apex of 50 mm is 1 mm further than that of 48 mm";
  }
  EXPECT_EQ(changes, 1);
}

TEST_F(ProcedureRun, EachReamerLeavesAPassAndAState) {
  const auto session = ReadSession(rig_->folder);
  ASSERT_TRUE(session) << session.error();
  EXPECT_TRUE(session->ended);
  ASSERT_EQ(session->segments.size(), 2u);
  ASSERT_GE(session->passes.size(), 2u);
  EXPECT_EQ(session->passes.front().tool_index, 0);
  EXPECT_EQ(session->passes.back().tool_index, 1);
  for (const SessionPass& pass : session->passes) EXPECT_GT(pass.removed_mm3, 1.0);
  EXPECT_EQ(session->segments[0].end_state_hash, session->segments[1].begin_state_hash);
  EXPECT_EQ(session->segments[1].end_state_hash, HashText(rig_->result.after));
  ExpectStatesWhole(rig_->folder, *session, rig_->setup->bone);
}

TEST_F(ProcedureRun, ARunThatMadeAllItsToolChangesNamesNoneAsMissed) {
  EXPECT_TRUE(rig_->session->File().missed_changes.empty());
}

// 5 s are too short for two tools: the scripted hand moves on before the tool can be changed at rest.
TEST(ShortProcedureRun, ARunThatIsTooShortNamesTheToolChangeItMissed) {
  Rig rig("short_of_time", 5.0);
  rig.Run();
  const auto session = ReadSession(rig.folder);
  ASSERT_TRUE(session) << session.error();
  EXPECT_EQ(session->segments.back().tool_index, 0);
  ASSERT_EQ(session->missed_changes.size(), 1u);
  EXPECT_EQ(session->missed_changes[0].tool_index, 1);
  EXPECT_NE(session->missed_changes[0].reason, "");
}

// The simulated hand leads the tool along the plan's axis, which is the bone's +z, to 2 mm below the cup's
// centre.
TEST_F(ProcedureRun, ThePanelShowsToolPassesAndThePlaceAlongThePlan) {
  const auto plan = nlohmann::json::parse(rig_->session->PlanJson());
  EXPECT_EQ(plan["type"], "plan");
  ASSERT_EQ(plan["reamers"].size(), 2u);
  EXPECT_EQ(plan["reamers"][1]["diameter_mm"], 50.0);
  EXPECT_TRUE(plan["corridor"].is_null()) << "the plan has no guidance";
  const auto now = nlohmann::json::parse(rig_->session->PanelJson());
  EXPECT_EQ(now["type"], "procedure");
  EXPECT_TRUE(now["known"]);
  EXPECT_EQ(now["tool"], 1);
  EXPECT_EQ(now["passes"], rig_->session->File().PassesLeft());
  EXPECT_EQ(now["undone"], 0);
  EXPECT_TRUE(now["guidance"].is_null());
  EXPECT_GT(now["removed_mm3"], 1.0);
  EXPECT_LT(now["axis_error_deg"], 1.0);
  EXPECT_LT(now["tilt_deg"], 1.0);
  EXPECT_LT(now["aside_mm"], 1.0);
  const auto& last = recording_->ticks.back();
  const Pose X_GT = rig_->setup->X_WG.inverse() * Pose(last.X_WT_cmd);
  EXPECT_NEAR(now["to_go_mm"].get<double>(), 1e3 * (X_GT.translation().z() + 0.025 + 0.002), 0.5);
}

// Volume of the carved bone that a view shows at a recording's end [mm³].
double ViewedVolume(const fs::path& recording, const CellSetup& setup, const RecordedCut& cut) {
  const float voxel_mm = surface::VoxelFor(setup.config.tool.tool);
  CarvedBone bone(surface::FieldOfBone(setup.solid.get(), setup.bone, voxel_mm),
                  std::make_shared<const RecordedCut>(cut));
  auto timeline = RecordingTimeline::Open(recording);
  EXPECT_TRUE(timeline) << timeline.error();
  (void)timeline->Seek(0.0);
  for (auto topic = timeline->Next(); topic && *topic != io::RecordedTopic::kOther; topic = timeline->Next())
    bone.Take(*topic, *timeline);
  bone.CarveAll();
  return surface::VolumeOf(surface::WeldSurface(bone.field));
}

// Copies a folder to a new temporary one.
fs::path CopyOf(const fs::path& folder, const char* name) {
  const fs::path copy = TemporaryPath(name);
  fs::copy(folder, copy, fs::copy_options::recursive);
  return copy;
}

TEST_F(ProcedureRun, AViewCarvesWithTheReamerInUseAndOmitsUndonePasses) {
  const auto setup = PrepareRecordedCell(recording_->session, std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  const auto cut = ReadRecordedCut(rig_->params.recording, recording_->session, *setup);
  ASSERT_TRUE(cut) << cut.error();
  ASSERT_EQ((*cut)->tools.size(), 2u);
  EXPECT_FALSE((*cut)->earlier);
  const double viewed_mm3 = ViewedVolume(rig_->params.recording, *setup, **cut);
  const auto written =
      WriteRecordedSurface(rig_->params.recording, *setup, std::nullopt, TemporaryPath("bone.stl"));
  ASSERT_TRUE(written) << written.error();
  EXPECT_NEAR(viewed_mm3, written->figures.volume_mm3, 15.0) << "by the passes' own paths";
  const RecordedCut first_alone{.tools = {(*cut)->tools.front()}, .X_WG = (*cut)->X_WG};
  EXPECT_GT(ViewedVolume(rig_->params.recording, *setup, first_alone), viewed_mm3 + 50.0)
      << "the second reamer is larger";

  const fs::path folder = CopyOf(rig_->folder, "undone");
  std::ifstream stream(folder / kSessionFileName);
  auto json = nlohmann::json::parse(stream);
  json["passes"].back()["undone"] = true;
  std::ofstream(folder / kSessionFileName) << json;
  const auto without = ReadRecordedCut(folder / "run_1.mcap", recording_->session, *setup);
  ASSERT_TRUE(without) << without.error();
  ASSERT_EQ((*without)->undone.size(), 1u);
  EXPECT_GT(ViewedVolume(folder / "run_1.mcap", *setup, **without), viewed_mm3 + 50.0);
}

TEST_F(ProcedureRun, AViewShowsThePlanAndTheSessionsProgressAtAnyTime) {
  EXPECT_EQ(RecordedProcedure::Open(rig_->params.recording, recording_->session, rig_->setup->X_WG), nullptr)
      << "without the plan's file";
  const fs::path folder = CopyOf(rig_->folder, "viewed");
  std::ifstream shipped(OSTEON_SOURCE_DIR "/config/plans/acetabulum.yaml");
  std::ofstream plan(folder / "plan.yaml");
  for (std::string line; std::getline(shipped, line);)  // the demo's plan with this session's two reamers
    if (!line.starts_with("  - {diameter_mm: 44") && !line.starts_with("  - {diameter_mm: 46"))
      plan << line << "\n";
  plan.close();
  const auto procedure =
      RecordedProcedure::Open(folder / "run_1.mcap", recording_->session, rig_->setup->X_WG);
  ASSERT_NE(procedure, nullptr);
  EXPECT_EQ(nlohmann::json::parse(procedure->PlanJson()).at("reamers").size(), 2u);
  const int passes = rig_->session->File().PassesLeft();
  nlohmann::json end;
  for (const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
       std::chrono::steady_clock::now() < until; std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
    end = nlohmann::json::parse(procedure->Json(1e9));
    if (end.at("passes") == passes) break;
  }
  EXPECT_EQ(end.at("passes"), passes);
  EXPECT_EQ(end.at("tool"), 1);
  EXPECT_GT(end.at("removed_mm3"), 1.0);
  const auto begin = nlohmann::json::parse(procedure->Json(0.0));
  EXPECT_EQ(begin.at("passes"), 0);
  EXPECT_EQ(begin.at("tool"), 0);
}

// The tool is 4 mm above its planned centre, 0.5 mm aside, and tilted by 0.2 rad, of which the cone permits
// 0.14.
TEST(PlanPlace, IsMeasuredAlongThePlansAxisWithTheGuidancesLimits) {
  procedure::SurgicalPlan plan;
  plan.tools = {{.diameter_m = 0.044, .height_m = 3e-3}};
  plan.guidance.lateral = {.free_m = 1e-3, .stop_m = 3e-3, .widening_rad = 0.1, .ease_m = 0.5e-3};
  plan.guidance.cone.free_rad = 0.14;
  Pose X_GT = Pose::Identity();
  X_GT.linear() = ExpRotation(Vector3(3.141592653589793 - 0.2, 0, 0));
  X_GT.translation() = Vector3(0.5e-3, 0.0, 3e-3 + 4e-3) + 0.022 * X_GT.linear().col(2);
  const PlanPlace place = PlaceAlongPlan(plan, plan.tools[0], X_GT);
  EXPECT_NEAR(place.to_go_m, 4e-3, 1e-12);
  EXPECT_NEAR(place.aside_m, 0.5e-3, 1e-12);
  EXPECT_NEAR(place.tilt_rad, 0.2, 1e-12);
  EXPECT_TRUE(place.beyond_tilt);
  EXPECT_FALSE(place.beyond_aside);
  EXPECT_FALSE(place.beyond_depth);
}

TEST_F(ProcedureRun, TheLoopReplaysBitForBitWithItsToolTable) {
  const auto cell = LoadRecordedTools(recording_->session.config);
  ASSERT_TRUE(cell) << cell.error();
  ASSERT_EQ(cell->tools.size(), 2u);
  const ReplayResult replay = Replay(*recording_, cell->config, cell->tools, cell->list.first);
  EXPECT_TRUE(replay.identical) << replay.why_not
                                << (replay.first_difference ? replay.first_difference->field : "");
  EXPECT_EQ(replay.ticks, recording_->ticks.size());
  // the loop depends on the tool: a replay without the tool table differs
  const ReplayResult other = Replay(*recording_, cell->config);
  EXPECT_FALSE(other.identical);
}

// The folder was copied during the run, after the first pass, as a kill would leave it.
TEST_F(ProcedureRun, AKilledSessionResumesAtItsLastPass) {
  const fs::path copy = TemporaryPath("killed");
  const auto killed = ReadSession(copy);
  ASSERT_TRUE(killed) << killed.error();
  EXPECT_FALSE(killed->ended);
  ASSERT_EQ(killed->passes.size(), 1u);
  EXPECT_EQ(killed->segments.back().end_state_hash, "");
  Rig again("killed", 0.5, &*killed);
  const auto begun = again.session->Begin(*again.engine);
  ASSERT_TRUE(begun) << begun.error();
  EXPECT_EQ(HashText(again.engine->Snapshot()), killed->passes[0].state_hash);
  const SessionFile file = again.session->File();
  EXPECT_EQ(file.segments.size(), killed->segments.size() + 1);
  EXPECT_EQ(file.segments.back().begin_state, killed->passes[0].state);
  EXPECT_EQ(file.segments.back().recording, "run_2.mcap");
}

TEST_F(ProcedureRun, ASessionOfAnotherBoneIsRefused) {
  SessionFile file = rig_->session->File();
  file.bone_checksum = "0123456789abcdef";
  Rig other("other_bone", 1.0, &file);
  const auto begun = other.session->Begin(*other.engine);
  ASSERT_FALSE(begun);
  EXPECT_NE(begun.error().find("0123456789abcdef"), std::string::npos) << begun.error();
}

TEST(SessionBone, IsReadBackBitForBitAndADamagedFileIsRefused) {
  const fs::path folder = TemporaryPath("session_bone");
  fs::create_directories(folder);
  EXPECT_FALSE(ReadSessionBone(folder)) << "there is none";
  simulation::Bone bone;
  for (int i = 0; i < 100; ++i) {
    bone.balls.push_back({.center_m = {1e-3 / (i + 1.0), -0.1 * i, 1.0 / 3.0}, .radius_m = 1e-3 / (i + 7.0)});
    bone.points.push_back({.p_m = {0.1 * i, 1.0 / 7.0, -1e-9}, .volume_m3 = 1e-9 / (i + 3.0)});
    bone.points.back().material = static_cast<simulation::MaterialIndex>(i % 3);
  }
  ASSERT_TRUE(WriteSessionBone(folder, bone));
  const auto read = ReadSessionBone(folder);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->balls.size(), 100u);
  ASSERT_EQ(read->points.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(Vector3(read->balls[i].center_m), Vector3(bone.balls[i].center_m));
    EXPECT_EQ(read->balls[i].radius_m, bone.balls[i].radius_m);
    EXPECT_EQ(Vector3(read->points[i].p_m), Vector3(bone.points[i].p_m));
    EXPECT_EQ(read->points[i].volume_m3, bone.points[i].volume_m3);
    EXPECT_EQ(read->points[i].material, bone.points[i].material);
  }
  const fs::path file = folder / kSessionBoneName;
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(777).put('x');
  EXPECT_FALSE(ReadSessionBone(folder)) << "a byte differs";
  fs::resize_file(file, 500);
  EXPECT_FALSE(ReadSessionBone(folder)) << "cut short";
}

// Random requests in any state of the cell: a paused arm does not move, no fault occurs, and no saved state
// is replaced or lost.
TEST(ProcedureRequests, NoSequenceOfRequestsMovesThePausedArmOrLosesAState) {
  constexpr unsigned kSeed = 39;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  Rig rig("random_requests", 12.0);
  std::map<std::string, std::string> saved;  // hash by file
  int answers = 0, done = 0;
  base::OperatorRequests buttons;
  rig.params.requests = &buttons;
  control::JointArray held{};
  bool was_paused = false;
  rig.params.ticked = [&](const control::TickRecord& tick, const simulation::ContactModel&) {
    const bool paused = tick.cell_state == static_cast<std::uint8_t>(CellState::kPaused);
    if (paused && was_paused) {
      ASSERT_EQ(tick.q_cmd, held) << "tick " << tick.tick;
    }
    held = tick.q_cmd;
    was_paused = paused;
    if (random() % 150 != 0) return;
    using Kind = SessionRequest::Kind;
    const auto which = static_cast<unsigned>(random() % 9);
    if (which == 7) buttons.pause.store(true);
    if (which == 8) buttons.resume.store(true);
    if (which < 7) {
      const Kind kind = std::array{Kind::kNext, Kind::kTool,   Kind::kUndo, Kind::kSave,
                                   Kind::kCup,  Kind::kResume, Kind::kUndo}[which];
      (void)rig.session->Post({.kind = kind,
                               .diameter_mm = std::array{48.0, 50.0, 47.0, -1.0}[random() % 4],
                               .confirmed = random() % 2 == 0},
                              [&](const SessionAnswer& answer) {
                                ++answers;
                                done += answer.done ? 1 : 0;
                                EXPECT_EQ(answer.done, answer.reason.empty()) << answer.reason;
                              });
    }
    for (const SessionPass& pass : rig.session->File().passes) {
      const auto [known, is_new] = saved.try_emplace(pass.state, pass.state_hash);
      if (!is_new) {
        ASSERT_EQ(known->second, pass.state_hash) << "a saved state was replaced";
      }
    }
  };
  rig.Run();
  EXPECT_GT(answers, 20);
  EXPECT_GT(done, 5);
  ExpectStatesWhole(rig.folder, rig.session->File(), rig.setup->bone);
  const auto recording = io::ReadRecording(rig.params.recording);
  ASSERT_TRUE(recording) << recording.error();
  const auto cell = LoadRecordedTools(recording->session.config);
  ASSERT_TRUE(cell) << cell.error();
  EXPECT_TRUE(Replay(*recording, cell->config, cell->tools, cell->list.first).identical);
}

}  // namespace
}  // namespace osteon::session
