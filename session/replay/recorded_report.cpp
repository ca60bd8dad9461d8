#include "session/replay/recorded_report.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/phase_progress.h"
#include "base/write_text.h"
#include "console/stream/live_window.h"
#include "io/recording/recording_reader.h"
#include "safety/cell_state.h"
#include "session/planning/planned_cell.h"
#include "session/planning/recorded_packing.h"
#include "session/procedure/session_bone.h"
#include "session/procedure/session_cut.h"
#include "session/process/exit_code.h"
#include "session/replay/recarve.h"
#include "session/replay/recorded_surface.h"
#include "session/replay/recorded_zones.h"
#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "session/setup/recorded_config.h"
#include "session/stops/stop_records.h"
#include "session/summary/chart_files.h"
#include "session/summary/each_fault.h"
#include "session/summary/run_accumulator.h"
#include "session/summary/run_files.h"
#include "session/summary/run_report.h"
#include "session/summary/summary.h"
#include "simulation/bone/scene_events.h"
#include "simulation/engine/tool_change.h"

namespace osteon::session {
namespace {

// Adds a tick to the loop's peak values. The peak power into the hand is missing: it is not recorded.
void UpdatePeaks(const control::TickRecord& tick, control::ServoStatistics& peaks) {
  const auto keep = [](double& peak, double value) { peak = std::max(peak, value); };
  if (tick.session_state != static_cast<std::uint8_t>(control::SessionState::kCommandingActive)) return;
  if (tick.phase != control::Phase::kWaiting && tick.phase != control::Phase::kAligning) ++peaks.active_ticks;
  keep(peaks.peak_coupling_force_N, console::Length(tick.F_coupling_T_W.f));
  keep(peaks.peak_coupling_torque_Nm, console::Length(tick.F_coupling_T_W.t));
  keep(peaks.peak_sensor_force_N, console::Length(tick.F_operator_T_W.f));
  keep(peaks.peak_tool_speed_m_per_s, console::Length(tick.v_WT_cmd_m_per_s));
  keep(peaks.peak_measured_tool_speed_m_per_s, tick.tool_speed_meas_m_per_s);
  keep(peaks.peak_tool_in_bone_m, tick.tool_in_bone_m);
  if (safety::Renders(static_cast<safety::CellState>(tick.cell_state)))
    peaks.min_tank_J = std::min(peaks.min_tank_J, tick.tank_J);
}

// Finds how a run ended, from its faults and its last event.
control::RunEnd EndOf(safety::FaultSet faults, const std::string& end, bool rendered) {
  if (faults.Any()) return control::RunEnd::kFault;
  if (!rendered) return control::RunEnd::kNeverActive;
  const bool by_time = end.find("of rendering were over") != std::string::npos;
  return by_time ? control::RunEnd::kSeconds : control::RunEnd::kStopFlag;
}

// Returns the folder that contains the recording.
std::filesystem::path FolderOf(const std::filesystem::path& recording) {
  return recording.has_parent_path() ? recording.parent_path() : std::filesystem::path(".");
}

// Contents of a recording for the report. If the recording belongs to no session, they include the results of
// cutting the bone again.
struct RecordedRunData {
  RunAccumulator run;
  CellRunResult result;
  double seconds{0.0};  ///< time between the first and the last commanded tick
  RecutFigures recut{};
  std::unique_ptr<simulation::CuttingEngine> coarser{};  ///< engine after the last coarsening; null: none
};

/// The session that a recording belongs to, up to the recording's end, with its tools.
struct RecordedSession {
  SessionFile file;
  RecordedCell cell;
};

// Finds the session of a recording of several tools, because its report needs the session's saved states.
// @returns nothing if the recording is of one tool
tl::expected<std::optional<RecordedSession>, std::string> FindRecordedSession(
    const std::filesystem::path& recording, const io::SessionInfo& info) {
  auto cell = LoadRecordedTools(info.config);
  if (!cell) return tl::unexpected(recording.string() + ": " + cell.error());
  if (cell->tools.size() < 2) return std::optional<RecordedSession>();
  auto session = FindSessionOf(recording);
  if (!session)
    return tl::unexpected(
        fmt::format("{}: found a recording of {} tools without its session, accepted one in "
                    "the session's folder, beside {}",
                    recording.string(), cell->tools.size(), kSessionFileName));
  return RecordedSession{.file = SessionUpTo(std::move(*session), recording.filename().string()),
                         .cell = std::move(*cell)};
}

// Finds the events that say how zones were coarsened; returns none if the plan did not time frames.
tl::expected<std::vector<io::RecordedEvent>, std::string> FindCoarsenedZones(
    const std::filesystem::path& path) {
  auto stream = io::RecordingStream::Open(path);
  if (!stream) return tl::unexpected(stream.error());
  std::vector<io::RecordedEvent> changes;
  while (true) {
    const auto topic = stream->Next();
    if (!topic) return tl::unexpected(topic.error());
    if (*topic == io::RecordedTopic::kOther) return changes;
    if (*topic == io::RecordedTopic::kSession && !(stream->session.packing && stream->session.packing->timed))
      return changes;
    if (*topic == io::RecordedTopic::kEvent && stream->event.packing) changes.push_back(stream->event);
  }
}

/// Cuts the bone again, frame by frame. As in the run, it finds the scene's events and coarsens zones.
class BoneRecutter {
 public:
  BoneRecutter(const CellSetup& setup, simulation::CuttingEngine& engine,
               std::vector<io::RecordedEvent> changes)
      : engine_(&engine),
        recarve_(engine, setup.config.servo.law),
        zones_(setup, std::move(changes), {.engine = "cpu"}),
        watch_(setup.solid.get(), setup.bone, setup.config.tool.tool, setup.config.scene.events),
        X_GW_(setup.X_WG.inverse()) {}

  /// Adds a tick or a frame, in the order of the file. @returns what is wrong; empty: nothing
  std::string Add(const control::TickRecord& tick, RecordedRunData& read) {
    recarve_.Add(tick);
    return CutDue(read);
  }
  std::string Add(const simulation::FrameRecord& frame, RecordedRunData& read) {
    recarve_.Wait(frame);
    return CutDue(read);
  }
  /// Cuts the frames that still wait, and stores the results. @returns what is wrong; empty: nothing
  std::string Finish(RecordedRunData& read) {
    if (std::string wrong = CutDue(read, true); !wrong.empty()) return wrong;
    read.result.after = engine_->Snapshot();
    read.result.rezoned = std::move(zones_.rezoned());
    read.result.min_wall_m = watch_.min_wall_m();
    read.recut.removed_volume_m3 = read.result.after.removed_volume_m3;
    return "";
  }

 private:
  // Cuts the waiting frames that are due. @param at_end  no further tick follows
  std::string CutDue(RecordedRunData& read, bool at_end = false) {
    while (const auto frame = recarve_.NextDue(at_end))
      if (std::string wrong = Cut(*frame, read); !wrong.empty()) return wrong;
    return "";
  }
  // Steps the engine to a frame, and replaces the engine if the run coarsened its zones after this frame.
  // @returns what is wrong; empty: nothing
  std::string Cut(const simulation::FrameRecord& frame, RecordedRunData& read) {
    recarve_.Add(frame);
    if (frame.model.status != simulation::EngineStatus::kOk) return "";
    read.recut.recorded_volume_m3 = frame.model.removed_volume_m3;
    const Pose X_GP = X_GW_ * Pose(frame.model.X_WP);
    for (simulation::SceneEvent& event : watch_.Step(X_GP, frame.model.removed_volume_m3, frame.stamp))
      read.result.events.push_back(std::move(event));
    auto coarser = zones_.Add(frame, *engine_);
    if (!coarser) return coarser.error();
    if (*coarser) {
      recarve_.ReplaceEngine(**coarser);
      engine_ = coarser->get();
      read.coarser = std::move(*coarser);
    }
    return "";
  }

  simulation::CuttingEngine* engine_;
  Recarve recarve_;
  RecordedZones zones_;
  simulation::SceneWatch watch_;
  Pose X_GW_;
};

// Reads the paths of the session's passes into `run`, and restores the engine to the last saved state.
// @returns what is wrong; empty: nothing
std::string RestoreSession(const std::filesystem::path& folder, const RecordedSession& session,
                           const CellSetup& setup, simulation::CuttingEngine& engine, RunAccumulator& run) {
  auto cut = ReadSessionCut(folder, session.file, ToolsOf(session.cell.tools), setup.X_WG);
  if (!cut) return cut.error();
  cut->planned = ReadPlannedCavity(folder, session.file);
  run.session_cut = std::make_shared<const SessionCut>(std::move(*cut));
  const std::string name = session.file.LastState();
  if (name.empty()) return "";  // the bone is still uncut
  auto state = ReadSessionState(folder, session.file, name, setup.bone);
  if (!state) return state.error();
  engine.Restore(simulation::WithoutContact(std::move(*state)));
  return "";
}

// Reads the whole recording. If it belongs to no session, cuts the bone again while reading.
// @param[in,out] engine  with the uncut bone; afterwards with the bone at the recording's end
// @param stops  gets the ticks and events, for the pages of the stops
tl::expected<RecordedRunData, std::string> ReadRecordedRunData(const std::filesystem::path& path,
                                                               const CellSetup& setup,
                                                               const std::optional<RecordedSession>& session,
                                                               simulation::CuttingEngine& engine,
                                                               StopPages& stops) {
  auto stream = io::RecordingStream::Open(path);
  if (!stream) return tl::unexpected(stream.error());
  RecordedRunData read{.run = RunAccumulator(setup), .result = {}};
  if (session) {
    read.run.UseTools(setup, session->cell.tools, session->cell.list.first);
    if (std::string wrong = RestoreSession(FolderOf(path), *session, setup, engine, read.run); !wrong.empty())
      return tl::unexpected(std::move(wrong));
  }
  auto changes = FindCoarsenedZones(path);
  if (!changes) return tl::unexpected(changes.error());
  BoneRecutter bone(setup, engine, std::move(*changes));
  std::uint32_t faults = 0;  // faults of the last tick
  std::string end;
  while (true) {
    const auto topic = stream->Next();
    if (!topic) return tl::unexpected(topic.error());
    if (*topic == io::RecordedTopic::kOther) break;
    if (*topic == io::RecordedTopic::kTick) {
      read.run.Add(stream->tick);
      stops.Add(stream->session, stream->tick);
      if (!session)
        if (std::string wrong = bone.Add(stream->tick, read); !wrong.empty())
          return tl::unexpected(path.string() + ": " + wrong);
      UpdatePeaks(stream->tick, read.result.statistics);
      faults = stream->tick.faults;
    } else if (*topic == io::RecordedTopic::kFrame) {
      read.run.Add(stream->frame);
      if (session) continue;
      if (std::string wrong = bone.Add(stream->frame, read); !wrong.empty())
        return tl::unexpected(path.string() + ": " + wrong);
    } else if (*topic == io::RecordedTopic::kEvent) {
      stops.Add(stream->event);
      if (stream->event.text.starts_with(kEndEvent)) end = stream->event.text;
      if (stream->event.text.starts_with(kPackingEvent) && !stream->session.packing)
        read.recut.packing_unknown = true;
    }
  }
  if (read.run.ticks == 0) return tl::unexpected(path.string() + ": found no tick, accepted at least 1");
  ForEachFault([&](safety::Fault fault, const safety::FaultText&) {
    if ((faults & static_cast<std::uint32_t>(fault)) != 0) read.result.faults.Latch(fault);
  });
  read.result.end = EndOf(read.result.faults, end, read.result.statistics.active_ticks > 0);
  if (const std::string wrong = stream->EndError(); !wrong.empty())
    read.result.recording_error = path.string() + ": " + wrong;
  if (session)
    read.result.after = engine.Snapshot();
  else if (std::string wrong = bone.Finish(read); !wrong.empty())
    return tl::unexpected(path.string() + ": " + wrong);
  const ActiveTicks& active = read.run.active;
  if (active.first && active.last) read.seconds = rt::ToSeconds(*active.last - *active.first);
  return read;
}

// Whether a run was in virtual time: such a run measures no durations.
bool WasVirtual(const RunAccumulator& run) {
  return run.active.compute.count() == 0 || run.active.compute.At(run.active.compute.count() - 1) == 0;
}

}  // namespace

int RunRecordedReport(const RecordedReportOptions& options) {
  base::PhaseProgress progress("osteon report", 4, false);
  const auto refuse = [&](const std::string& why, int code = kBadInput) {
    progress.Done();
    return Fail("report", why, code);
  };
  progress.BeginPhase("load the cell");
  auto stream = io::RecordingStream::Open(options.recording);
  if (!stream) return refuse(stream.error());
  if (const auto first = stream->Next(); !first) return refuse(first.error());
  const auto session = FindRecordedSession(options.recording, stream->session);
  if (!session) return refuse(session.error());
  if (*session && options.mesh) return refuse("--mesh: found with a session's recording, accepted without");
  auto setup =
      *session ? SetUpSessionCell(options.recording) : PrepareRecordedCell(stream->session, options.mesh);
  if (!setup) return refuse(*session ? setup.error() : options.recording.string() + ": " + setup.error());
  if (!setup->solid && setup->bone.balls.empty())
    return refuse(options.recording.string() + ": " + setup->bone_warning);
  if (!*session)
    if (const auto packed = PackAsRecorded(*setup, stream->session.packing); !packed)
      return refuse(options.recording.string() + ": " + packed.error());
  const EngineChoice choice{.engine = "cpu"};
  auto engine = MakeEngine(*setup, choice);
  if (!engine) return refuse(engine.error());

  progress.BeginPhase("cut the bone again");
  const std::filesystem::path folder = options.out.empty() ? options.recording.parent_path() : options.out;
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  const std::string stem = options.recording.stem().string();
  StopPages stops({.folder = folder, .stem = stem, .cell = setup->config, .recording = options.recording});
  auto read = ReadRecordedRunData(options.recording, *setup, *session, **engine, stops);
  if (!read) return refuse(read.error());
  progress.BeginPhase("measure the cut");
  const CellRunParams params{
      .seconds = read->seconds, .virtual_time = WasVirtual(read->run), .recording = options.recording};
  RunSummary summary = Summarise(*setup, **engine, params, read->result, read->run);
  summary.servo_thread.reset();
  if (!*session) {
    summary.recut = read->recut;
  } else {
    summary.session = FolderOf(options.recording).string();
    summary.passes = (*session)->file.passes;
    summary.missed_changes = (*session)->file.missed_changes;
    summary.diameters_mm = (*session)->file.diameters_mm;
  }
  summary.verdict = JudgeRun(summary);
  summary.engine = stream->session.engine;
  summary.device = stream->session.device;
  std::string wrong;
  if (auto pages = stops.Finish())
    summary.stops = std::move(*pages);
  else
    wrong = pages.error();
  progress.BeginPhase("draw the report");
  const std::filesystem::path page = folder / ReportPage(options.recording.filename());
  if (const auto figures =
          WriteRunReport(*setup, read->result, read->run, summary, "report", options.command_line, page))
    summary.section = *figures;
  else
    wrong = figures.error();
  progress.Done();
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, ToJson(summary, "osteon.report/1")); !written)
      wrong = written.error();
  PrintTable(summary, "Osteon report");
  fmt::print("  {:<30} {}\n", "Report", page.string());
  return wrong.empty() ? 0 : Fail("report", wrong, kFailed);
}

}  // namespace osteon::session
