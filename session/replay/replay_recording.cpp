#include "session/replay/replay_recording.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/phase_progress.h"
#include "base/text.h"
#include "base/write_text.h"
#include "session/process/exit_code.h"
#include "session/replay/replay.h"
#include "session/setup/build_name.h"
#include "session/setup/recorded_config.h"
#include "session/summary/chart_files.h"

namespace osteon::session {
namespace {

// Makes a JSON number of a text; nan and inf, which JSON does not have, stay text.
nlohmann::ordered_json Number(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return text;
  return nlohmann::ordered_json::parse(text, nullptr, false);
}

nlohmann::ordered_json ToJson(const ReplayOptions& options, const io::Recording& recording,
                              const ReplayResult& result) {
  nlohmann::ordered_json json{
      {"schema", "osteon.replay/1"},
      {"recording", options.recording.string()},
      {"complete", recording.complete},
      {"end_error", recording.end_error},
      {"ticks", result.ticks},
      {"identical", result.identical},
      {"first_difference", nullptr},
      {"different_ticks", result.different_ticks},
      {"not_run_ticks", result.not_run},
      {"not_run_reason",
       result.why_not.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(result.why_not)},
      {"recorded_by", recording.session.version},
      {"recorded_build", recording.session.build},
      {"recorded_machine", recording.session.machine},
      {"replayed_by", OSTEON_VERSION},
      {"replayed_build", BuildName()},
      {"replayed_machine", MachineName()}};
  if (const auto& difference = result.first_difference)
    json["first_difference"] = {{"tick", difference->tick},
                                {"field", difference->field},
                                {"recorded", Number(difference->recorded)},
                                {"replayed", Number(difference->replayed)}};
  return json;
}

// Returns the first 200 characters of a text of the file, in a form that is safe for a terminal.
std::string PrintableStart(std::string_view text) { return base::Printable(text.substr(0, 200)); }

void PrintReplay(const ReplayOptions& options, const io::Recording& recording, const ReplayResult& result) {
  fmt::print("Osteon replay: {}\n", options.recording.string());
  fmt::print("  {:<18} {} ({})\n", "Recorded by", PrintableStart(recording.session.version),
             PrintableStart(recording.session.build));
  fmt::print("  {:<18} {}\n", "Ticks run again", result.ticks);
  if (!recording.complete)
    fmt::print("  {:<18} {} (`osteon export --recover` makes a whole one)\n", "Not whole",
               recording.end_error);
  if (result.not_run > 0)
    fmt::print("  {:<18} {}: {}{}\n", "Not run", result.not_run, result.why_not,
               result.identical ? " (the run was killed)" : "");
  if (const auto& difference = result.first_difference) {
    fmt::print("  {:<18} {} ticks\n", "Different", result.different_ticks);
    fmt::print("  {:<18} tick {}, {}: recorded {}, replayed {}\n", "First difference", difference->tick,
               difference->field, difference->recorded, difference->replayed);
    if (recording.session.build != BuildName())
      fmt::print("  {:<18} this is {}: another program may round otherwise\n", "", BuildName());
    if (recording.session.machine != MachineName())
      fmt::print("  {:<18} recorded on {}, this is {}: so may another processor\n", "",
                 PrintableStart(recording.session.machine), MachineName());
  }
  fmt::print("  {:<18} {}\n", "Verdict",
             result.identical          ? result.not_run == 0 ? "identical, bit for bit"
                                                             : "identical, bit for bit, as far as it goes"
             : result.first_difference ? "not identical"
                                       : "not shown: not every tick could be run again");
}

}  // namespace

int RunReplay(const ReplayOptions& options) {
  base::PhaseProgress progress("osteon replay", 3);
  progress.BeginPhase("reading the recording");
  const auto recording = io::ReadRecording(options.recording);
  if (!recording) return Fail("replay", recording.error());
  if (recording->ticks.empty())
    return Fail("replay", options.recording.string() + ": found no tick, accepted at least 1");
  progress.BeginPhase("reading the configuration");
  auto cell = LoadRecordedTools(recording->session.config);
  if (!cell && options.cell.empty()) return Fail("replay", options.recording.string() + ": " + cell.error());
  if (!options.cell.empty()) {
    if (!cell) cell = RecordedCell{};
    cell->config = config::LoadCell(options.cell);  // throws ConfigError, which main shows
    PrepareForTools(cell->tools, cell->config);
  }
  progress.BeginPhase("running the controller");
  const ReplayResult result = Replay(*recording, cell->config, cell->tools, cell->list.first);
  progress.Done();

  PrintReplay(options, *recording, result);
  if (!options.json.empty())
    if (const auto written =
            base::WriteText(options.json, base::JsonText(ToJson(options, *recording, result)));
        !written)
      return Fail("replay", written.error());
  return result.identical ? 0 : kFailed;
}

}  // namespace osteon::session
