#include "studies/bench/bench_tick.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/no_alloc_scope.h"
#include "base/write_text.h"
#include "config/reading/strict/config_error.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "simulation/fidelity/frame_workload.h"
#include "studies/bench/level_cost.h"
#include "studies/bench/tick_bench.h"

namespace osteon::studies {
namespace {

// Times of a part of the tick [µs].
nlohmann::ordered_json Json(const simulation::TimeFigures& t) {
  return {{"p50", t.p50_us}, {"p95", t.p95_us}, {"p99", t.p99_us}, {"p999", t.p999_us}, {"max", t.max_us}};
}

std::string Row(std::string_view name, const simulation::TimeFigures& t) {
  return fmt::format("{:<14}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.1f}\n", name, t.p50_us, t.p95_us, t.p99_us,
                     t.p999_us, t.max_us);
}

// A number of heap calls and locks; null if this build does not count them.
nlohmann::ordered_json Allocations(int allocations) {
  return rt::NoAllocScope::Counts() ? nlohmann::ordered_json(allocations) : nlohmann::ordered_json(nullptr);
}

std::string AllocationText(int allocations) {
  return rt::NoAllocScope::Counts() ? std::to_string(allocations) : "not counted here";
}

const char* PriorityText(bool realtime) { return realtime ? "SCHED_FIFO" : "no SCHED_FIFO"; }

// Writes the figures, unless the file is empty. @returns the process's exit code
int Write(const std::filesystem::path& file, const nlohmann::ordered_json& json) {
  if (file.empty()) return 0;
  const auto written = base::WriteText(file, base::JsonText(json));
  return written ? 0 : session::Fail("bench tick", written.error(), session::kFailed);
}

// Times the whole tick at each level in turn, and prints and writes the figures. The levels are those of
// compliance (LevelsOf) or, if a plan is given: no guidance, guidance at gain 0, and guidance as planned.
int RunLevels(const BenchTickOptions& options) {
  const bool guidance = !options.plan.empty();
  const std::vector<LevelCost> levels = guidance
                                            ? TimeGuidance(options.config_root, options.plan, options.ticks)
                                            : TimeLevels(options.config_root, options.ticks);
  if (base::Interrupted()) return base::kExitInterrupted;
  const std::string machine = session::MachineName();
  fmt::print("Osteon bench tick: {}, {} ticks a level in turn, {}, on {}\n\n", "cells/demo.yaml",
             options.ticks, PriorityText(levels.front().realtime), machine);
  fmt::print("{:<14}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>10}\n", "loop, us", "p50", "p95", "p99", "p999", "max",
             "added", "force, N");
  nlohmann::ordered_json rows;
  int allocations = 0;
  for (const LevelCost& level : levels) {
    allocations += level.allocations;
    const std::string row = Row(level.name, level.loop);
    fmt::print("{}{:>9.2f}{:>10.1f}\n", row.substr(0, row.size() - 1), AddedMedian_us(level, levels.front()),
               level.force_N);
    rows[level.name] = {{"loop_us", Json(level.loop)},
                        {"tick_us", Json(level.tick)},
                        {"added_us", AddedMedian_us(level, levels.front())},
                        {"ratio", level.loop.p50_us / levels.front().loop.p50_us},
                        {"mean_force_N", level.force_N},
                        {"guided", level.guided},
                        {"allocations", Allocations(level.allocations)}};
  }
  if (guidance) fmt::print("guidance acts in {:.0f} % of the guided ticks\n", 1e2 * levels.back().guided);
  fmt::print("heap calls and locks: {}\n", AllocationText(allocations));
  return Write(options.json, {{"schema", "osteon.bench.tick_levels/1"},
                              {"subcommand", "bench tick"},
                              {"cell", "cells/demo.yaml"},
                              {"plan", guidance ? nlohmann::ordered_json(options.plan.stem().string())
                                                : nlohmann::ordered_json(nullptr)},
                              {"ticks", options.ticks},
                              {"levels", rows},
                              {"realtime_priority", levels.front().realtime},
                              {"machine", machine}});
}

// Runs the subcommand, except that it throws if it fails.
int Run(const BenchTickOptions& options) {
  base::InstallInterrupt();
  if (options.compliance || !options.plan.empty()) return RunLevels(options);
  const config::CellConfig cell = BenchCell(options.config_root);
  TickBench bench(cell, ScriptSeconds(cell, options.ticks));
  const TickTimes times = std::move(TimeInTurn({&bench, 1}, options.ticks).front());
  if (base::Interrupted()) return base::kExitInterrupted;
  if (times.tick.size() < options.ticks)
    return session::Fail("bench tick", TooFewText(times.tick.size(), options.ticks, bench), session::kFailed);

  const std::string machine = session::MachineName();
  fmt::print("Osteon bench tick: {}, {} ticks at {:.0f} N, {}, on {}\n\n{:<14}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
             "cells/demo.yaml", options.ticks, times.force_N, PriorityText(times.realtime), machine, "us",
             "p50", "p95", "p99", "p999", "max");
  nlohmann::ordered_json stages;
  const simulation::TimeFigures tick = simulation::FiguresOf(times.tick);
  fmt::print("{}", Row("tick", tick));
  for (std::size_t i = 0; i < TickTimes::kStages.size(); ++i) {
    const auto figures = simulation::FiguresOf(times.stages[i]);
    fmt::print("{}", Row(fmt::format("  {}", TickTimes::kStages[i]), figures));
    stages[TickTimes::kStages[i]] = Json(figures);
  }
  const simulation::TimeFigures bare = simulation::FiguresOf(times.bare);
  fmt::print("{}", Row("kernel alone", bare));
  fmt::print("of the loop, on the same inputs\n");
  for (std::size_t i = 0; i < TickParts::kCount; ++i) {
    const auto figures = simulation::FiguresOf(times.parts[i]);
    fmt::print("{}", Row(fmt::format("    {}", TickParts::kNames[i]), figures));
    stages[std::string(TickParts::kNames[i])] = Json(figures);
  }
  fmt::print("heap calls and locks: {}\n", AllocationText(times.allocations));

  const nlohmann::ordered_json json{{"schema", "osteon.bench.tick/1"},
                                    {"subcommand", "bench tick"},
                                    {"cell", "cells/demo.yaml"},
                                    {"ticks", options.ticks},
                                    {"contacts", simulation::kMaxContacts},
                                    {"contacts_pressing_mean", times.pressing},
                                    {"mean_force_N", times.force_N},
                                    {"tick_us", Json(tick)},
                                    {"stage_us", stages},
                                    {"kernel_alone_us", Json(bare)},
                                    {"allocations", Allocations(times.allocations)},
                                    {"realtime_priority", times.realtime},
                                    {"machine", machine}};
  return Write(options.json, json);
}

}  // namespace

int RunBenchTick(const BenchTickOptions& options) {
  try {
    return Run(options);
  } catch (const config::ConfigError& error) {
    return session::Fail("bench tick", error.what());
  } catch (const std::exception& error) {
    return session::Fail("bench tick", error.what(), session::kFailed);
  }
}

}  // namespace osteon::studies
