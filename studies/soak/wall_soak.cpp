#include "studies/soak/wall_soak.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/read_text.h"
#include "base/work_folder.h"
#include "config/reading/load.h"
#include "safety/fault.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "studies/soak/soak_parts.h"

namespace osteon::studies {
namespace {

// Whether the script's event leaves the reaming itself undisturbed.
bool IsUndisturbed(const WallEpisode& episode) {
  return episode.event == WallEvent::kReaming || episode.event == WallEvent::kPages;
}

// Whether the episode has the ordinary length and its controller ended by itself. Only such episodes use
// comparable memory.
bool IsOrdinary(const WallResult& r) {
  return !IsKill(r.episode.event) && r.episode.event != WallEvent::kTools &&
         r.episode.event != WallEvent::kLong && r.outcome.error.empty();
}

std::string FaultName(safety::Fault fault) { return safety::Describe(fault).name; }

// Checks how controller, cell and spindle ended and which faults occurred, as the episode's event requires.
void JudgeEnd(const WallResult& r, const Require& require) {
  const WallEvent event = r.episode.event;
  const std::string faults = fmt::format("{}", fmt::join(r.faults, ", "));
  if (!IsKill(event)) {
    const std::string injected =
        event == WallEvent::kHaltedCell ? FaultName(safety::Fault::kArmStale) : std::string();
    for (const std::string& fault : r.faults)
      require(fault == injected,
              fmt::format("a fault that was not injected: {} ({}; a CPU stood still for up to {:.1f} ms)",
                          fault, r.late_text, 1e3 * rt::ToSeconds(r.outcome.cpu_stood_still)));
    require(injected.empty() || !r.faults.empty(), "no fault, injected: " + injected);
    require(r.ended == "completed", "ended: " + r.ended);
    require(r.outcome.exit == 0, fmt::format("the controller ended with {}", r.outcome.exit.value_or(-1)));
    return;
  }
  if (event == WallEvent::kControllerKill) {  // a shell shows SIGKILL as 128 + 9
    require(r.outcome.exit == 137, fmt::format("the controller ended with {}", r.outcome.exit.value_or(-1)));
  } else {
    require(r.outcome.exit == 1, fmt::format("the controller ended with {}", r.outcome.exit.value_or(-1)));
    require(!r.faults.empty(), "the controller named no fault");
  }
  if (event == WallEvent::kEngineKill)
    require(!r.faults.empty() && r.faults.front() == FaultName(safety::Fault::kModelStale),
            "not stopped for the engine, but for: " + faults);
  const bool cell_ended = r.episode.ends_life && event != WallEvent::kCellKill;
  require(!cell_ended || r.outcome.cell, "the cell left no report");
  const CellReport cell = r.outcome.cell.value_or(CellReport{});
  require(!cell.plc_permits, "the PLC permits motion still");
  require(std::abs(cell.spindle_rad_per_s) <= kSpindleStands_rad_per_s, "the spindle turns still");
}

// Checks that the recording has no gap, keeps the bounds, and agrees with the controller's summary.
void JudgeRecording(const WallResult& r, const Require& require) {
  const EpisodeFigures& figures = r.figures;
  const bool killed = r.episode.event == WallEvent::kControllerKill;
  require(killed || figures.complete, "the recording has no end");
  require(figures.missing_ticks == 0, fmt::format("the recording misses {} ticks", figures.missing_ticks));
  require(killed || (figures.ticks == r.ticks && r.dropped_records == 0),
          fmt::format("the recording has {} ticks of {}, {} records were dropped", figures.ticks, r.ticks,
                      r.dropped_records));
  RequireFigures(figures, require);
  require(figures.max_model_age_s <= kMaxModelAge_s,
          fmt::format("a contact model of {:.0f} ms was used", 1e3 * figures.max_model_age_s));
  require(figures.max_sensor_age_s <= kMaxSensorAge_s,
          fmt::format("a force of {:.0f} ms was used", 1e3 * figures.max_sensor_age_s));
  if (IsKill(r.episode.event)) return;
  require(EnergyCloses(figures, r.cutting_debt_J), EnergyText(figures, r.cutting_debt_J));
  require(figures.rest_error_m <= kMaxRestError_m,
          fmt::format("at rest {:.3f} mm from the command", 1e3 * figures.rest_error_m));
  require(std::abs(1e9 * figures.removed_m3 - r.removed_mm3) <= kMaxVolumeResidual * r.removed_mm3 + 1e-3,
          fmt::format("volume: {:.3f} mm³ in the summary, {:.3f} recorded", r.removed_mm3,
                      1e9 * figures.removed_m3));
}

// Fills in the result from the controller's summary file. A controller that was killed has left no such file.
void ReadSummary(WallResult& result) {
  const nlohmann::json json = nlohmann::json::parse(base::ReadText(result.outcome.summary), nullptr, false);
  if (!json.is_object()) return;
  result.ended = json.value("ended", "");
  result.faults = json.value("recovered_from", std::vector<std::string>());
  for (std::string& fault : json.value("faults", std::vector<std::string>()))
    result.faults.push_back(std::move(fault));
  result.ticks = json.value("ticks", std::uint64_t{0});
  result.dropped_records = json.value("dropped_records", std::uint64_t{0});
  result.removed_mm3 = json.value("removed_volume_mm3", 0.0);
  const auto wakeup = json.find("wakeup_us");
  if (wakeup != json.end() && wakeup->is_object())
    result.late_text =
        fmt::format("the loop was woken up to {:.1f} ms late", 1e-3 * wakeup->value("max", 0.0));
  for (const auto& seen : json.value("faults_seen", nlohmann::json::array()))
    if (seen.is_object()) result.late_text = seen.value("seen", "") + "; " + result.late_text;
  result.passes = json.value("passes", nlohmann::json::array()).size();
  result.cutting_debt_J = json.value("cutting_debt_J", 0.0);
  if (const auto depth = json.find("reamed_depth_mm"); depth != json.end() && depth->is_number())
    result.depth_mm = *depth;
}

// Copies the processes' folders to the folder of --out, for an episode with an error.
void KeepEvidence(const std::filesystem::path& work, const std::filesystem::path& out, const WallResult& r) {
  if (out.empty() || r.wrong.empty()) return;
  std::error_code error;
  std::filesystem::path kept = out / fmt::format("episode_{}", r.episode.index);
  // do not overwrite the folders of an earlier soak
  for (int copy = 2; std::filesystem::exists(kept, error); ++copy)
    kept = out / fmt::format("episode_{}_{}", r.episode.index, copy);
  std::filesystem::create_directories(kept, error);
  for (const char* part : {"run", "guard", "cell"})
    std::filesystem::copy(work / part, kept / part, std::filesystem::copy_options::recursive, error);
}

// Runs an episode and reads the controller's summary and recording; does not judge them.
WallResult RunEpisode(WallCell& cell, const WallEpisode& episode) {
  WallResult result{.episode = episode, .outcome = cell.Run(episode)};
  if (!result.outcome.error.empty()) return result;
  ReadSummary(result);
  const config::CellConfig config = config::LoadCell(cell.cell_file());
  if (auto figures =
          ReadEpisodeFigures(result.outcome.recording, config.servo.admittance, config.servo.period_s))
    result.figures = *figures;
  else
    result.wrong.push_back(figures.error());
  return result;
}

// Prints an episode's line. @param hours  wall time of the soak so far
void PrintWallEpisode(const WallResult& r, double hours) {
  const PartUses& use = r.outcome.use;
  fmt::print("{:>6.2f} h {:>4}  {:<50} {:>6.1f} s  {:>5.1f} N  {:>5.0f} {:>4.0f} {:>4.0f} {:>4.0f} MB  {}\n",
             hours, r.episode.index, r.episode.text, r.outcome.seconds_wall, r.figures.peak_rendered_N,
             use[0].memory_MB, use[1].memory_MB, use[2].memory_MB, use[3].memory_MB,
             r.wrong.empty() ? "" : fmt::format("WRONG: {}", fmt::join(r.wrong, "; ")));
  std::fflush(stdout);
}

nlohmann::ordered_json UsesJson(const PartUses& uses) {
  nlohmann::ordered_json json;
  for (std::size_t i = 0; i < uses.size(); ++i)
    json[kWallParts.at(i)] = {
        {"memory_MB", uses.at(i).memory_MB}, {"files", uses.at(i).files}, {"threads", uses.at(i).threads}};
  return json;
}

nlohmann::ordered_json ResultJson(const WallResult& r) {
  nlohmann::ordered_json json{
      {"index", r.episode.index},
      {"event", NameOf(r.episode.event)},
      {"text", r.episode.text},
      {"life", r.episode.life.index},
      {"loss_ratio", r.episode.life.loss_ratio},
      {"ended", r.ended},
      {"exit", r.outcome.exit ? nlohmann::ordered_json(*r.outcome.exit) : nlohmann::ordered_json()},
      {"faults", r.faults},
      {"guard_reason", r.outcome.guard_reason},
      {"plc_blocks", r.outcome.cell ? r.outcome.cell->plc_blocks : ""},
      {"seconds_rendered", r.figures.rendered_s},
      {"seconds_wall", r.outcome.seconds_wall}};
  AddFigures(json, r.figures, r.cutting_debt_J);
  json["reamed_depth_mm"] = r.depth_mm;
  json["page_messages"] = r.outcome.messages;
  json["cpu_stood_still_ms"] = 1e3 * rt::ToSeconds(r.outcome.cpu_stood_still);
  json["use"] = UsesJson(r.outcome.use);
  json["wrong"] = r.wrong;
  return json;
}

double HoursOf(std::span<const WallResult> results) {
  double wall_s = 0.0;
  for (const WallResult& r : results) wall_s += r.outcome.seconds_wall;
  return wall_s / 3600.0;
}

}  // namespace

std::vector<std::string> JudgeWallEpisode(const WallResult& r, const WallResult* first) {
  std::vector<std::string> wrong;
  if (!r.outcome.error.empty()) return {"no episode: " + r.outcome.error};
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) wrong.push_back(what);
  };
  JudgeEnd(r, require);
  JudgeRecording(r, require);
  require(r.episode.event != WallEvent::kTools || r.passes == kToolsOfPlan,
          fmt::format("{} passes, of {} reamers", r.passes, kToolsOfPlan));
  require(
      IsUndisturbed(r.episode) || r.outcome.event_done,
      "the script's event did not take place" + (r.outcome.refused.empty() ? "" : ": " + r.outcome.refused));
  for (std::size_t page = 0; page + 1 < r.outcome.messages.size(); ++page)
    require(r.outcome.messages[page] > 0, fmt::format("page {} got nothing", page + 1));
  if (!first || !IsUndisturbed(r.episode)) return wrong;
  require(
      std::abs(r.removed_mm3 - first->removed_mm3) <= kMaxVolumeDrift * first->removed_mm3,
      fmt::format("{:.0f} mm³ removed, {:.0f} by the first such episode", r.removed_mm3, first->removed_mm3));
  require(std::abs(r.depth_mm - first->depth_mm) <= kMaxDepthDrift_mm,
          fmt::format("{:.3f} mm deep, {:.3f} in the first such episode", r.depth_mm, first->depth_mm));
  return wrong;
}

UseGrowth GrowthOf(WallPart part, std::span<const WallResult> results) {
  std::vector<ProcessUse> uses;
  for (const WallResult& r : results)
    if (IsOrdinary(r)) uses.push_back(r.outcome.use.at(static_cast<std::size_t>(part)));
  std::erase_if(uses, [](const ProcessUse& use) { return use.memory_MB == 0.0; });
  const auto growth = [&](auto value, double share) {
    std::vector<double> values;
    for (const ProcessUse& use : uses) values.push_back(static_cast<double>(value(use)));
    return QuarterGrowth(values, share);
  };
  // While pages come and go, an episode has more files and threads for a moment. The minimum shows what
  // stays.
  return {.memory_MB = growth([](const ProcessUse& u) { return u.memory_MB; }, 0.5),
          .files = static_cast<int>(growth([](const ProcessUse& u) { return u.files; }, 0.0)),
          .threads = static_cast<int>(growth([](const ProcessUse& u) { return u.threads; }, 0.0))};
}

std::vector<std::string> JudgeGrowth(std::span<const WallResult> results) {
  std::vector<std::string> wrong;
  for (std::size_t i = 0; i < kWallParts.size(); ++i) {
    const UseGrowth growth = GrowthOf(static_cast<WallPart>(i), results);
    if (growth.memory_MB > kMaxMemoryGrowth_MB)
      wrong.push_back(fmt::format("{}: the memory grew by {:.1f} MB", kWallParts.at(i), growth.memory_MB));
    if (growth.files > 1 || growth.threads > 1)
      wrong.push_back(fmt::format("{}: {} open files and {} threads more", kWallParts.at(i), growth.files,
                                  growth.threads));
  }
  for (const WallResult& r : results) {
    // For a long episode, judge the growth within the episode: from the middle to the last measurement.
    const double grew_MB = r.outcome.use[0].memory_MB - r.outcome.half.memory_MB;
    if (r.episode.event == WallEvent::kLong && r.outcome.error.empty() && grew_MB > kMaxMemoryGrowth_MB)
      wrong.push_back(fmt::format("episode {}: the controller grew by {:.1f} MB in its second half",
                                  r.episode.index, grew_MB));
  }
  return wrong;
}

std::string WallSoakJson(std::span<const WallResult> results, const SoakOptions& options) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array(), growth;
  std::size_t wrong = 0;
  for (const WallResult& r : results) {
    list.push_back(ResultJson(r));
    wrong += r.wrong.empty() ? 0 : 1;
  }
  for (std::size_t i = 0; i < kWallParts.size(); ++i) {
    const UseGrowth g = GrowthOf(static_cast<WallPart>(i), results);
    growth[kWallParts.at(i)] = {{"memory_MB", g.memory_MB}, {"files", g.files}, {"threads", g.threads}};
  }
  return base::JsonText(nlohmann::ordered_json{{"schema", "osteon.soak.wall/1"},
                                               {"command", options.command_line},
                                               {"machine", session::MachineName()},
                                               {"seed", options.seed},
                                               {"seconds_wall", 3600.0 * HoursOf(results)},
                                               {"wrong_episodes", wrong},
                                               {"growth", growth},
                                               {"grows", JudgeGrowth(results)},
                                               {"episodes", list}});
}

int RunWallSoak(const SoakOptions& options) {
  if (const std::string wrong = ValidateOutputs(options); !wrong.empty()) return session::Fail("soak", wrong);
  const base::WorkFolder work("soak");
  if (work.path().empty())
    return session::Fail("soak", "cannot make a folder for what the processes write", session::kFailed);
  base::InstallInterrupt();
  WallCell cell(options.config_root, work.path(), [] { return base::Interrupted().load(); });
  std::vector<WallResult> results;
  std::optional<WallResult> first;
  fmt::print("{:>13}  {:<50} {:>8}  {:>7}  {:>5} {:>4} {:>4} {:>4} MB\n", "episode", "event", "wall", "peak",
             "run", "eng.", "gd.", "cell");
  for (int index = 0; HoursOf(results) < options.hours && !base::Interrupted(); ++index) {
    WallResult result = RunEpisode(cell, index == 0 ? FirstWallEpisode(options.seed, 3600.0 * options.hours)
                                                    : WallEpisodeAt(options.seed, index));
    if (base::Interrupted()) break;  // leave out an episode that was cut short
    for (std::string& wrong : JudgeWallEpisode(result, first ? &*first : nullptr))
      result.wrong.push_back(std::move(wrong));
    if (!result.wrong.empty()) cell.RequireNewCell();
    if (!first && IsUndisturbed(result.episode) && result.wrong.empty()) first = result;
    KeepEvidence(work.path(), options.out, result);
    results.push_back(std::move(result));
    PrintWallEpisode(results.back(), HoursOf(results));
    if (!results.back().outcome.error.empty()) break;  // stop: the same error would repeat for hours
  }
  const auto wrong = std::ranges::count_if(results, [](const WallResult& r) { return !r.wrong.empty(); });
  const std::vector<std::string> grows = JudgeGrowth(results);
  fmt::print("{} episodes, {:.2f} h: {} wrong{}\n", results.size(), HoursOf(results), wrong,
             grows.empty() ? "; nothing grew" : fmt::format("; {}", fmt::join(grows, "; ")));
  if (const std::string error =
          WriteSoakFiles(options, WallSoakJson(results, options), WallSoakPage(results, options));
      !error.empty())
    return session::Fail("soak", error, session::kFailed);
  if (base::Interrupted()) return base::InterruptExitCode();
  return wrong > 0 || !grows.empty() ? session::kFailed : 0;
}

}  // namespace osteon::studies
