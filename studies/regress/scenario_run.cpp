#include "studies/regress/scenario_run.h"

#include <time.h>

#include <filesystem>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/clock.h"
#include "base/fnv1a.h"
#include "base/read_text.h"
#include "base/work_folder.h"
#include "config/reading/load.h"
#include "config/reading/load_surgical_plan.h"
#include "config/reading/strict/overlay.h"
#include "session/planning/planned_cell.h"
#include "session/procedure/plan_guidance.h"
#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "session/summary/summary.h"
#include "simulation/bone/scene_events.h"
#include "studies/regress/plane_engine.h"

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

// CPU time of the calling thread [s].
double Cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Overrides values of the cell's file: first by the scenario's file, then by --set.
void ApplyOverrides(const config::ScenarioConfig& scenario, const ScenarioRunParams& params,
                    config::Overlay& overlay) {
  overlay.SetFromFile(scenario.file, config::kOverridesKey);
  for (const std::string& assignment : params.set) overlay.Set(assignment, "--set");
}

// Gives the loop the guidance of the scenario's plan, for the reamer of the cell.
void SetGuidance(const config::ScenarioConfig& scenario, session::CellSetup& setup) {
  const config::SurgicalPlanConfig plan = config::LoadSurgicalPlan(scenario.plan);
  auto guidance = session::GuidanceOf(plan.plan, setup.config.tool.tool, setup.X_WG);
  if (guidance && scenario.guidance) guidance->gain = *scenario.guidance;
  setup.config.servo.guidance = guidance;
}

// Reads the cell, packs its bone, and sets the guidance of a surgical plan if there is one.
tl::expected<session::CellSetup, std::string> SetUp(const config::ScenarioConfig& scenario,
                                                    const ScenarioRunParams& params) {
  config::Overlay overlay(scenario.cell);
  ApplyOverrides(scenario, params, overlay);
  auto setup = session::PrepareCell(scenario.cell, std::nullopt);
  overlay.Finish();
  if (!setup) return setup;
  // Plan the packing by the closed forms alone, without measured frame times: the result is the same on every
  // machine.
  if (const auto packed = session::PackCell(
          *setup, {.as_packed = !scenario.planned, .error_m = {}, .rate_hz = {}}, {}, false);
      !packed)
    return tl::make_unexpected(packed.error());
  if (!scenario.plan.empty()) SetGuidance(scenario, *setup);
  return setup;
}

// Makes the scenario's engine. @param device  part of a Vulkan device's name
tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> EngineOf(
    const config::ScenarioConfig& scenario, const session::CellSetup& setup, const std::string& device) {
  const Pose& X_WC = setup.config.X_WG;  // pose of the site; its z axis is the plane's normal
  switch (scenario.engine) {
    case config::ScenarioEngine::kPlane:
      return std::make_unique<PlaneEngine>(setup.config.tool.tool, X_WC.translation(), X_WC.linear().col(2),
                                           setup.config.cutting);
    case config::ScenarioEngine::kReference:
      // The "cpu" engine gives the same bits as the reference engine in a fraction of its time.
      return session::MakeEngine(setup, {.engine = "cpu"});
    case config::ScenarioEngine::kVulkan:
      return session::MakeEngine(setup, {.engine = "vulkan", .device = device});
  }
  return tl::make_unexpected(std::string("no engine"));
}

// FNV-1a, 16 hexadecimal digits.
std::string Checksum(const std::string& bytes) {
  base::Fnv1a hash;
  hash.Add(bytes);
  return fmt::format("{:016x}", hash.hash());
}

// Lists the scenario's file, its plan, and the files that its cell was read from.
std::vector<GoldenSource> SourcesOf(const config::ScenarioConfig& scenario, const session::CellSetup& setup) {
  std::vector<GoldenSource> sources;
  sources.push_back(
      {.path = scenario.file.filename().string(), .checksum = Checksum(base::ReadText(scenario.file))});
  if (!scenario.plan.empty())
    sources.push_back(
        {.path = scenario.plan.filename().string(), .checksum = Checksum(base::ReadText(scenario.plan))});
  for (const io::ConfigFile& file : setup.config_source.files)
    sources.push_back({.path = file.name, .checksum = Checksum(file.content)});
  return sources;
}

// Requests the scenario's pause and its end, at the ticks that the scenario states, counted from the begin of
// rendering.
class Pauses {
 public:
  Pauses(const config::ScenarioConfig& scenario, double period_s)
      : pause_(TickOf(scenario.pause_s, period_s)), resume_(TickOf(scenario.resume_s, period_s)) {}

  void Tick(const control::TickRecord& record) {
    if (rendering_ < 0 && record.phase != control::Phase::kHaptic) return;
    ++rendering_;
    if (rendering_ == pause_) signals_.pause.store(true);
    if (rendering_ == resume_) signals_.resume.store(true);
  }
  [[nodiscard]] base::OperatorRequests* signals() { return &signals_; }

 private:
  // Returns the tick of a time; -1, which is no tick, if there is no time.
  static std::int64_t TickOf(const std::optional<double>& time_s, double period_s) {
    return time_s ? std::llround(*time_s / period_s) : -1;
  }
  std::int64_t pause_, resume_, rendering_{-1};
  base::OperatorRequests signals_;
};

}  // namespace

void CheckScenario(const config::ScenarioConfig& scenario, const ScenarioRunParams& params) {
  config::Overlay overlay(scenario.cell);
  ApplyOverrides(scenario, params, overlay);
  config::RequireSimulation(config::LoadCell(scenario.cell), scenario.cell);
  overlay.Finish();
}

tl::expected<ScenarioRun, std::string> RunScenario(const config::ScenarioConfig& scenario,
                                                   const ScenarioRunParams& params) {
  ScenarioRun run;
  const double begun_s = rt::ToSeconds(rt::MonotonicNow()), begun_cpu_s = Cpu_s();
  auto setup = SetUp(scenario, params);
  if (!setup) return tl::make_unexpected(setup.error());
  auto engine = EngineOf(scenario, *setup, params.device);
  if (!engine) return tl::make_unexpected(engine.error());
  run.sources = SourcesOf(scenario, *setup);
  run.engine = fmt::format("{} on {}", (*engine)->name(), (*engine)->device());
  run.seconds_set_up = rt::ToSeconds(rt::MonotonicNow()) - begun_s;

  const auto folder = std::make_shared<const base::WorkFolder>("regress");
  if (folder->path().empty())
    return tl::make_unexpected(fs::temp_directory_path().string() + ": cannot make a temporary folder");
  const double period_s = setup->config.servo.period_s;
  TraceRecorder recorder(period_s, scenario.sample_s);
  Pauses pauses(scenario, period_s);
  const auto result = session::RunCell(
      *setup, **engine,
      {.seconds = scenario.seconds,
       .virtual_time = true,
       .frame_s = scenario.frame_s,
       .recoveries = scenario.recoveries,
       .at_rest_s = params.at_rest_s,
       .recording = folder->path() / "recording.mcap",
       .stop = params.stop,
       .requests = pauses.signals(),
       .ticked = [&](const control::TickRecord& record, const simulation::ContactModel& model) {
         recorder.Tick(record, model);
         pauses.Tick(record);
       }});
  if (!result) return tl::make_unexpected(result.error().what);
  run.folder = folder;
  run.recording = folder->path() / "recording.mcap";
  for (const simulation::SceneEvent& event : result->events) recorder.SceneEvent(event.stamp, event.name);
  const bool cuts = scenario.engine != config::ScenarioEngine::kPlane;
  run.trace = recorder.Finish(
      session::EndText(result->end) + (result->diagnosis.empty() ? "" : ": " + result->diagnosis),
      result->statistics.active_ticks, cuts ? simulation::HashState(result->after) : 0);
  const control::ServoStatistics& seen = result->statistics;
  run.figures = {.peak_force_N = seen.peak_coupling_force_N,
                 .peak_hand_force_N = seen.peak_sensor_force_N,
                 .peak_tool_in_bone_mm = 1e3 * seen.peak_tool_in_bone_m,
                 .peak_tool_speed_mm_per_s = 1e3 * seen.peak_tool_speed_m_per_s,
                 .removed_mm3 = cuts ? 1e9 * result->after.removed_volume_m3 : 0.0,
                 .cutting_debt_J = cuts ? result->after.cutting_debt_J : 0.0};
  run.seconds_simulated = period_s * static_cast<double>(run.trace.ticks);
  run.seconds_wall = rt::ToSeconds(rt::MonotonicNow()) - begun_s;
  run.seconds_cpu = Cpu_s() - begun_cpu_s;
  return run;
}

std::vector<std::string> ChangedSources(const std::vector<GoldenSource>& golden,
                                        const std::vector<GoldenSource>& now) {
  std::vector<std::string> changed;
  for (const GoldenSource& source : now) {
    const auto before = std::ranges::find(golden, source.path, &GoldenSource::path);
    if (before == golden.end() || before->checksum != source.checksum) changed.push_back(source.path);
  }
  return changed;
}

}  // namespace osteon::studies
