#include "session/run/demo.h"

#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/phase_progress.h"
#include "base/run_progress.h"
#include "base/write_text.h"
#include "session/process/exit_code.h"
#include "session/process/output.h"
#include "session/replay/recorded_motion.h"
#include "session/replay/recorded_surface.h"
#include "session/run/cell_ports.h"
#include "session/run/cell_run.h"
#include "session/run/live_stops.h"
#include "session/run/live_views.h"
#include "session/run/remote_engine.h"
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

// Default duration of a demo with a plan [s].
constexpr double kSecondsPerReamer = 15.0, kNoviceSecondsPerReamer = 60.0, kSecondsPerBurr = 60.0;
constexpr double kSecondsOfLastPush = 20.0;  // additional time for an expert's longer push of the last reamer

// Folder of a session without a given name: the first of session, session_2, … that does not exist in `out`.
std::filesystem::path UnusedSessionFolder(const std::filesystem::path& out) {
  std::error_code error;
  for (int number = 1;; ++number) {
    std::filesystem::path folder = out / (number == 1 ? "session" : fmt::format("session_{}", number));
    if (!std::filesystem::exists(folder, error)) return folder;
  }
}

// Checks the output paths before anything runs. @returns what is wrong; empty: nothing. The folders are
// created later, by RunCell, so that a refused run leaves none.
std::string CheckOutputs(const DemoOptions& options) {
  if (options.out.empty()) return "--out: found no name, accepted a folder";
  if (std::string wrong = ValidateOutputFolder("--out", options.out); !wrong.empty()) return wrong;
  for (const auto& [name, file] :
       {std::pair("--json", options.json), std::pair("--save-motion", options.save_motion)})
    if (std::string wrong = ValidateOutputFile(name, file); !wrong.empty()) return wrong;
  return ValidateSurfaceFile(options.surface);
}

// Claims the folder for this process, and moves or removes an earlier demo's files. @returns what is wrong;
// empty: nothing
std::string MakeRoom(const DemoOptions& options, FolderClaim& claim) {
  std::error_code error;
  // RunCell creates the recording's folder, which is another one if there is a session
  std::filesystem::create_directories(options.out, error);
  if (error) return options.out.string() + ": cannot make the folder: " + error.message();
  if (std::string wrong = claim.Acquire(options.out); !wrong.empty()) return wrong;
  if (options.overwrite) return RemoveFiles(FilesOfDemo(options.out));
  const auto earlier = KeepEarlierDemo(options.out);
  if (!earlier) return earlier.error();
  if (!earlier->empty())
    fmt::print(stderr, "osteon demo: the demo that was there is kept in {}\n", earlier->string());
  return "";
}

// Saves the tool's motion as a file that can be played again. @returns what is wrong; empty: nothing
std::string SaveMotion(const DemoOptions& options, const CellSetup& setup, const RunSummary& summary,
                       const std::filesystem::path& recording) {
  const auto motion =
      RecordedMotion(recording, setup.X_WG,
                     {.made_by = "osteon " OSTEON_VERSION
                                 ": the simulated operator of hil/, at the simulated cell; no person's hand",
                      .scene = summary.scene,
                      .cell = "config/cells/" + options.cell.filename().string(),
                      .tool = summary.tool,
                      .engine = summary.engine + " on " + summary.device,
                      .clock = summary.virtual_time ? "virtual time" : "wall time",
                      .command = options.command_line,
                      .error = {}});
  if (!motion) return motion.error();
  const auto written = base::WriteText(options.save_motion, simulation::MotionText(*motion));
  return written ? std::string() : written.error();
}

// Writes report, summary and the requested files, and prints the summary. The figures of the run are measured
// on the recording; if it cannot be read, only RunCell's own counts are shown. @returns the exit code
int PrintResult(const DemoOptions& options, const CellSetup& setup, const simulation::CuttingEngine& engine,
                const CellRunParams& params, const CellRunResult& result) {
  base::PhaseProgress measuring("osteon demo", options.surface.empty() ? 3 : 4, false);
  measuring.BeginPhase("read the recording");
  StopPages stops({.folder = options.out,
                   .stem = params.recording.stem().string(),
                   .cell = setup.config,
                   .recording = params.recording});
  auto run = ReadRun(params.recording, setup, stops, params.procedure);
  std::string wrong = DescribeRecordingErrors(result, run ? "" : run.error());
  if (!run) run = RunAccumulator(setup);  // an empty one: the counts of `result` can still be shown
  measuring.BeginPhase("measure the cut");
  RunSummary summary = Summarise(setup, engine, params, result, *run);
  if (auto pages = stops.Finish())  // written before the report, which links to them
    summary.stops = std::move(*pages);
  else
    AddReason(wrong, pages.error());
  measuring.BeginPhase("draw the report");
  const std::filesystem::path page = options.out / "report.html";
  const auto figures = WriteRunReport(setup, result, *run, summary, "demo", options.command_line, page);
  if (figures)
    summary.section = *figures;
  else
    AddReason(wrong, figures.error());
  if (!options.surface.empty()) {
    measuring.BeginPhase("make the surface");
    if (auto surface = WriteRecordedSurface(params.recording, setup, {}, options.surface))
      summary.surface = std::move(*surface);
    else
      AddReason(wrong, surface.error());
  }
  measuring.Done();

  const std::string json = ToJson(summary, "osteon.demo/1");
  for (const std::filesystem::path& file : {options.out / "summary.json", options.json}) {
    if (file.empty()) continue;
    if (const auto written = base::WriteText(file, json); !written) AddReason(wrong, written.error());
  }
  if (!options.save_motion.empty()) AddReason(wrong, SaveMotion(options, setup, summary, params.recording));
  PrintTable(summary, "Osteon demo");
  if (figures) fmt::print("  {:<30} {}\n", "Report", page.string());
  if (summary.surface) fmt::print("  {:<30} {}\n", "Surface", SurfaceText(*summary.surface));
  if (!result.internal_error.empty())
    return Fail("demo", "internal error: " + result.internal_error, kInternalError);
  return wrong.empty() ? ExitCode(result) : Fail("demo", wrong, kFailed);
}

// Default duration of a demo with a plan [s]. @param tools  number of tools to be used
double SecondsOfPlan(procedure::PlanKind kind, bool novice, double tools) {
  if (kind == procedure::PlanKind::kOpening) return kSecondsPerBurr * tools;
  return novice ? kNoviceSecondsPerReamer * tools : kSecondsPerReamer * tools + kSecondsOfLastPush;
}

}  // namespace

int RunDemo(const DemoOptions& asked) {
  DemoOptions options = asked;
  std::optional<Procedure> procedure;
  if (!options.procedure.plan.empty()) {
    options.procedure.mesh = options.mesh;
    options.procedure.virtual_time = options.virtual_time;
    if (options.procedure.session.empty()) options.procedure.session = UnusedSessionFolder(options.out);
    auto opened = OpenProcedure(options.procedure, options.cell, options.tool);
    if (!opened) return Fail("demo", opened.error());
    procedure = std::move(*opened);
    options.mesh = procedure->mesh;
    const auto tools =
        procedure->tools.diameters_mm.size() - static_cast<std::size_t>(procedure->tools.first);
    if (options.default_seconds)
      options.seconds = SecondsOfPlan(procedure->plan.plan.kind, options.procedure.hand == "novice",
                                      static_cast<double>(tools));
  }
  if (!(options.seconds >= kMinSeconds && options.seconds <= kMaxSeconds))
    return Fail("demo", fmt::format("--seconds: found {}, accepted {} … {}", options.seconds, kMinSeconds,
                                    kMaxSeconds));
  if (options.cpu >= 0 && options.virtual_time)
    return Fail("demo",
                fmt::format("--cpu: found {} with --virtual-time, accepted in wall time", options.cpu));
  if (options.frame_ms && !options.virtual_time)
    return Fail("demo", fmt::format("--frame-ms: found {:g} in wall time, accepted with --virtual-time",
                                    *options.frame_ms));
  if (options.real_time_factor && !options.virtual_time)
    return Fail("demo",
                fmt::format("--real-time-factor: found {:g} in wall time, accepted with --virtual-time",
                            *options.real_time_factor));
  // do this before any other thread exists, because threads inherit the CPUs
  if (const std::string wrong = rt::ReserveCpu(options.cpu); !wrong.empty())
    return Fail("demo", "--cpu: " + wrong);
  if (const std::string wrong = CheckOutputs(options); !wrong.empty()) return Fail("demo", wrong);
  FolderClaim claim;
  if (const std::string wrong = claim.Acquire(options.out); !wrong.empty()) return Fail("demo", wrong);
  OutputThread output({.watch_stderr = true});

  const bool timed = !options.virtual_time;
  base::PhaseProgress planning("osteon demo", timed ? 3 : 2, false);
  planning.BeginPhase("load the cell");  // takes seconds if a mesh is not closed and is remade
  const auto refuse = [&](const std::string& why) {
    planning.Done();
    return Fail("demo", why);
  };
  const std::optional<config::ToolChoice> tool = procedure ? procedure->tool : options.tool;
  auto setup = PrepareCell(options.cell, options.mesh, tool, {}, options.identified);
  if (!setup) return refuse(setup.error());
  if (!options.tune.empty())
    if (const auto advice = ReadTuneAdvice(options.tune, setup->config, setup->cell_name); !advice)
      return refuse("--tune " + advice.error());
  const auto first_port = UseSimulated(setup->config, options.port);
  if (!first_port) return refuse(first_port.error());
  const EngineChoice choice = ChooseEngine(options.engine, options.device);
  if (const auto packed = PackCell(*setup, options.fidelity, choice, timed && !procedure,
                                   [&](const std::string& phase) { planning.BeginPhase("plan: " + phase); });
      !packed)
    return refuse(packed.error());
  planning.Done();
  RemoteEngine* remote = nullptr;
  auto engine = MakeRunEngine(*setup, choice, options.cell, remote);
  if (!engine) return Fail("demo", engine.error());
  std::unique_ptr<ProcedureSession> session;
  if (procedure) {
    if (remote)
      return Fail(
          "demo",
          "found simulation: {process} with a session, accepted a cell whose engine is a thread of the run: "
          "a session makes an engine for each tool");
    auto made = MakeSession(*procedure, options.procedure, options.cell, {}, choice, true,
                            options.virtual_time, *setup, *engine);
    if (!made) return Fail("demo", made.error());
    session = std::move(*made);
  }
  // No adaptive resolution in two cases: an engine in another process keeps its own copy of the bone, and a
  // session's saved states fit only the packing that they were made with.
  const auto adaptive_resolution = remote || session ? nullptr : MakeAdaptiveResolution(*setup, choice);

  PrintIdentified(setup->config, "demo");
  if (!setup->solid && setup->config.scene.events.min_wall_m > 0.0)
    fmt::print(stderr,
               "osteon demo: {}: the surface of a packing is not known: wall thickness is not watched\n",
               setup->bone.name);

  if (!setup->bone_warning.empty()) fmt::print(stderr, "osteon demo: warning: {}\n", setup->bone_warning);
  for (const std::string& warning : SetupWarnings(setup->config, false))
    fmt::print(stderr, "osteon demo: warning: {}\n", warning);

  base::InstallInterrupt();
  base::InstallPauseSignals();
  base::RunProgress progress("osteon demo", options.seconds);
  const std::filesystem::path recording =
      session ? session->folder() / procedure->recording : options.out / "recording.mcap";
  LiveViews live(*setup,
                 {.command = "demo",
                  .seconds = options.seconds,
                  .recording = recording.string(),
                  .pages = options.out,
                  .tune = options.tune},
                 base::AskedByOperator());
  live.SetSession(session.get());
  ConsoleChoice console = options.console;
  // a run in virtual time takes only a moment, so it has a page only if a port is demanded
  console.on &= !options.virtual_time || console.only_this_port;
  live.Open(console, options.foxglove);
  std::optional<LiveStops> stops;  // none in virtual time, which takes only a moment
  if (!options.virtual_time)
    stops.emplace(LiveStopsParams{.cell = setup->config,
                                  .recording = recording,
                                  .folder = options.out,
                                  .console_url = live.console_url(),
                                  .force_limit_N = control::ForceLimit_N(setup->config.servo)},
                  *live.sink());
  const CellRunParams params{
      .seconds = options.seconds,
      .virtual_time = options.virtual_time,
      .frame_s = options.frame_ms ? 1e-3 * *options.frame_ms : CellRunParams{}.frame_s,
      .real_time_factor = options.real_time_factor.value_or(0.0),
      .hold_at_fault = options.hold_at_fault,
      .cpu = options.cpu,
      .cell = CellProcessParams{.cell = options.cell,
                                .tool = procedure ? procedure->in_use : options.tool,
                                .identified = options.identified,
                                .plan = options.procedure.plan,
                                .hand = options.procedure.hand,
                                .seconds = options.seconds,
                                .first_port = *first_port,
                                .cpu = options.cpu,
                                .guard = setup->config.guard.has_value()},
      .remote = remote,
      .recording = recording,
      .make_room = [&] { return MakeRoom(options, claim); },
      .stop = &base::Interrupted(),
      .requests = &base::AskedByOperator(),
      .live = stops ? &*stops : live.sink(),
      .console_url = live.console_url(),
      .gains_panel = live.gains_panel(),
      .bone_state_s = options.bone_state_s,
      .begins =
          [&] {
            live.Announce();
            fmt::print(stderr, "osteon demo: engine: {}\n", EngineText(choice, (*engine)->device()));
            if (remote)
              fmt::print(stderr, "osteon demo: the engine is a process of its own: {}\n", remote->where());
            PrintLimits(setup->config.servo);
          },
      .notice = [](const std::string& text) { fmt::print(stderr, "\nosteon demo: {}\n", text); },
      .progress = [&](double at_s) { progress.Show(at_s, live.Line()); },
      .procedure = session.get(),
      .adaptive_resolution = adaptive_resolution.get(),
      .surface = live.surface_thread()};
  auto result = RunCell(*setup, **engine, params);
  if (stops) stops->Finish();
  progress.Done();
  if (!result) return Fail("demo", result.error().what, result.error().begun ? kFailed : kBadInput);

  return PrintResult(options, *setup, **engine, params, *result);
}

}  // namespace osteon::session
