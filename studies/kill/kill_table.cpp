#include "studies/kill/kill_table.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/phase_progress.h"
#include "base/work_folder.h"
#include "base/write_text.h"
#include "session/process/exit_code.h"

namespace osteon::studies {
namespace {

// Push of the hand; limit of the hand's force and of the rendered force.
constexpr double kPush_N = 150.0, kLimit_N = 200.0;

// Figures of one victim's trials.
struct Row {
  int times{0}, rested{0};  // number of trials, and number of those that ended at rest
  // largest values over the trials; only hand_N, coupling_N and distance_m are set
  KillResult worst;
  std::vector<double> rest_ms;  // times from the kill to rest, sorted
};

Row RowOf(KillVictim victim, std::span<const KillRun> runs) {
  Row row;
  for (const KillRun& run : runs) {
    if (run.result.victim != victim || !run.error.empty()) continue;
    const KillResult& r = run.result;
    ++row.times;
    row.rested += r.at_rest ? 1 : 0;
    row.rest_ms.push_back(r.rest_ms);
    row.worst.hand_N = std::max(row.worst.hand_N, r.hand_N);
    row.worst.coupling_N = std::max(row.worst.coupling_N, r.coupling_N);
    row.worst.distance_m = std::max(row.worst.distance_m, r.distance_m);
  }
  std::ranges::sort(row.rest_ms);
  return row;
}

}  // namespace

std::string KillTableText(std::span<const KillRun> runs) {
  std::string text = fmt::format("{:<12}{:>6}{:>9}{:>12}{:>12}{:>12}{:>10}{:>10}\n", "killed", "times",
                                 "at rest", "rest p50 ms", "worst ms", "worst mm", "hand N", "sent N");
  std::string legend;
  for (int v = 0; v < kKillVictims; ++v) {
    const auto victim = static_cast<KillVictim>(v);
    const Row row = RowOf(victim, runs);
    if (row.times == 0) continue;
    text += fmt::format("{:<12}{:>6}{:>9}{:>12.0f}{:>12.0f}{:>12.2f}{:>10.1f}{:>10.1f}\n", NameOf(victim),
                        row.times, row.rested, row.rest_ms[row.rest_ms.size() / 2], row.rest_ms.back(),
                        1e3 * row.worst.distance_m, row.worst.hand_N, row.worst.coupling_N);
    legend += fmt::format("{}: {}\n", NameOf(victim), Describe(victim));
  }
  text += legend;
  for (const KillRun& run : runs)
    if (!run.passed())
      text += fmt::format("! {}: {}\n", NameOf(run.result.victim),
                          run.error.empty() ? run.result.wrong : "no trial: " + run.error);
  int anew = 0;
  for (const KillRun& run : runs) anew += run.result.attempts - 1;
  if (anew > 0)
    text += fmt::format("{} made anew: no full contact, or stopped in order for another fault first\n", anew);
  text += fmt::format("{} of {} as they have to be: at rest, hand and rendered force {:g} N at most\n",
                      std::ranges::count_if(runs, &KillRun::passed), runs.size(), kLimit_N);
  return text;
}

std::string KillTableJson(std::span<const KillRun> runs) {
  nlohmann::ordered_json json{{"schema", "osteon.failures/1"},
                              {"passed", !runs.empty() && std::ranges::all_of(runs, &KillRun::passed)},
                              {"scenarios", nlohmann::json::array()},
                              {"push_N", kPush_N},
                              {"limit_N", kLimit_N},
                              {"kills", nlohmann::json::array()}};
  for (const KillRun& run : runs) {
    const KillResult& r = run.result;
    nlohmann::ordered_json kill{
        {"victim", NameOf(r.victim)}, {"means", Describe(r.victim)}, {"passed", run.passed()}};
    if (run.error.empty()) {
      kill.update(nlohmann::ordered_json{
          {"hand_at_kill_N", r.hand_at_kill_N},
          {"at_rest", r.at_rest},
          {"rest_ms", r.rest_ms},
          {"distance_mm", 1e3 * r.distance_m},
          {"peak_hand_N", r.hand_N},
          {"peak_force_N", r.coupling_N},
          {"plc_permits", r.permitted ? nlohmann::ordered_json(*r.permitted) : nlohmann::ordered_json()},
          {"plc_blocks", r.blocks},
          {"spindle_rad_per_s", r.spindle_rad_per_s},
          {"run_exit", r.run_exit ? nlohmann::ordered_json(*r.run_exit) : nlohmann::ordered_json()},
          {"faults", r.faults},
          {"guard", r.guard},
          {"attempts", r.attempts},
          {"wrong", r.wrong}});
    } else {
      kill["error"] = run.error;
    }
    json["kills"].push_back(std::move(kill));
  }
  return base::JsonText(json);
}

int RunKillTable(const KillTableOptions& options) {
  const base::WorkFolder scratch("kill");
  if (scratch.path().empty())
    return session::Fail("failures", "cannot make a folder for what the processes write", session::kFailed);
  try {
    WriteKillCell(options.config_root / "cells" / "thin_plate.yaml", kPush_N, kLimit_N, scratch.path());
  } catch (const std::exception& error) {
    return session::Fail("failures", error.what(), session::kFailed);
  }
  base::InstallInterrupt();
  const KillTrialParams params{.cell = scratch.path() / "cell.yaml",
                               .push_N = kPush_N,
                               .limit_N = kLimit_N,
                               .folder = scratch.path(),
                               .engine = options.engine,
                               .device = options.device,
                               .stop = [] { return base::Interrupted().load(); }};
  std::vector<KillVictim> victims = options.victims;
  if (victims.empty())
    for (int v = 0; v < kKillVictims; ++v) victims.push_back(static_cast<KillVictim>(v));
  std::vector<KillRun> runs;
  base::PhaseProgress progress("osteon failures", options.times * static_cast<int>(victims.size()));
  for (int time = 0; time < options.times && !base::Interrupted(); ++time) {
    for (const KillVictim victim : victims) {
      if (base::Interrupted()) break;
      progress.BeginPhase(fmt::format("{} {} of {}", NameOf(victim), time + 1, options.times));
      KillRun run{.result = {.victim = victim}};
      try {
        auto result = RunKillTrial(victim, params);
        if (result)
          run.result = std::move(*result);
        else
          run.error = result.error();
      } catch (const std::exception& error) {
        run.error = error.what();
      }
      if (!base::Interrupted()) runs.push_back(std::move(run));  // leave an incomplete trial out
    }
  }
  progress.Done();
  if (!runs.empty()) fmt::print("{}", KillTableText(runs));
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, KillTableJson(runs)); !written)
      return session::Fail("failures", written.error(), session::kFailed);
  if (base::Interrupted()) return base::kExitInterrupted;
  return std::ranges::all_of(runs, &KillRun::passed) ? 0 : session::kFailed;
}

}  // namespace osteon::studies
