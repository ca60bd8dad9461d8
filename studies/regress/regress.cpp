#include "studies/regress/regress.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/phase_progress.h"
#include "base/read_text.h"
#include "base/write_text.h"
#include "config/reading/config_file_tracker.h"
#include "config/reading/load_scenario.h"
#include "config/reading/named_file.h"
#include "config/reading/strict/reader.h"
#include "session/process/exit_code.h"
#include "session/setup/build_name.h"
#include "session/summary/chart_files.h"
#include "studies/regress/regress_item.h"
#include "studies/regress/regress_result.h"
#include "studies/sharding/study_items.h"

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

// Checks the options before any scenario runs. @returns the error; empty if the options are right
std::string WrongOptions(const RegressOptions& options) {
  if (options.update && options.scenarios.empty() && !options.all)
    return "--update: found no scenario, accepted with the names of those that are to be accepted, or --all";
  if (options.update && options.reason.find_first_not_of(" \t\n") == std::string::npos)
    return "--update: found no reason, accepted with --reason and one: what has changed, and why that is "
           "right";
  if (!options.update && !options.reason.empty()) return "--reason: found without --update, accepted with it";
  if (options.update && !options.set.empty())
    return "--update: found with --set, accepted without: a golden trace is of what the scenario's file says";
  if (std::string wrong = ValidateSharding(options.sharding, options.json); !wrong.empty()) return wrong;
  if (std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty()) return wrong;
  for (const auto& [name, file] : {std::pair("--json", options.json), std::pair("--junit", options.junit)})
    if (std::string wrong = session::ValidateOutputFile(name, file); !wrong.empty()) return wrong;
  return "";
}

// Whether all bits are the same although a source file has changed since the golden trace was made. Such a
// trace should be renewed: otherwise later differences would be attributed to that change.
bool IsOfOtherFiles(const RegressResult& result) {
  return result.identical() && !ChangedSources(result.golden->head.sources, result.run->sources).empty();
}

// Makes the run the golden trace of later runs. @returns an error; empty if the trace was written
std::string Accept(const RegressOptions& options, RegressResult& result) {
  const auto now = std::chrono::system_clock::now();
  Golden golden{.head = {.scenario = result.scenario.name,
                         .reasons = ReadReasons(result.scenario.golden()),
                         .build = session::BuildName(),
                         .machine = session::MachineName(),
                         .engine = result.run->engine,
                         .sources = result.run->sources},
                .trace = result.run->trace};
  golden.head.reasons.push_back(
      fmt::format("{:%Y-%m-%d} commit {}: {}", fmt::gmtime(now), session::CommitName(), options.reason));
  const fs::path file = result.scenario.golden();
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  const auto written = base::WriteText(file, GoldenText(golden));
  if (!written) return written.error();
  result.updated = true;
  return "";
}

// The file in `folder` under which a scenario's recording is kept.
fs::path KeptRecording(const RegressResult& result, const fs::path& folder) {
  return folder / (result.scenario.name + ".mcap");
}

// Copies a run's recording to `folder`, and adds the command that shows it to the explanation.
void KeepRecording(RegressResult& result, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  const fs::path file = KeptRecording(result, folder);
  fs::copy_file(result.run->recording, file, fs::copy_options::overwrite_existing, error);
  result.run->folder.reset();
  if (error) return;
  result.explained.push_back(fmt::format(
      "its recording: osteon view {}; beside another build's, by two files: osteon view OTHER.mcap {}",
      file.string(), file.string()));
}

// Runs several scenarios at a time, each in one thread, the long ones first. @returns the results of those
// scenarios that this process computes, in the order of the scenarios.
std::vector<RegressResult> RunAll(const std::vector<config::ScenarioConfig>& scenarios,
                                  const RegressOptions& options, StudyItems& items) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < scenarios.size(); ++i)
    if (items.Computes(i)) order.push_back(i);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    // scenarios without bone come last, as they are fast
    const auto rank = [&](std::size_t i) {
      return std::pair(scenarios[i].engine == config::ScenarioEngine::kPlane, -scenarios[i].seconds);
    };
    return rank(a) < rank(b);
  });
  std::vector<std::optional<RegressResult>> results(scenarios.size());
  base::PhaseProgress progress("osteon regress", static_cast<int>(order.size()));
  std::atomic<std::size_t> next{0};
  const ScenarioRunParams params{
      .device = options.device, .set = options.set, .stop = &base::Interrupted(), .keep_in = options.out};
  const auto work = [&] {
    for (std::size_t i = next++; i < order.size() && !base::Interrupted(); i = next++) {
      const config::ScenarioConfig& scenario = scenarios[order[i]];
      progress.BeginPhase(scenario.name);
      const RegressResult& result = results[order[i]].emplace(RunAndCompare(scenario, params));
      if (items.IsShard()) items.Store(order[i], RegressItem(result));
    }
  };
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int jobs = std::min<int>(options.jobs > 0 ? options.jobs : cores, static_cast<int>(order.size()));
  {
    std::vector<std::jthread> threads;
    for (int i = 1; i < jobs; ++i) threads.emplace_back(work);
    work();
  }
  progress.Done();
  std::vector<RegressResult> computed;
  for (std::optional<RegressResult>& result : results)
    if (result) computed.push_back(std::move(*result));
  return computed;
}

// Reads each scenario's result from the part files that shards have written.
std::vector<RegressResult> Restore(const std::vector<config::ScenarioConfig>& scenarios,
                                   const StudyItems& items) {
  std::vector<RegressResult> results;
  for (std::size_t i = 0; i < scenarios.size(); ++i)
    results.push_back(
        items.Restore(i, [&](const nlohmann::json& item) { return RegressResultFrom(item, scenarios[i]); }));
  return results;
}

// Everything that a scenario's outcome depends on: options, and the files of scenarios, cells and golden
// traces. A file counts by its name and content, not by its folder: two machines may have the files in
// different places.
std::string InputsOf(const std::vector<config::ScenarioConfig>& scenarios,
                     const config::ConfigFileTracker& tracker, const RegressOptions& options) {
  std::string text =
      fmt::format("exact {} device {} set {}\n", options.exact, options.device, fmt::join(options.set, " "));
  const auto add = [&](const fs::path& file) {
    text += file.filename().string() + "\n" + base::ReadText(file);
  };
  for (const config::ConfigFileTracker::File& file : tracker.files()) add(file.path);
  for (const config::ScenarioConfig& scenario : scenarios) add(scenario.golden());
  return text;
}

// Writes the requested files. @returns an error that names the file.
tl::expected<void, std::string> WriteResults(const RegressSummary& summary) {
  for (const auto& [file, text] : {std::pair(summary.options.json, RegressJson(summary)),
                                   std::pair(summary.options.junit, RegressJunit(summary))})
    if (!file.empty())
      if (const auto written = base::WriteText(file, text); !written) return written;
  const auto page = WriteRegressReport(summary);
  if (!page) return tl::unexpected(page.error());
  if (!page->empty()) fmt::print("report: {}\n", page->string());
  return {};
}

}  // namespace

bool RegressResult::Passed(bool exact) const {
  return error.empty() && difference.passed && (difference.identical || !exact);
}

tl::expected<std::vector<fs::path>, std::string> FindScenarios(const fs::path& config_root,
                                                               const std::vector<std::string>& asked) {
  const fs::path folder = config_root / "scenarios";
  std::error_code error;
  std::vector<fs::path> files;
  if (asked.empty()) files = config::YamlFilesIn(folder);
  for (const std::string& name : asked) {
    const fs::path path(name);
    if (fs::is_directory(path, error)) {
      const auto inside = config::YamlFilesIn(path);
      if (inside.empty())
        return tl::make_unexpected(name + ": found a folder without scenarios, accepted *.yaml in it");
      files.insert(files.end(), inside.begin(), inside.end());
    } else if (fs::is_regular_file(path, error)) {
      files.push_back(path);
    } else if (const auto named = config::FindNamedFile(folder, name)) {
      files.push_back(*named);
    } else {
      return tl::make_unexpected(
          fmt::format("{}: found no such scenario, accepted a file, a folder, or one of {}", name,
                      config::YamlNamesIn(folder)));
    }
  }
  if (files.empty())
    return tl::make_unexpected(folder.string() + ": found no scenario there, accepted *.yaml");
  std::set<fs::path> known;
  for (const fs::path& file : files)
    if (!known.insert(fs::weakly_canonical(file, error)).second)
      return tl::make_unexpected(fmt::format("{}: found twice, accepted once", file.string()));
  return files;
}

RegressResult RunAndCompare(const config::ScenarioConfig& scenario, const ScenarioRunParams& params) {
  RegressResult result;
  result.scenario = scenario;
  try {
    auto run = RunScenario(scenario, params);
    if (!run) {
      result.error = run.error();
      return result;
    }
    result.run = std::move(*run);
  } catch (const std::exception& error) {
    result.error = error.what();
    return result;
  }
  std::error_code error;
  const fs::path file = scenario.golden();
  if (!fs::exists(file, error)) {
    result.error = fmt::format("no golden trace {} yet: osteon regress {} --update --reason \"…\" makes it",
                               file.string(), scenario.file.string());
    return result;
  }
  auto golden = ReadGolden(file);
  if (!golden) {
    result.error = golden.error();
    return result;
  }
  result.golden = std::move(*golden);
  result.difference = Compare(result.golden->trace, result.run->trace, scenario.tolerances);
  result.explained = Explain(result.difference, result.run->trace);
  if (result.identical()) {
    result.run->folder.reset();
    if (!params.keep_in.empty())
      fs::remove(KeptRecording(result, params.keep_in), error);  // remove the recording of an earlier run
    return result;
  }

  if (!params.keep_in.empty()) KeepRecording(result, params.keep_in);

  // Explain possible causes: --set, changed files, another build, another machine or engine.
  std::vector<std::string>& lines = result.explained;
  const auto changed = ChangedSources(result.golden->head.sources, result.run->sources);
  for (const std::string& assignment : params.set)
    lines.push_back(fmt::format("this run had --set {}, the golden trace has not", assignment));
  if (!changed.empty())
    lines.push_back(fmt::format("files changed since the golden trace: {}", fmt::join(changed, ", ")));
  if (result.golden->head.build != session::BuildName())
    lines.push_back(fmt::format("golden by {}; this is {}", result.golden->head.build, session::BuildName()));
  if (result.golden->head.machine != session::MachineName())
    lines.push_back(
        fmt::format("golden on {}; this is {}", result.golden->head.machine, session::MachineName()));
  if (result.golden->head.engine != result.run->engine)
    lines.push_back(
        fmt::format("golden by engine {}; this is {}", result.golden->head.engine, result.run->engine));
  return result;
}

namespace {

// Sum of the scenarios' wall times. It stands for the wall time of a run whose parts were computed elsewhere.
double SecondsOf(std::span<const RegressResult> results) {
  double seconds = 0.0;
  for (const RegressResult& result : results) seconds += result.run ? result.run->seconds_wall : 0.0;
  return seconds;
}

}  // namespace

int RunRegress(const RegressOptions& options) {
  if (const std::string wrong = WrongOptions(options); !wrong.empty()) return session::Fail("regress", wrong);
  const auto files = FindScenarios(options.config_root, options.scenarios);
  if (!files) return session::Fail("regress", files.error());
  std::vector<config::ScenarioConfig> scenarios;
  std::string inputs;
  try {
    const config::ConfigFileTracker tracker;
    for (const fs::path& file : *files) {
      scenarios.push_back(config::LoadScenario(file));
      CheckScenario(scenarios.back(), {.set = options.set});
    }
    inputs = InputsOf(scenarios, tracker, options);
  } catch (const config::ConfigError& error) {
    const std::string what = error.what();
    const bool named = options.set.empty() || what.find("--set") != std::string::npos;
    return session::Fail(
        "regress", named ? what : fmt::format("{} (with --set {})", what, fmt::join(options.set, " --set ")));
  }
  StudyItems items(options.sharding, inputs);
  if (const std::string wrong = items.Validate(scenarios.size()); !wrong.empty())
    return session::Fail("regress", wrong);

  base::InstallInterrupt();
  const auto begun = std::chrono::steady_clock::now();
  std::vector<RegressResult> results =
      items.FromParts() ? Restore(scenarios, items) : RunAll(scenarios, options, items);
  if (base::Interrupted()) return base::kExitInterrupted;
  const double seconds =
      items.FromParts() ? SecondsOf(results)
                        : std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();

  if (options.update)
    for (RegressResult& result : results)
      if (result.run && (!result.Passed(options.exact) || IsOfOtherFiles(result)))
        if (const std::string wrong = Accept(options, result); !wrong.empty())
          return session::Fail("regress", wrong, session::kFailed);

  const RegressSummary summary{.results = results, .options = options, .seconds = seconds};
  fmt::print("{}", RegressTable(summary));
  const auto written =
      items.IsShard() ? items.WritePart(options.json, scenarios.size()) : WriteResults(summary);
  if (!written) return session::Fail("regress", written.error(), session::kFailed);
  return std::ranges::all_of(results,
                             [&](const RegressResult& r) { return r.updated || r.Passed(options.exact); })
             ? 0
             : session::kFailed;
}

}  // namespace osteon::studies
