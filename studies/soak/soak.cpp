#include "studies/soak/soak.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "config/reading/load.h"
#include "config/reading/load_scenario.h"
#include "config/reading/strict/overlay.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "studies/regress/scenario_run.h"
#include "studies/soak/soak_page.h"
#include "studies/soak/soak_parts.h"

namespace osteon::studies {
namespace {

// Time for which the arm is still recorded after it has come to rest. A servo of 15 Hz reaches its command
// within about 0.1 s.
constexpr double kAtRest_s = 0.5;

// Resident memory of this process.
double ResidentMemory_MB() {
  std::ifstream statm("/proc/self/statm");
  double whole = 0.0, resident = 0.0;  // in pages
  statm >> whole >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

// Names of the faults that occurred, from the trace's events: "fault force sensor stale".
std::vector<std::string> FaultsOf(const ScenarioTrace& trace) {
  constexpr std::string_view kFault = "fault ";
  std::vector<std::string> faults;
  for (const TraceEvent& event : trace.events)
    if (event.what.starts_with(kFault)) faults.push_back(event.what.substr(kFault.size()));
  return faults;
}

// Runs an episode in virtual time and reads its recording. @returns an error if the episode could not run.
tl::expected<EpisodeResult, std::string> RunEpisode(const SoakOptions& options, const Episode& episode,
                                                    const std::atomic<bool>* stop) {
  config::ScenarioConfig scenario =
      config::LoadScenario(options.config_root / "scenarios" / "reaming_lbr.yaml");
  scenario.seconds = episode.seconds;
  scenario.sample_s = 1.0;
  if (episode.kind == EpisodeKind::kRecovery) scenario.recoveries = 1;
  if (episode.kind == EpisodeKind::kPause) {
    scenario.pause_s = episode.pause_s;
    scenario.resume_s = episode.resume_s;
  }
  const auto run = RunScenario(scenario, {.set = episode.set, .stop = stop, .at_rest_s = kAtRest_s});
  if (!run) return tl::make_unexpected(run.error());
  const config::CellConfig cell = config::LoadCell(scenario.cell);
  const auto figures = ReadEpisodeFigures(run->recording, cell.servo.admittance, cell.servo.period_s);
  if (!figures) return tl::make_unexpected(figures.error());
  EpisodeResult result{.episode = episode,
                       .ended = run->trace.ended,
                       .faults = FaultsOf(run->trace),
                       .hash = run->trace.hash,
                       .figures = *figures,
                       .carved_m3 = 1e-9 * run->figures.removed_mm3,
                       .cutting_debt_J = run->figures.cutting_debt_J,
                       .seconds_simulated = run->seconds_simulated,
                       .seconds_wall = run->seconds_wall};
  if (figures->ticks != run->trace.ticks)
    result.wrong.push_back(fmt::format("the recording has {} ticks of {}", figures->ticks, run->trace.ticks));
  return result;
}

nlohmann::ordered_json EpisodeJson(const EpisodeResult& r) {
  nlohmann::ordered_json json{{"index", r.episode.index},
                              {"kind", NameOf(r.episode.kind)},
                              {"text", r.episode.text},
                              {"ended", r.ended},
                              {"faults", r.faults},
                              {"hash", fmt::format("{:016x}", r.hash)},
                              {"seconds_simulated", r.seconds_simulated},
                              {"seconds_wall", r.seconds_wall},
                              {"memory_MB", r.memory_MB}};
  AddFigures(json, r.figures, r.cutting_debt_J);
  json["wrong"] = r.wrong;
  return json;
}

// Prints an episode's line. @param simulated_s  virtual time of the soak so far
void PrintEpisode(const EpisodeResult& r, double simulated_s) {
  fmt::print("{:>6.2f} h {:>5}  {:<44} {:<12} {:>7.1f} MB  momentum {:>6.3f} %  energy {:>+6.2f} %  {}\n",
             simulated_s / 3600.0, r.episode.index, r.episode.text, r.ended, r.memory_MB,
             100.0 * r.figures.momentum_residual, 100.0 * r.energy_residual(),
             r.wrong.empty() ? "" : fmt::format("WRONG: {}", fmt::join(r.wrong, "; ")));
  std::fflush(stdout);
}

}  // namespace

bool EnergyCloses(const EpisodeFigures& figures, double debt_J) {
  return std::abs(figures.edge_work_J - figures.cutting_work_J + debt_J) <=
         kMaxEnergyResidual * figures.cutting_work_J + kMaxEnergyOpen_J;
}

std::string EnergyText(const EpisodeFigures& figures, double debt_J) {
  return fmt::format(
      "energy: {:.1f} J of the edge for {:.1f} J of bone, of which {:.1f} J are still to be done",
      figures.edge_work_J, figures.cutting_work_J, debt_J);
}

std::vector<std::string> JudgeEpisode(const EpisodeResult& r, std::uint64_t reference_hash) {
  std::vector<std::string> wrong;
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) wrong.push_back(what);
  };
  const std::string_view injected = InjectedFault(r.episode.kind);
  for (const std::string& fault : r.faults)
    require(fault == injected, fmt::format("a fault that was not injected: {}", fault));
  require(injected.empty() || !r.faults.empty(), fmt::format("no fault, injected: {}", injected));
  require(r.ended == (EndsWithFault(r.episode.kind) ? "fault" : "completed"), "ended: " + r.ended);
  require(r.figures.complete && r.figures.missing_ticks == 0,
          fmt::format("the recording misses {} ticks{}", r.figures.missing_ticks,
                      r.figures.complete ? "" : " and its end"));
  RequireFigures(r.figures, require);
  // An arm that fell silent is no longer measured, so its error at rest is not known.
  require(r.episode.kind == EpisodeKind::kArmSilent || r.figures.rest_error_m <= kMaxRestError_m,
          fmt::format("at rest {:.3f} mm from the command", 1e3 * r.figures.rest_error_m));
  require(EnergyCloses(r.figures, r.cutting_debt_J), EnergyText(r.figures, r.cutting_debt_J));
  // An arm that fell silent ends the run at once: the last frame was then carved but not recorded.
  const double unseen_m3 = r.episode.kind == EpisodeKind::kArmSilent ? kMaxUnseenFrame_m3 : 0.0;
  const double slack_m3 = kMaxVolumeResidual * r.carved_m3;
  const double unrecorded_m3 = r.carved_m3 - r.figures.removed_m3;
  require(unrecorded_m3 >= -slack_m3 && unrecorded_m3 <= slack_m3 + unseen_m3,
          fmt::format("volume: {:.3f} mm³ carved, {:.3f} recorded", 1e9 * r.carved_m3,
                      1e9 * r.figures.removed_m3));
  if (r.episode.kind == EpisodeKind::kReference && reference_hash != 0)
    require(r.hash == reference_hash, "the reference episode drifted: other bits than the first one");
  return wrong;
}

double MemoryGrowth_MB(std::span<const EpisodeResult> episodes) {
  std::vector<double> values;
  for (const EpisodeResult& result : episodes) values.push_back(result.memory_MB);
  return QuarterGrowth(values, 0.5);
}

tl::expected<std::vector<EpisodeResult>, std::string> RunEpisodes(
    const SoakOptions& options, const std::atomic<bool>* stop,
    const std::function<void(const EpisodeResult&)>& done) {
  std::vector<EpisodeResult> episodes;
  double simulated_s = 0.0;
  std::uint64_t reference = 0;
  for (int index = 0; simulated_s < 3600.0 * options.hours && !(stop && stop->load()); ++index) {
    auto result = RunEpisode(options, EpisodeAt(options.seed, index), stop);
    if (!result) return tl::make_unexpected(fmt::format("episode {}: {}", index, result.error()));
    if (stop && stop->load()) break;  // leave out an episode that was cut short
    for (std::string& wrong : JudgeEpisode(*result, reference)) result->wrong.push_back(std::move(wrong));
    if (index == 0) reference = result->hash;
    result->memory_MB = ResidentMemory_MB();
    simulated_s += result->seconds_simulated;
    done(*result);
    episodes.push_back(std::move(*result));
  }
  return episodes;
}

std::string SoakJson(std::span<const EpisodeResult> episodes, const SoakOptions& options) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  double simulated_s = 0.0, wall_s = 0.0;
  std::size_t wrong = 0;
  for (const EpisodeResult& result : episodes) {
    list.push_back(EpisodeJson(result));
    simulated_s += result.seconds_simulated;
    wall_s += result.seconds_wall;
    wrong += result.wrong.empty() ? 0 : 1;
  }
  return base::JsonText(nlohmann::ordered_json{{"schema", "osteon.soak/1"},
                                               {"command", options.command_line},
                                               {"machine", session::MachineName()},
                                               {"seed", options.seed},
                                               {"seconds_simulated", simulated_s},
                                               {"seconds_wall", wall_s},
                                               {"wrong_episodes", wrong},
                                               {"memory_growth_MB", MemoryGrowth_MB(episodes)},
                                               {"episodes", list}});
}

int RunSoak(const SoakOptions& options) {
  if (const std::string wrong = ValidateOutputs(options); !wrong.empty()) return session::Fail("soak", wrong);
  base::InstallInterrupt();
  double simulated_s = 0.0;
  const auto episodes = RunEpisodes(options, &base::Interrupted(), [&](const EpisodeResult& result) {
    simulated_s += result.seconds_simulated;
    PrintEpisode(result, simulated_s);
  });
  if (!episodes) return session::Fail("soak", episodes.error(), session::kFailed);
  const auto wrong =
      std::ranges::count_if(*episodes, [](const EpisodeResult& r) { return !r.wrong.empty(); });
  const double growth_MB = MemoryGrowth_MB(*episodes);
  fmt::print("{} episodes, {:.2f} h simulated: {} wrong; memory grew by {:.1f} MB\n", episodes->size(),
             simulated_s / 3600.0, wrong, growth_MB);
  if (const std::string error =
          WriteSoakFiles(options, SoakJson(*episodes, options), SoakPage(*episodes, options));
      !error.empty())
    return session::Fail("soak", error, session::kFailed);
  if (base::Interrupted()) return base::InterruptExitCode();
  return wrong > 0 || growth_MB > kMaxMemoryGrowth_MB ? session::kFailed : 0;
}

}  // namespace osteon::studies
