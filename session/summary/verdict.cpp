#include "session/summary/verdict.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include <fmt/color.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/text.h"
#include "session/summary/summary.h"

namespace osteon::session {
namespace {

// A limit that acts for a shorter time, a few ticks, cannot be felt by the hand.
constexpr double kMinFelt_s = 0.02;
// Fractions of the rendering time in which an old model, or an old reading of the sensor, reduces the force.
// Up to kWarningStaleShare, the cause is taken as the occasional delay of a shared machine; above
// kBadStaleShare, the run is bad because its force was often missing.
constexpr double kWarningStaleShare = 0.02, kBadStaleShare = 0.2;

// Judges how the run ended: by a fault, too early, or after recoveries.
void JudgeEnd(const RunSummary& s, Verdict& verdict) {
  if (!s.faults.empty()) {
    std::string names;
    for (const report::FaultRow& fault : s.faults) names += (names.empty() ? "" : ", ") + fault.name;
    verdict.Add(VerdictLevel::kBad, fmt::format("it ended with a fault: {}", names));
  } else if (s.end == control::RunEnd::kStopFlag && s.wanted_s > 0.0) {
    verdict.Add(VerdictLevel::kWarning,
                fmt::format("it was interrupted after {:.1f} s of {:.1f} s", s.seconds, s.wanted_s));
  } else if (s.end != control::RunEnd::kSeconds && s.end != control::RunEnd::kStopFlag) {
    verdict.Add(VerdictLevel::kBad,
                fmt::format("it {}: {}", s.rendered ? "did not end by itself" : "never began", s.ended));
  }
  if (!s.rendered && s.end != control::RunEnd::kNeverActive)
    verdict.Add(VerdictLevel::kBad, "nothing was rendered: the arm never began to move");
  if (s.operator_recoveries > 0)
    verdict.Add(
        VerdictLevel::kBad,
        fmt::format("a fault stopped it ({}), and an operator recovered from it {}",
                    fmt::join(s.recovered_from, ", "),
                    s.operator_recoveries == 1 ? "once" : fmt::format("{} times", s.operator_recoveries)));
  if (s.recovered > s.operator_recoveries)
    verdict.Add(VerdictLevel::kWarning,
                fmt::format("rendering was interrupted by the connection and began anew {}",
                            s.recovered - s.operator_recoveries == 1
                                ? "once"
                                : fmt::format("{} times", s.recovered - s.operator_recoveries)));
}

// Warns if all passes were undone, or planned changes of tool were not made.
void JudgeSession(const RunSummary& s, Verdict& verdict) {
  if (!s.passes.empty() && std::ranges::all_of(s.passes, &SessionPass::undone))
    verdict.Add(VerdictLevel::kWarning, "no pass of the session counts: all were undone");
  if (s.missed_changes.empty()) return;
  std::string tools;
  for (const MissedChange& missed : s.missed_changes)
    tools += fmt::format("{}{:g}", tools.empty() ? "" : ", ", ToolDiameterMm(s, missed.tool_index));
  verdict.Add(
      VerdictLevel::kWarning,
      fmt::format("planned changes of tool were not made, to {} mm: {}; a longer run (--seconds) leaves "
                  "each tool more time",
                  tools, s.missed_changes.front().reason));
}

// Judges how long limits, old models, late readings and the passivity controller reduced the force.
void JudgeForce(const RunSummary& s, Verdict& verdict) {
  const double cut_s = s.period_s * static_cast<double>(s.cut_ticks);
  if (cut_s > kMinFelt_s)
    verdict.Add(
        VerdictLevel::kWarning,
        fmt::format(
            "the hand pushed beyond what may be rendered (force limit {:.0f} N) for {:.2f} s: it felt "
            "{:.0f} % of the coupling at least, and the tool went up to {:.2f} mm into bone",
            s.force_limit_N, cut_s, 100.0 * s.min_wrench_share, 1e3 * s.peak_tool_in_bone_m));
  if (s.stale_share > kWarningStaleShare)
    verdict.Add(
        s.stale_share > kBadStaleShare ? VerdictLevel::kBad : VerdictLevel::kWarning,
        fmt::format(
            "the force was faded for {:.0f} % of the time, because frames of the simulation were late",
            100.0 * s.stale_share));
  if (s.sensor_late_share > kWarningStaleShare)
    verdict.Add(VerdictLevel::kWarning,
                fmt::format("the hand's force counted in part for {:.0f} % of the time, because "
                            "readings of the sensor were late",
                            100.0 * s.sensor_late_share));
  if (s.passivity_ticks > 0)
    verdict.Add(VerdictLevel::kWarning,
                fmt::format("the passivity controller acted in {} ticks: the coupling made energy",
                            s.passivity_ticks));
}

}  // namespace

const char* NameOf(VerdictLevel level) {
  switch (level) {
    case VerdictLevel::kGood:
      return "good";
    case VerdictLevel::kWarning:
      return "look";
    case VerdictLevel::kBad:
      break;
  }
  return "bad";
}

void Verdict::Add(VerdictLevel at_least, std::string reason) {
  level = std::max(level, at_least);
  reasons.push_back(std::move(reason));
}

std::vector<report::SummaryRow> VerdictRows(const Verdict& verdict) {
  std::vector<report::SummaryRow> rows{{"Verdict", NameOf(verdict.level)}};
  for (const std::string& reason : verdict.reasons) rows.push_back({"", reason});
  return rows;
}

void PrintVerdict(const Verdict& verdict, int key_width) {
  const bool colours = isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
  const fmt::text_style style = verdict.level == VerdictLevel::kGood || !colours ? fmt::text_style{}
                                : verdict.level == VerdictLevel::kWarning
                                    ? fmt::fg(fmt::terminal_color::yellow) | fmt::emphasis::bold
                                    : fmt::fg(fmt::terminal_color::red) | fmt::emphasis::bold;
  for (const report::SummaryRow& row : VerdictRows(verdict))
    fmt::print("  {:<{}} {}\n", row.key, key_width,
               fmt::styled(base::WrapForTerminal(row.value, static_cast<std::size_t>(key_width) + 3), style));
}

std::string ResultText(const Verdict& verdict, const nlohmann::ordered_json& result) {
  nlohmann::ordered_json out{{"verdict", {{"level", NameOf(verdict.level)}, {"reasons", verdict.reasons}}}};
  out.update(result);
  return base::JsonText(out);
}

Verdict JudgeRun(const RunSummary& summary) {
  Verdict verdict;
  JudgeEnd(summary, verdict);
  JudgeForce(summary, verdict);
  JudgeSession(summary, verdict);
  for (const std::string& warning : summary.warnings) verdict.Add(VerdictLevel::kWarning, warning);
  if (summary.recut && summary.recut->Differs())
    verdict.Add(VerdictLevel::kWarning,
                fmt::format("the bone that was cut again is not the run's: {:.2f} mm³ removed, {:.2f} mm³ in "
                            "the run",
                            summary.recut->removed_volume_m3 * 1e9, summary.recut->recorded_volume_m3 * 1e9));
  if (summary.recut && summary.recut->packing_unknown)
    verdict.Add(
        VerdictLevel::kWarning,
        "the recording does not say how its bone was packed, as older ones: packed as its scene says");
  if (!summary.recording_error.empty())
    verdict.Add(VerdictLevel::kWarning,
                fmt::format("the recording is not whole: {}", summary.recording_error));
  if (summary.dropped > 0)
    verdict.Add(VerdictLevel::kWarning,
                fmt::format("{} records are missing in the recording", summary.dropped));
  return verdict;
}

}  // namespace osteon::session
