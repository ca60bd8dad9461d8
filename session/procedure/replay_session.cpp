#include "session/procedure/replay_session.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "io/recording/recording_reader.h"
#include "session/planning/planned_cell.h"
#include "session/planning/recorded_packing.h"
#include "session/procedure/session_bone.h"
#include "session/procedure/session_file.h"
#include "session/process/exit_code.h"
#include "session/replay/recarve.h"
#include "session/setup/cell_setup.h"
#include "session/setup/recorded_config.h"
#include "simulation/engine/state_hash.h"
#include "simulation/engine/tool_change.h"

namespace osteon::session {
namespace {

namespace fs = std::filesystem;

// The parts of a recording's cell that are made again for the replay.
struct Scene {
  CellSetup setup;
  std::vector<ProcedureTool> tools;
  int first_tool{0};
  EngineChoice engine;
};

// Makes cell, tools and packed bone of a session's recording again. @param file  path of the recording
tl::expected<Scene, std::string> SetUpScene(const io::Recording& recording, const fs::path& file,
                                            const SessionFile& session) {
  Scene scene;
  auto cell = LoadRecordedTools(recording.session.config);
  if (!cell) return tl::make_unexpected(cell.error());
  if (cell->tools.size() != session.diameters_mm.size())
    return tl::make_unexpected(fmt::format("found {} tools in the recording, accepted the session's {}",
                                           cell->tools.size(), session.diameters_mm.size()));
  const auto mesh = MeshOfSession(file);
  if (!mesh) return tl::make_unexpected(mesh.error());
  auto setup = SetUpRecorded(recording.session, *mesh);
  if (!setup) return tl::make_unexpected(setup.error());
  scene.setup = std::move(*setup);
  scene.setup.config = std::move(cell->config);
  scene.tools = std::move(cell->tools);
  scene.first_tool = cell->list.first;
  scene.engine = ChooseEngine(recording.session.engine, "");
  const auto packed = recording.session.packing ? PackAsRecorded(scene.setup, recording.session.packing)
                                                : PackCell(scene.setup, {}, scene.engine, false);
  if (!packed) return tl::make_unexpected(packed.error());
  return scene;
}

// Compares the engine's state with a saved one, and counts the comparison in `replay`.
// @param expected  hash of the saved state
void CompareState(const std::string& name, const std::string& expected,
                  const simulation::CuttingEngine& engine, SessionReplay& replay) {
  const std::string found = simulation::HashText(engine.Snapshot());
  ++replay.states;
  if (found == expected) return;
  ++replay.different_states;
  if (replay.first_different.empty())
    replay.first_different = fmt::format("{}: found {}, recorded {}", name, found, expected);
}

// Cuts a segment's frames again, from the state with which it began. @returns why that was not possible;
// empty: it was
std::string CutAgain(const io::Recording& recording, const SessionFile& session, int index,
                     const fs::path& folder, const Scene& scene, SessionReplay& replay) {
  const SessionSegment& segment = session.segments[static_cast<std::size_t>(index)];
  auto engine = MakeEngine(scene.engine, scene.setup.bone,
                           scene.tools[static_cast<std::size_t>(segment.tool_index)].tool, scene.setup.X_WG,
                           scene.setup.config.cutting);
  if (!engine) return engine.error();
  if (const std::string uncut = simulation::HashText((*engine)->Snapshot()); uncut != session.bone_checksum)
    return fmt::format("found a bone of {}, accepted the session's, {}: it was packed by other demands",
                       uncut, session.bone_checksum);
  if (!segment.begin_state.empty()) {
    auto state = ReadSessionState(folder, session, segment.begin_state, scene.setup.bone);
    if (!state) return state.error();
    (*engine)->Restore(simulation::WithoutContact(std::move(*state)));
  }
  Recarve recarve(**engine, scene.setup.config.servo.law);
  std::vector<SessionPass> passes;
  for (const SessionPass& pass : session.passes) {
    if (pass.segment != index) continue;
    if (const auto kept = ReadSessionState(folder, session, pass.state, scene.setup.bone); !kept)
      return kept.error();
    passes.push_back(pass);
  }
  std::size_t tick = 0, pass = 0;
  // compares the states of the passes that ended before a frame
  const auto end_passes = [&](rt::Nanoseconds next_stamp) {
    for (; pass < passes.size() && passes[pass].end < next_stamp; ++pass)
      CompareState(passes[pass].state, passes[pass].state_hash, **engine, replay);
  };
  for (const simulation::FrameRecord& frame : recording.frames) {
    const rt::Nanoseconds stamp = frame.model.pose_stamp;
    if (stamp < segment.begin || (segment.end != 0 && stamp > segment.end)) continue;
    end_passes(stamp);
    for (; tick < recording.ticks.size() &&
           (recording.ticks[tick].input.now <= stamp || recording.ticks[tick].input.arm_stamp <= stamp);
         ++tick)
      recarve.Add(recording.ticks[tick]);
    recarve.Add(frame);
  }
  // if the segment's end is not known, no further state is compared
  end_passes(segment.end == 0 ? 0 : segment.end + 1);
  if (segment.end != 0)
    CompareState(fmt::format("the end of segment {}", index + 1), segment.end_state_hash, **engine, replay);
  replay.frames += recarve.frames();
  return recarve.left_out() == 0 ? "" : fmt::format("{} frames have no tick", recarve.left_out());
}

nlohmann::ordered_json ToJson(const SessionReplay& replay, const std::string& wrong) {
  return {{"recording", replay.recording},
          {"ticks", replay.loop.ticks},
          {"loop_identical", replay.loop.identical},
          {"different_ticks", replay.loop.different_ticks},
          {"not_run_ticks", replay.loop.not_run},
          {"frames", replay.frames},
          {"states", replay.states},
          {"different_states", replay.different_states},
          {"reason", wrong.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(wrong)}};
}

}  // namespace

int RunReplaySession(const SessionReplayOptions& options) {
  const auto session = ReadSession(options.session);
  if (!session) return Fail("replay", session.error());
  std::vector<std::string> recordings;
  for (const SessionSegment& segment : session->segments)
    if (std::find(recordings.begin(), recordings.end(), segment.recording) == recordings.end() &&
        (segment.begin != 0 || HasBegun(options.session / segment.recording)))
      recordings.push_back(segment.recording);
  if (recordings.empty())
    return Fail("replay",
                fmt::format("{}: found no recording that was begun, accepted a session with one",
                            (options.session / kSessionFileName).string()),
                kFailed);
  bool identical = true;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  fmt::print("Osteon replay: session {}\n", options.session.string());
  for (const std::string& name : recordings) {
    SessionReplay replay{.recording = name, .loop = {}, .first_different = {}};
    const auto recording = io::ReadRecording(options.session / name);
    std::string wrong;
    if (!recording) {
      wrong = recording.error();
    } else if (auto scene = SetUpScene(*recording, options.session / name, *session); !scene) {
      wrong = scene.error();
    } else {
      replay.loop = Replay(*recording, scene->setup.config, scene->tools, scene->first_tool);
      for (std::size_t i = 0; i < session->segments.size() && wrong.empty(); ++i)
        if (session->segments[i].recording == name && session->segments[i].begin != 0)
          wrong = CutAgain(*recording, *session, static_cast<int>(i), options.session, *scene, replay);
    }
    const bool same = wrong.empty() && replay.loop.identical && replay.different_states == 0;
    identical &= same;
    fmt::print("  {:<18} {} ticks, {} frames, {} saved states: {}\n", name, replay.loop.ticks, replay.frames,
               replay.states, same ? "identical, bit for bit" : "not identical");
    if (replay.loop.first_difference)
      fmt::print("  {:<18} tick {}, {}: recorded {}, replayed {}\n", "First difference",
                 replay.loop.first_difference->tick, replay.loop.first_difference->field,
                 replay.loop.first_difference->recorded, replay.loop.first_difference->replayed);
    if (!replay.loop.why_not.empty()) fmt::print("  {:<18} {}\n", "Not run", replay.loop.why_not);
    if (!replay.first_different.empty()) fmt::print("  {:<18} {}\n", "Other state", replay.first_different);
    if (!wrong.empty()) fmt::print("  {:<18} {}\n", "Reason", wrong);
    if (recording && !recording->complete) fmt::print("  {:<18} {}\n", "Not whole", recording->end_error);
    rows.push_back(ToJson(replay, wrong));
  }
  if (!options.json.empty()) {
    const nlohmann::ordered_json json{{"schema", "osteon.replay_session/1"},
                                      {"session", options.session.string()},
                                      {"identical", identical},
                                      {"recordings", std::move(rows)}};
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return Fail("replay", written.error());
  }
  return identical ? 0 : kFailed;
}

}  // namespace osteon::session
