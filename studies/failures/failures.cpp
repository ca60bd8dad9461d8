#include "studies/failures/failures.h"

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "session/process/exit_code.h"
#include "session/setup/engine_choice.h"
#include "session/summary/chart_files.h"
#include "session/summary/summary.h"
#include "studies/failures/failure_item.h"
#include "studies/failures/page/failure_page.h"
#include "studies/sharding/exact_number.h"
#include "studies/sharding/study_items.h"

namespace osteon::studies {
namespace {

/// Makes the engines of our method, and stores the name of their device.
class Engines {
 public:
  explicit Engines(const FailureOptions& options)
      : choice_(session::ChooseEngine(options.engine, options.device)) {}

  std::unique_ptr<simulation::CuttingEngine> Make(const simulation::Bone& bone, const simulation::Tool& tool,
                                                  const Pose& X_WG, const simulation::CuttingParams& params) {
    auto engine = session::MakeEngine(choice_, bone, tool, X_WG, params);
    if (!engine) throw std::runtime_error(engine.error());
    device_ = (*engine)->device();
    return std::move(*engine);
  }
  [[nodiscard]] const session::EngineChoice& choice() const { return choice_; }
  [[nodiscard]] const std::string& device() const { return device_; }

 private:
  session::EngineChoice choice_;
  std::string device_;
};

/// Returns the scenarios of these numbers; an error text if a number has none.
tl::expected<std::vector<FailureScenario>, std::string> Choose(const std::vector<int>& ids) {
  const auto all = FailureScenarios();
  if (ids.empty()) return std::vector<FailureScenario>(all.begin(), all.end());
  std::vector<int> known;
  for (const FailureScenario& scenario : all) known.push_back(scenario.id);
  std::vector<FailureScenario> chosen;
  const std::set<int> wanted(ids.begin(), ids.end());
  for (const int id : wanted) {
    const auto found = std::ranges::find(all, id, &FailureScenario::id);
    if (found == all.end())
      return tl::make_unexpected(fmt::format("scenario: found {}, accepted {}", id, fmt::join(known, ", ")));
    chosen.push_back(*found);
  }
  return chosen;
}

// The outcome that the table prints for a scenario.
std::string OutcomeText(const FailureRun& run) {
  if (!run.error.empty()) return "no result";
  if (!run.result.baseline_fails) return "BASELINE DOES NOT FAIL";
  return run.result.ours_passes ? "passes" : "FAILS";
}

void PrintTable(const std::vector<FailureRun>& runs) {
  std::size_t width = 8;
  for (const FailureRun& run : runs) width = std::max(width, run.result.name.size());
  fmt::print("{:>3}  {:<{}}  {:>10}  {:>10}  {:>10}  {:<5}  {}\n", "", "scenario", width, "bound", "baseline",
             "ours", "unit", "verdict");
  for (const FailureRun& run : runs) {
    const FailureResult& r = run.result;
    if (run.error.empty())
      fmt::print("{:>3}  {:<{}}  {:>10.4g}  {:>10.4g}  {:>10.4g}  {:<5}  {}\n", r.id, r.name, width, r.bound,
                 r.baseline, r.ours, r.unit == "1" ? "" : r.unit, OutcomeText(run));
    else
      fmt::print("{:>3}  {:<{}}  {:>10}  {:>10}  {:>10}  {:<5}  {}: {}\n", r.id, r.name, width, "-", "-", "-",
                 "", OutcomeText(run), run.error);
  }
  const auto passed = std::ranges::count_if(runs, &FailureRun::passed);
  fmt::print("{} of {} kept, with their baselines seen to fail\n", passed, runs.size());
}

/// The scenarios that were run, and the engine and device of "ours".
struct Runs {
  std::vector<FailureRun> list{};
  std::string engine{}, device{};
};

/// Everything that a scenario's outcome depends on, as text.
std::string InputsOf(const std::vector<FailureScenario>& scenarios, const FailureOptions& options) {
  std::string text =
      fmt::format("engine {} device {} quick {} scenarios", options.engine, options.device, options.quick);
  for (const FailureScenario& scenario : scenarios) text += fmt::format(" {}", scenario.id);
  return text;
}

/// Runs the scenarios that this process computes. After Ctrl-C the result has the complete scenarios only.
/// @returns an error if the engine cannot run on this machine.
tl::expected<Runs, std::string> RunAll(const std::vector<FailureScenario>& scenarios,
                                       const FailureOptions& options, StudyItems& items) {
  // Try the engine with one ball first, so that an engine that cannot run here is an error and not a failed
  // scenario.
  Engines engines(options);
  simulation::Bone pebble;
  pebble.balls = {{.center_m = {}, .radius_m = 1e-3}};
  pebble.materials = {{.name = "bone"}};
  simulation::Tool probe;
  probe.balls = {{.center_m = {}, .radius_m = 1e-3, .cutting = true}};
  try {
    const auto tried = engines.Make(pebble, probe, Pose::Identity(), {});
    fmt::print(stderr, "osteon failures: engine: {}\n",
               session::EngineText(engines.choice(), tried->device()));
  } catch (const std::exception& error) {
    return tl::unexpected(std::string(error.what()));
  }

  std::vector<std::size_t> computed_items;
  for (std::size_t i = 0; i < scenarios.size(); ++i)
    if (items.Computes(i)) computed_items.push_back(i);
  Runs runs{.list = {}, .engine = engines.choice().engine};
  base::PhaseProgress progress("osteon failures", static_cast<int>(computed_items.size()));
  for (const std::size_t item : computed_items) {
    const FailureScenario& scenario = scenarios[item];
    progress.BeginPhase(fmt::format("{} {}", scenario.id, scenario.name));
    const double begun_s = rt::ToSeconds(rt::MonotonicNow());
    FailureRun run;
    try {
      run.result = scenario.run({.make_engine =
                                     [&engines](const simulation::Bone& bone, const simulation::Tool& tool,
                                                const Pose& X_WG, const simulation::CuttingParams& params) {
                                       return engines.Make(bone, tool, X_WG, params);
                                     },
                                 .size = options.quick ? FailureSize::kTest : FailureSize::kFull,
                                 .progress = [](double) { return !base::Interrupted(); }});
    } catch (const std::exception& error) {
      run.error = error.what();
    }
    run.result.id = scenario.id;
    run.result.name = scenario.name;
    run.seconds = rt::ToSeconds(rt::MonotonicNow()) - begun_s;
    if (base::Interrupted()) break;  // leave the incomplete scenario out
    if (items.IsShard())
      items.Store(item,
                  {{"engine", runs.engine}, {"device", engines.device()}, {"scenario", FailureItem(run)}});
    runs.list.push_back(std::move(run));
  }
  progress.Done();
  runs.device = engines.device();
  return runs;
}

/// Reads the outcomes of all `count` scenarios from the part files of a study that was split over machines.
Runs Restore(const StudyItems& items, std::size_t count) {
  Runs runs;
  for (std::size_t i = 0; i < count; ++i) {
    runs.list.push_back(items.Restore(i, [&](const nlohmann::json& item) {
      std::string engine, device;
      ReadAt(item, "engine", engine);
      ReadAt(item, "device", device);
      AddName(runs.engine, engine);
      AddName(runs.device, device);
      return FailureRunFrom(item.at("scenario"));
    }));
  }
  return runs;
}

/// Writes a run's files. @returns an error that names the file.
tl::expected<void, std::string> WriteFiles(const FailureOptions& options, const Runs& runs) {
  if (!options.json.empty()) {
    const auto written =
        base::WriteText(options.json, FailuresJson(runs.list, runs.engine, runs.device, options.quick));
    if (!written) return written;
  }
  if (options.out.empty()) return {};
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) return tl::make_unexpected(fmt::format("--out {}: {}", options.out.string(), error.message()));
  std::vector<FailurePageEntry> entries;
  for (const FailureRun& run : runs.list)
    entries.push_back(
        {.result = run.result, .passed = run.passed(), .error = run.error, .seconds = run.seconds});
  const FailurePageHead head{.engine = runs.engine,
                             .device = runs.device,
                             .command_line = options.command_line,
                             .version = OSTEON_VERSION,
                             .quick = options.quick};
  if (auto written = WriteFailurePage(entries, head, options.out); !written) return written;
  if (options.markdown.empty()) return {};
  const auto from = std::filesystem::absolute(options.markdown).parent_path();
  const auto pictures = std::filesystem::absolute(options.out).lexically_proximate(from);
  return base::WriteText(options.markdown, FailureMarkdown(entries, head, pictures.generic_string()));
}

/// @returns the first error of the options; empty if there is none
std::string WrongOptions(const FailureOptions& options) {
  if (std::string wrong = ValidateSharding(options.sharding, options.json); !wrong.empty()) return wrong;
  if (std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty()) return wrong;
  if (std::string wrong = session::ValidateParentFolder("--json", options.json); !wrong.empty()) return wrong;
  return session::ValidateParentFolder("--markdown", options.markdown);
}

}  // namespace

std::string FailuresJson(const std::vector<FailureRun>& runs, const std::string& engine,
                         const std::string& device, bool quick) {
  nlohmann::json json{{"schema", "osteon.failures/1"},
                      {"engine", engine},
                      {"device", device},
                      {"size", quick ? "quick" : "full"},
                      {"passed", std::ranges::all_of(runs, &FailureRun::passed)},
                      {"scenarios", nlohmann::json::array()}};
  for (const FailureRun& run : runs) {
    const FailureResult& r = run.result;
    nlohmann::json scenario{
        {"id", r.id}, {"name", r.name}, {"seconds", run.seconds}, {"passed", run.passed()}};
    if (run.error.empty()) {
      scenario.update({{"metric", r.metric},
                       {"unit", r.unit},
                       {"bound", r.bound},
                       {"baseline", r.baseline},
                       {"baseline_name", r.baseline_name},
                       {"ours", r.ours},
                       {"baseline_fails", r.baseline_fails},
                       {"ours_passes", r.ours_passes},
                       {"note", r.note}});
    } else {
      scenario["error"] = run.error;
    }
    json["scenarios"].push_back(std::move(scenario));
  }
  return base::JsonText(json);
}

int RunFailures(const FailureOptions& options) {
  if (const std::string wrong = WrongOptions(options); !wrong.empty())
    return session::Fail("failures", wrong);
  const auto chosen = Choose(options.ids);
  if (!chosen) return session::Fail("failures", chosen.error());
  StudyItems items(options.sharding, InputsOf(*chosen, options));
  if (const std::string wrong = items.Validate(chosen->size()); !wrong.empty())
    return session::Fail("failures", wrong);

  base::InstallInterrupt();
  Runs runs;
  if (items.FromParts()) {
    runs = Restore(items, chosen->size());
  } else if (auto computed = RunAll(*chosen, options, items)) {
    runs = std::move(*computed);
  } else {
    return session::Fail("failures", computed.error());
  }

  if (!runs.list.empty()) PrintTable(runs.list);
  if (items.IsShard()) {
    if (base::Interrupted()) return base::kExitInterrupted;
    if (const auto written = items.WritePart(options.json, chosen->size()); !written)
      return session::Fail("failures", written.error(), session::kFailed);
  } else if (const auto written = WriteFiles(options, runs); !written) {
    return session::Fail("failures", written.error(), session::kFailed);
  }
  if (base::Interrupted()) return base::kExitInterrupted;
  if (!options.out.empty() && !items.IsShard())
    fmt::print("report: {}\n", (options.out / "failures.html").string());
  return std::ranges::all_of(runs.list, &FailureRun::passed) ? 0 : session::kFailed;
}

}  // namespace osteon::studies
