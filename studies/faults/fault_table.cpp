#include "studies/faults/fault_table.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "safety/cell_state.h"
#include "session/process/exit_code.h"
#include "session/summary/each_fault.h"

namespace osteon::studies {
namespace {

using safety::CellState;

constexpr int kColumn = 5;  // width of a column in characters

// The letter of an expected reaction in the table; the legend below the table explains the letters.
char LetterOf(const Expected& expected) {
  switch (expected.reaction) {
    case Reaction::kGoesOn:
      return '.';
    case Reaction::kWaits:
      return 'w';
    case Reaction::kStops:
      return expected.stop == safety::StopCategory::kStop0 ? '0' : '1';
    case Reaction::kFaults:
      return 'F';
    case Reaction::kBacksOff:
      return 'b';
    case Reaction::kPauses:
      return 'p';
    case Reaction::kAlignsOn:
      return 'a';
    case Reaction::kBrakesOn:
      return '~';
    case Reaction::kRests:
      return '-';
  }
  return '?';
}

// Heading of a state's column: the first four letters of its name, or "st 1" for "stop 1".
std::string HeadingOf(CellState state) {
  const std::string name = safety::Describe(state).name;
  return name.find(' ') == std::string::npos ? name.substr(0, 4) : "st " + name.substr(name.size() - 1);
}

// JSON array of the faults' names.
nlohmann::ordered_json Names(safety::FaultSet faults) {
  nlohmann::ordered_json names = nlohmann::json::array();
  session::ForEachFault(faults,
                        [&](safety::Fault, const safety::FaultText& text) { names.push_back(text.name); });
  return names;
}

}  // namespace

std::string FaultTableText(std::span<const FaultVerdict> verdicts) {
  std::size_t width = 5;
  std::set<std::string> faults;
  for (const FaultVerdict& verdict : verdicts) {
    width = std::max(width, verdict.fault.size());
    faults.insert(verdict.fault);
  }
  std::string text = fmt::format("{:<{}} ", "fault", width);
  for (int s = 0; s < safety::kCellStates; ++s)
    text += fmt::format("{:>{}}", HeadingOf(static_cast<CellState>(s)), kColumn);
  text += "  noticed   stated     way  stated\n";
  for (auto row = verdicts.begin(); row != verdicts.end();) {
    const auto end =
        std::find_if(row, verdicts.end(), [&](const FaultVerdict& v) { return v.fault != row->fault; });
    text += fmt::format("{:<{}} ", row->fault, width);
    for (int s = 0; s < safety::kCellStates; ++s) {
      const auto cell =
          std::find_if(row, end, [&](const FaultVerdict& v) { return static_cast<int>(v.state) == s; });
      const std::string mark =
          cell == end ? "" : std::string(1, LetterOf(cell->expected)) + (cell->passed() ? "" : "!");
      text += fmt::format("{:>{}}", mark, kColumn);
    }
    // The last four columns: ticks to detection and travel while cutting, if the fault stops the cell in that
    // state.
    const auto cutting =
        std::find_if(row, end, [](const FaultVerdict& v) { return v.state == CellState::kCutting; });
    if (cutting != end && cutting->expected.reaction == Reaction::kStops)
      text += fmt::format("{:>6} ms {:>5} ms {:>5.1f} mm {:>4.1f} mm", cutting->ticks,
                          cutting->expected.ticks, 1e3 * cutting->distance_m, 1e3 * cutting->max_distance_m);
    text += "\n";
    row = end;
  }
  text +=
      "0, 1 stops, of that category   F a fault, at rest   w does not begin   b waits again\n"
      "p pauses on its path   a goes to the start, renders nothing   ~ brakes on   - stays at rest\n"
      ". goes on   ! the cell did otherwise   last four columns: while cutting\n";
  for (const FaultVerdict& verdict : verdicts)
    if (!verdict.passed())
      text +=
          fmt::format("! {}, {}: expected it {}: {}\n", verdict.fault, safety::Describe(verdict.state).name,
                      NameOf(verdict.expected.reaction), verdict.wrong);
  const auto passed = std::ranges::count_if(verdicts, &FaultVerdict::passed);
  return text + fmt::format("{} of {} as stated, {} faults\n", passed, verdicts.size(), faults.size());
}

std::string FaultTableJson(std::span<const FaultVerdict> verdicts) {
  nlohmann::ordered_json json{{"schema", "osteon.failures/1"},
                              {"passed", std::ranges::all_of(verdicts, &FaultVerdict::passed)},
                              {"scenarios", nlohmann::json::array()},
                              {"faults", nlohmann::json::array()}};
  for (const FaultVerdict& v : verdicts) {
    nlohmann::ordered_json cell{{"fault", v.fault},
                                {"state", safety::Describe(v.state).name},
                                {"expected", NameOf(v.expected.reaction)},
                                {"passed", v.passed()},
                                {"latched", Names(v.latched)},
                                {"peak_force_N", v.peak_force_N}};
    if (v.expected.reaction == Reaction::kStops || v.expected.reaction == Reaction::kFaults)
      cell.update({{"accepted_faults", Names(v.expected.faults)},
                   {"ticks", v.ticks},
                   {"stated_ticks", v.expected.ticks}});
    if (v.expected.reaction == Reaction::kStops)
      cell.update({{"stop", static_cast<int>(v.expected.stop)},
                   {"distance_mm", 1e3 * v.distance_m},
                   {"stated_distance_mm", 1e3 * v.max_distance_m}});
    if (!v.passed()) cell["wrong"] = v.wrong;
    json["faults"].push_back(std::move(cell));
  }
  return base::JsonText(json);
}

int RunFaultTable(const FaultTableOptions& options) {
  base::InstallInterrupt();
  const auto cases = FaultCases();
  base::PhaseProgress progress("osteon failures --faults", static_cast<int>(cases.size()));
  std::size_t begun = 0;
  const auto verdicts = RunFaultMatrix(cases, [&](double) {
    if (base::Interrupted()) return false;
    progress.BeginPhase(cases[begun++].name);
    return true;
  });
  progress.Done();
  fmt::print("{}", FaultTableText(verdicts));
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, FaultTableJson(verdicts)); !written) {
      fmt::print(stderr, "osteon failures: {}\n", written.error());
      return session::kFailed;
    }
  if (base::Interrupted()) return base::kExitInterrupted;
  return std::ranges::all_of(verdicts, &FaultVerdict::passed) ? 0 : session::kFailed;
}

}  // namespace osteon::studies
