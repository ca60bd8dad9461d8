#include "session/replay/recorded_report.h"

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/phase_progress.h"
#include "base/write_text.h"
#include "console/stream/live_window.h"
#include "io/recording/recording_reader.h"
#include "safety/cell_state.h"
#include "session/process/exit_code.h"
#include "session/replay/recarve.h"
#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "session/stops/stop_records.h"
#include "session/summary/chart_files.h"
#include "session/summary/each_fault.h"
#include "session/summary/run_accumulator.h"
#include "session/summary/run_files.h"
#include "session/summary/run_report.h"
#include "session/summary/summary.h"

namespace osteon::app {
namespace {

// The loop's peaks, of what is recorded of each tick. The power into the hand is not.
void AddTick(const control::TickRecord& tick, control::ServoStatistics& peaks) {
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

// How a run ended, by its faults and its last event.
control::RunEnd EndOf(safety::FaultSet faults, const std::string& end, bool rendered) {
  if (faults.Any()) return control::RunEnd::kFault;
  if (!rendered) return control::RunEnd::kNeverActive;
  const bool by_time = end.find("of rendering were over") != std::string::npos;
  return by_time ? control::RunEnd::kSeconds : control::RunEnd::kStopFlag;
}

struct Read {
  RunAccumulator run;
  CellRunResult result;
  double seconds{0.0};  ///< between the first and the last commanded tick
};

tl::expected<Read, std::string> ReadAll(const std::filesystem::path& path, const CellSetup& setup,
                                        simulation::CuttingEngine& engine, StopPages& stops) {
  auto stream = io::RecordingStream::Open(path);
  if (!stream) return tl::unexpected(stream.error());
  Read read{.run = RunAccumulator(setup), .result = {}};
  Recarve recarve(engine, setup.config.servo.law);
  std::uint32_t faults = 0;  // of the last tick
  std::string end;
  while (true) {
    const auto topic = stream->Next();
    if (!topic) return tl::unexpected(topic.error());
    if (*topic == io::RecordedTopic::kOther) break;
    if (*topic == io::RecordedTopic::kTick) {
      read.run.Add(stream->tick);
      stops.Add(stream->session, stream->tick);
      recarve.Add(stream->tick);
      AddTick(stream->tick, read.result.statistics);
      faults = stream->tick.faults;
    } else if (*topic == io::RecordedTopic::kFrame) {
      read.run.Add(stream->frame);
      recarve.Add(stream->frame);
    } else if (*topic == io::RecordedTopic::kEvent) {
      stops.Add(stream->event);
      if (stream->event.text.starts_with(kEndEvent)) end = stream->event.text;
    }
  }
  if (read.run.ticks == 0) return tl::unexpected(path.string() + ": found no tick, accepted at least 1");
  ForEachFault([&](safety::Fault fault, const safety::FaultText&) {
    if ((faults & static_cast<std::uint32_t>(fault)) != 0) read.result.faults.Latch(fault);
  });
  read.result.end = EndOf(read.result.faults, end, read.result.statistics.active_ticks > 0);
  read.result.recording_error = stream->complete() ? "" : path.string() + ": it ends early: the process died";
  read.result.after = engine.Snapshot();
  const ActiveTicks& active = read.run.active;
  if (active.first && active.last) read.seconds = rt::ToSeconds(*active.last - *active.first);
  return read;
}

// A virtual run measures no times.
bool WasVirtual(const RunAccumulator& run) {
  return run.active.compute.count() == 0 || run.active.compute.At(run.active.compute.count() - 1) == 0;
}

}  // namespace

int RunRecordedReport(const RecordedReportOptions& options) {
  PhaseProgress progress("osteon report", 4, false);
  const auto refuse = [&](const std::string& why, int code = kBadInput) {
    progress.Done();
    return Fail("report", why, code);
  };
  progress.BeginPhase("load the cell");
  auto stream = io::RecordingStream::Open(options.recording);
  if (!stream) return refuse(stream.error());
  if (const auto first = stream->Next(); !first) return refuse(first.error());
  auto setup = SetUpRecorded(stream->session);
  if (!setup) return refuse(options.recording.string() + ": " + setup.error());
  if (!setup->solid) return refuse(options.recording.string() + ": " + setup->bone_warning);
  PackAsScene(*setup);
  const EngineChoice choice{.engine = "cpu"};
  auto engine = MakeEngine(*setup, choice);
  if (!engine) return refuse(engine.error());

  progress.BeginPhase("cut the bone again");
  const std::filesystem::path folder = options.out.empty() ? options.recording.parent_path() : options.out;
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  const std::string stem = options.recording.stem().string();
  StopPages stops({.folder = folder, .stem = stem, .cell = setup->config, .recording = options.recording});
  auto read = ReadAll(options.recording, *setup, **engine, stops);
  if (!read) return refuse(read.error());
  progress.BeginPhase("measure the cut");
  const CellRunParams params{
      .seconds = read->seconds, .virtual_time = WasVirtual(read->run), .recording = options.recording};
  RunSummary summary = Summarise(*setup, **engine, params, read->result, read->run);
  summary.servo_thread.reset();
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
    if (const auto written = WriteText(options.json, ToJson(summary, "osteon.report/1")); !written)
      wrong = written.error();
  PrintTable(summary, "Osteon report");
  fmt::print("  {:<30} {}\n", "Report", page.string());
  return wrong.empty() ? 0 : Fail("report", wrong, kFailed);
}

}  // namespace osteon::app
