#include "studies/sweep/sweep.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/interrupt.h"
#include "base/parallel.h"
#include "base/phase_progress.h"
#include "base/read_text.h"
#include "base/write_text.h"
#include "config/reading/config_file_tracker.h"
#include "config/reading/load_scenario.h"
#include "config/reading/load_sweep.h"
#include "config/reading/named_file.h"
#include "config/reading/strict/reader.h"
#include "report/page.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "studies/sharding/study_items.h"
#include "studies/sweep/sweep_page.h"
#include "studies/sweep/sweep_result.h"

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kProgressLines = 20;  // maximum number of printed lines of progress

// Returns a run's parameters: the overrides of --set, then the sweep's values for this run.
ScenarioRunParams ParamsOf(const config::SweepConfig& sweep, const SweepRun& run,
                           const SweepOptions& options) {
  ScenarioRunParams params{.device = options.device, .set = options.set, .stop = &base::Interrupted()};
  for (std::string& assignment : AssignmentsOf(sweep, run)) params.set.push_back(std::move(assignment));
  return params;
}

// Makes the run with this index. If it fails, the outcome contains the error.
SweepOutcome RunOne(const config::SweepConfig& sweep, const config::ScenarioConfig& scenario,
                    std::size_t index, const SweepOptions& options) {
  SweepOutcome outcome{.run = SweepRunAt(sweep, index)};
  try {
    const auto run = RunScenario(scenario, ParamsOf(sweep, outcome.run, options));
    if (!run) {
      outcome.error = run.error();
      return outcome;
    }
    outcome.ended = run->trace.ended;
    outcome.hash = fmt::format("{:016x}", run->trace.hash);
    outcome.figures = run->figures;
    constexpr std::string_view kFault = "fault ";
    for (const TraceEvent& event : run->trace.events)
      if (event.what.starts_with(kFault)) outcome.faults.push_back(event.what.substr(kFault.size()));
  } catch (const std::exception& error) {
    outcome.error = error.what();
  }
  return outcome;
}

// Makes all runs, or those of the shard, several in parallel. @returns their outcomes in the order of the
// runs.
std::vector<SweepOutcome> RunAll(const config::SweepConfig& sweep, const config::ScenarioConfig& scenario,
                                 const SweepOptions& options, StudyItems& items) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < sweep.Runs(); ++i)
    if (items.Computes(i)) indices.push_back(i);
  const std::size_t runs_per_line =
      std::max<std::size_t>(1, (indices.size() + kProgressLines - 1) / kProgressLines);
  base::PhaseProgress progress("osteon regress",
                               static_cast<int>((indices.size() + runs_per_line - 1) / runs_per_line));
  std::vector<SweepOutcome> outcomes(indices.size());
  simulation::ParallelFor(
      indices.size(), options.jobs,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !base::Interrupted(); ++i) {
          if (i % runs_per_line == 0) progress.BeginPhase(fmt::format("run {}", indices[i]));
          outcomes[i] = RunOne(sweep, scenario, indices[i], options);
          if (items.IsShard()) items.Store(indices[i], SweepItem(outcomes[i]));
        }
      },
      1);
  progress.Done();
  return outcomes;
}

// Everything that the runs depend on: options, and the files of sweep, scenario and cell, by name and
// content.
std::string InputsOf(const config::ConfigFileTracker& tracker, const SweepOptions& options) {
  std::string text = fmt::format("device {} set {}\n", options.device, fmt::join(options.set, " "));
  for (const config::ConfigFileTracker::File& file : tracker.files())
    text += file.path.filename().string() + "\n" + base::ReadText(file.path);
  return text;
}

// Writes JSON, CSV and page. @returns an error that names the file
tl::expected<void, std::string> WriteResults(const SweepResult& result, const SweepOptions& options) {
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, SweepJson(result)); !written) return written;
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) return tl::unexpected(fmt::format("--out {}: {}", options.out.string(), error.message()));
  if (const auto written = base::WriteText(options.out / "sweep.csv", SweepCsv(result)); !written)
    return written;
  const fs::path page = options.out / "sweep.html";
  if (const auto written = report::WritePage(SweepPage(result, options.command_line), page); !written)
    return written;
  fmt::print("report: {}\n", page.string());
  return {};
}

// Returns the error of the options; empty: there is none.
std::string WrongOptions(const SweepOptions& options) {
  if (std::string wrong = ValidateSharding(options.sharding, options.json); !wrong.empty()) return wrong;
  if (std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty()) return wrong;
  return session::ValidateOutputFile("--json", options.json);
}

}  // namespace

int RunSweep(const SweepOptions& options) {
  if (const std::string wrong = WrongOptions(options); !wrong.empty()) return session::Fail("regress", wrong);
  const fs::path folder = options.config_root / "sweeps";
  const auto file = config::FindNamedFile(folder, options.sweep);
  if (!file)
    return session::Fail(
        "regress", fmt::format("--sweep {}: found no such sweep, accepted a file or one of {}", options.sweep,
                               config::YamlNamesIn(folder)));
  SweepResult result;
  std::optional<config::ScenarioConfig> scenario;
  std::string inputs;
  try {
    const config::ConfigFileTracker tracker;
    result.config = config::LoadSweep(*file);
    scenario = config::LoadScenario(result.config.scenario);
    for (const std::size_t index : RunsWithEachValue(result.config))
      CheckScenario(*scenario, ParamsOf(result.config, SweepRunAt(result.config, index), options));
    inputs = InputsOf(tracker, options);
  } catch (const config::ConfigError& error) {
    return session::Fail("regress", fmt::format("--sweep {}: {}", file->string(), error.what()));
  }
  result.scenario = scenario->name;
  StudyItems items(options.sharding, inputs);
  if (const std::string wrong = items.Validate(result.config.Runs()); !wrong.empty())
    return session::Fail("regress", wrong);

  base::InstallInterrupt();
  if (items.FromParts())
    for (std::size_t i = 0; i < result.config.Runs(); ++i)
      result.outcomes.push_back(items.Restore(
          i, [&](const nlohmann::json& item) { return SweepOutcomeFrom(item, result.config, i); }));
  else
    result.outcomes = RunAll(result.config, *scenario, options, items);
  if (base::Interrupted()) return base::kExitInterrupted;
  fmt::print("{}", SweepTable(result));
  const auto written =
      items.IsShard() ? items.WritePart(options.json, result.config.Runs()) : WriteResults(result, options);
  if (!written) return session::Fail("regress", written.error(), session::kFailed);
  return std::ranges::all_of(result.outcomes, [](const SweepOutcome& o) { return o.error.empty(); })
             ? 0
             : session::kFailed;
}

}  // namespace osteon::studies
