#include "session/run/operate.h"

#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/phase_progress.h"
#include "base/run_progress.h"
#include "base/write_text.h"
#include "config/reading/check_registration.h"
#include "session/process/exit_code.h"
#include "session/process/output.h"
#include "session/replay/recorded_surface.h"
#include "session/run/arm_connection.h"
#include "session/run/cell_ports.h"
#include "session/run/cell_run.h"
#include "session/run/live_stops.h"
#include "session/run/live_views.h"
#include "session/run/remote_engine.h"
#include "session/setup/config_checksum.h"
#include "session/setup/identified_notice.h"
#include "session/setup/setup_warnings.h"
#include "session/stops/stop_records.h"
#include "session/summary/chart_files.h"
#include "session/summary/run_accumulator.h"
#include "session/summary/run_files.h"
#include "session/summary/run_report.h"
#include "session/summary/summary.h"

namespace osteon::session {
namespace {

// Prints what the user should check before anything moves: poses and the addresses of the connections.
void PrintRegistration(const config::CellConfig& cell) {
  for (const config::RegistrationRow& row : config::DescribeRegistration(cell).rows)
    fmt::print(stderr, "osteon run: {:<42} {:8.1f} {:<4} {}\n", row.name, row.value, row.unit, row.verdict());
}

void PrintConnections(const config::CellConfig& cell) {
  fmt::print(stderr, "osteon run: {} on {}:{}\n", Describe(cell.link), cell.link.host, cell.link.port);
  if (cell.guard)
    fmt::print(stderr, "osteon run: the arm is reached through the guard, which listens on {}:{}\n",
               cell.guard->host, cell.guard->port);
  for (const io::CanBusParams& bus : cell.devices.buses)
    fmt::print(stderr, "osteon run: CAN bus {}: {}\n", bus.name,
               bus.interface.empty() ? fmt::format("tunnel on 127.0.0.1:{}", bus.port) : bus.interface);
  if (cell.devices.plc)
    fmt::print(stderr, "osteon run: PLC {}:{}\n", cell.devices.plc->address, cell.devices.plc->port);
  else
    fmt::print(stderr, "osteon run: PLC none (without_plc: accepted)\n");
}

// Checks the output paths before anything runs. @returns what is wrong; empty: nothing
std::string WrongPlace(const OperateOptions& options) {
  if (std::string wrong = ValidateOutputFile("--json", options.json); !wrong.empty()) return wrong;
  if (std::string wrong = ValidateSurfaceFile(options.surface); !wrong.empty()) return wrong;
  std::error_code error;
  if (std::filesystem::is_directory(options.record, error))
    return fmt::format("--record {}: found a folder, accepted a file", options.record.string());
  return options.overwrite ? "" : ValidateRecordingName(options.record);
}

// Removes the files of an earlier run with the same recording name if options.overwrite is set; otherwise
// such files are an error. @returns what is wrong; empty: nothing
std::string MakeRoom(const OperateOptions& options) {
  if (!options.overwrite) return ValidateRecordingName(options.record);
  // the recording itself is not removed: the recorder overwrites it once it has locked it
  std::vector<std::filesystem::path> pages = FilesOfRun(options.record);
  std::erase(pages, options.record);
  return RemoveFiles(pages);
}

// Reads the finished recording, writes report, stop pages and JSON from it, and prints the table.
// @returns the exit code
int PrintResult(const OperateOptions& options, const CellSetup& setup,
                const simulation::CuttingEngine& engine, const CellRunParams& params,
                const CellRunResult& result) {
  base::PhaseProgress measuring("osteon run", options.surface.empty() ? 3 : 4, false);
  measuring.BeginPhase("read the recording");
  StopPages stops({.folder = options.record.parent_path(),
                   .stem = options.record.stem().string(),
                   .cell = setup.config,
                   .recording = params.recording});
  auto run = ReadRun(params.recording, setup, stops, params.procedure);
  std::string wrong = DescribeRecordingErrors(result, run ? "" : run.error());
  if (!run) run = RunAccumulator(setup);  // an empty one: the counts of `result` can still be shown
  measuring.BeginPhase("measure the cut");
  RunSummary summary = Summarise(setup, engine, params, result, *run);
  if (!options.surface.empty()) {
    measuring.BeginPhase("make the surface");
    if (auto surface = WriteRecordedSurface(params.recording, setup, {}, options.surface))
      summary.surface = std::move(*surface);
    else
      AddReason(wrong, surface.error());
  }
  if (auto pages = stops.Finish())  // written before the report, which links to them
    summary.stops = std::move(*pages);
  else
    AddReason(wrong, pages.error());
  measuring.BeginPhase("draw the report");
  const std::filesystem::path page = ReportPage(options.record);
  if (const auto figures = WriteRunReport(setup, result, *run, summary, "run", options.command_line, page))
    summary.section = *figures;
  else
    AddReason(wrong, figures.error());
  measuring.Done();
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, ToJson(summary, "osteon.run/1")); !written)
      AddReason(wrong, written.error());
  PrintTable(summary, "Osteon run");
  if (summary.surface) fmt::print("  {:<30} {}\n", "Surface", SurfaceText(*summary.surface));
  fmt::print("  {:<30} {}\n", "Report", page.string());
  if (!result.internal_error.empty())
    return Fail("run", "internal error: " + result.internal_error, kInternalError);
  return wrong.empty() ? ExitCode(result) : Fail("run", wrong, kFailed);
}

}  // namespace

int RunOperate(const OperateOptions& asked) {
  OperateOptions options = asked;
  std::optional<Procedure> procedure;
  if (!options.procedure.plan.empty()) {
    auto opened = OpenProcedure(options.procedure, options.cell, options.tool);
    if (!opened) return Fail("run", opened.error());
    procedure = std::move(*opened);
    options.tool = procedure->tool;
    options.record = procedure->folder / procedure->recording;
  }
  if (options.record.empty()) options.record = DatedRecording("", std::chrono::system_clock::now());
  if (const std::string wrong = WrongPlace(options); !wrong.empty()) return Fail("run", wrong);
  // do this before any other thread exists, because threads inherit the CPUs
  if (const std::string wrong = rt::ReserveCpu(options.cpu); !wrong.empty())
    return Fail("run", "--cpu: " + wrong);
  OutputThread output({.watch_stderr = true});
  base::PhaseProgress planning("osteon run", 3, false);
  planning.BeginPhase("load the cell");  // takes seconds if the bone's mesh is not closed
  auto setup = PrepareCell(options.cell, {}, options.tool, options.gains, options.identified);
  const auto refuse = [&](const std::string& why) {
    planning.Done();
    return Fail("run", why);
  };
  if (!setup) return refuse(setup.error());
  if (!options.tune.empty())
    if (const auto advice = ReadTuneAdvice(options.tune, setup->config, setup->cell_name); !advice)
      return refuse("--tune " + advice.error());
  std::optional<CellProcessParams> cell;
  if (options.simulated) {
    const auto first_port = UseSimulated(setup->config, options.port);
    if (!first_port) return refuse(first_port.error());
    cell = CellProcessParams{.cell = options.cell,
                             .tool = procedure ? procedure->in_use : options.tool,
                             .identified = options.identified,
                             .plan = options.procedure.plan,
                             .hand = options.procedure.hand,
                             .seconds = options.seconds,
                             .first_port = *first_port,
                             .cpu = options.cpu,
                             .guard = setup->config.guard.has_value()};
  } else if (options.port) {
    if (const std::string wrong = UseSimulatedWires(setup->config, options.port); !wrong.empty())
      return refuse(wrong);
  }
  const EngineChoice choice = ChooseEngine(options.engine, options.device);
  if (const auto packed = PackCell(*setup, options.fidelity, choice, !procedure,
                                   [&](const std::string& phase) { planning.BeginPhase("plan: " + phase); });
      !packed)
    return refuse(packed.error());
  planning.Done();
  RemoteEngine* remote = nullptr;
  auto engine = MakeRunEngine(*setup, choice, options.cell, remote);
  if (!engine) return Fail("run", engine.error());
  const std::string config_checksum = ConfigChecksum(setup->config_source);
  std::unique_ptr<ProcedureSession> session;
  if (procedure) {
    if (remote)
      return Fail(
          "run",
          "found simulation: {process} with a session, accepted a cell whose engine is a thread of the run: "
          "a session makes an engine for each tool");
    auto made = MakeSession(*procedure, options.procedure, options.cell, options.gains, choice,
                            options.simulated, false, *setup, *engine);
    if (!made) return Fail("run", made.error());
    session = std::move(*made);
  }
  // No adaptive resolution in two cases: an engine in another process keeps its own copy of the bone, and a
  // session's saved states fit only the packing that they were made with.
  const auto adaptive_resolution = remote || session ? nullptr : MakeAdaptiveResolution(*setup, choice);
  fmt::print(stderr, "osteon run: engine: {}\n", EngineText(choice, (*engine)->device()));
  if (remote) fmt::print(stderr, "osteon run: the engine is a process of its own: {}\n", remote->where());
  if (setup->planned) fmt::print(stderr, "osteon run: packing: {}\n", PlannedText(*setup->planned));
  PrintRegistration(setup->config);
  PrintIdentified(setup->config, "run");
  PrintConnections(setup->config);
  fmt::print(stderr, "osteon run: configuration {}\nosteon run: waits {:g} s for the arm\n", config_checksum,
             options.wait_s);

  if (!setup->bone_warning.empty()) fmt::print(stderr, "osteon run: warning: {}\n", setup->bone_warning);
  for (const std::string& warning : SetupWarnings(setup->config, !cell))
    fmt::print(stderr, "osteon run: warning: {}\n", warning);

  base::InstallInterrupt();
  base::InstallPauseSignals();
  base::RunProgress progress("osteon run", options.seconds);
  LiveViews live(*setup,
                 {.command = "run",
                  .seconds = options.seconds,
                  .recording = options.record.string(),
                  .tune = options.tune},
                 base::AskedByOperator());
  live.SetSession(session.get());
  live.Open(options.console, options.foxglove);
  LiveStops stops({.cell = setup->config,
                   .recording = options.record,
                   .folder = options.record.parent_path(),
                   .console_url = live.console_url(),
                   .force_limit_N = control::ForceLimit_N(setup->config.servo)},
                  *live.sink());
  const CellRunParams params{
      .seconds = options.seconds,
      .recoveries = options.recoveries,
      .hold_at_fault = options.hold_at_fault.value_or(options.console.on && options.console.only_this_port &&
                                                      options.seconds == 0.0),
      .wait_s = options.wait_s,
      .cpu = options.cpu,
      .cell = cell,
      .remote = remote,
      .recording = options.record,
      .make_room = [&] { return MakeRoom(options); },
      .stop = &base::Interrupted(),
      .requests = &base::AskedByOperator(),
      .live = &stops,
      .console_url = live.console_url(),
      .gains = options.gains,
      .gains_panel = live.gains_panel(),
      .bone_state_s = options.bone_state_s,
      .begins =
          [&] {
            live.Announce();
            PrintLimits(setup->config.servo);
          },
      .notice = [](const std::string& text) { fmt::print(stderr, "\nosteon run: {}\n", text); },
      .progress = [&](double at_s) { progress.Show(at_s, live.Line()); },
      .procedure = session.get(),
      .adaptive_resolution = adaptive_resolution.get(),
      .surface = live.surface_thread()};
  auto result = RunCell(*setup, **engine, params);
  stops.Finish();
  progress.Done();
  if (!result) return Fail("run", result.error().what, result.error().begun ? kFailed : kBadInput);

  return PrintResult(options, *setup, **engine, params, *result);
}

}  // namespace osteon::session
