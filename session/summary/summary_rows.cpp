#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"
#include "session/summary/each_fault.h"
#include "session/summary/summary.h"

namespace osteon::session {
namespace {

// Says by how much limits reduced the coupling's wrench, and whether the arm could have held the whole
// wrench.
std::string CutText(const RunSummary& s) {
  if (s.cut_ticks == 0) return "none";
  return fmt::format("up to {:.0f} %, in {} ticks; {}", 100.0 * (1.0 - s.min_wrench_share), s.cut_ticks,
                     s.arm_cut_ticks == 0 ? "the arm could have held all of it"
                                          : fmt::format("the arm could not hold up to {:.0f} %, in {} ticks",
                                                        100.0 * (1.0 - s.min_arm_share), s.arm_cut_ticks));
}

// Says which limits acted, when, and for how long.
std::string ActedText(const RunSummary& s) {
  std::string text;
  for (const ActedLimit& limit : s.acted_limits)
    text +=
        fmt::format("{}{} ({}) from {:.2f} s, {} ticks, at most {:.3f} s in a row", text.empty() ? "" : "; ",
                    limit.text, limit.name, limit.first_s, limit.ticks, limit.longest_s);
  return text.empty() ? "none" : text;
}

// Says in how many ticks each stabiliser acted, and the extremes of its factors.
std::string StabiliserText(const RunSummary& s) {
  const auto count_text = [](std::uint64_t ticks, const std::string& how) {
    return ticks == 0 ? std::string("no") : fmt::format("{} ticks{}", ticks, how);
  };
  return fmt::format(
      "age governor: {}; passivity: {}; tank: {}, {:.2f} J at least",
      count_text(s.age_governor_ticks, fmt::format(", damping × {:.1f} at most, coupling × {:.2f}",
                                                   s.max_age_damping, s.min_age_share)),
      count_text(s.passivity_ticks, ""), count_text(s.tank_ticks, ""), s.min_tank_J);
}

// Formats "median / 99th percentile / maximum µs".
std::string Text(const DurationFigures& d) {
  return fmt::format("{:.0f} / {:.0f} / {:.0f} µs", d.p50_s * 1e6, d.p99_s * 1e6, d.max_s * 1e6);
}

// Says within which tolerance the swept path was thinned; empty: it was not thinned.
std::string ThinnedText(double tolerance_m) {
  return tolerance_m > 0.0 ? fmt::format(", its path within {:.3g} µm", 1e6 * tolerance_m) : "";
}

std::string PassText(const SessionPass& pass, double diameter_mm) {
  std::string text = fmt::format("{:g} mm: {:.1f} s, {:.1f} s of it cutting; {:.0f} mm³", diameter_mm,
                                 rt::ToSeconds(pass.end - pass.begin), pass.cutting_s, pass.removed_mm3);
  if (pass.to_go_mm)
    text += fmt::format("; {:.2f} mm {} its planned depth", std::abs(*pass.to_go_mm),
                        *pass.to_go_mm < 0.0 ? "beyond" : "short of");
  return text + (pass.undone ? "; undone" : "");
}

// Adds the rows of the cut.
void AddCut(const RunSummary& s, std::vector<report::SummaryRow>& rows) {
  // without the solid (a loaded packing) the swept volume is not known
  const double excess_over_swept =
      s.swept_volume_m3 > 0.0 ? s.removed_volume_m3 / s.swept_volume_m3 - 1.0 : 0.0;
  const std::string swept =
      s.swept_volume_m3 > 0.0 ? fmt::format("; swept {:.0f} mm³ ({:+.1f} %{})", s.swept_volume_m3 * 1e9,
                                            100.0 * excess_over_swept, ThinnedText(s.swept_path_tolerance_m))
                              : "";
  rows.push_back({"Bone removed", fmt::format("{:.0f} mm³, {:.2f} g{}", s.removed_volume_m3 * 1e9,
                                              s.removed_mass_kg * 1e3, swept)});
  rows.push_back(
      {"Reamed since first touch", fmt::format("{:.2f} mm along the site's axis", s.reamed_depth_m * 1e3)});
  const auto relative_to_floor = [](double depth_m) {  // "1.20 mm below"
    return fmt::format("{:.2f} mm {}", std::abs(depth_m) * 1e3, depth_m < 0.0 ? "above" : "below");
  };
  rows.push_back(
      {"Against the first floor",
       fmt::format("tool's apex {}, carved floor {}", relative_to_floor(s.cup_depth_m),
                   s.cavity_depth_m <= -1.0 ? "carved through" : relative_to_floor(s.cavity_depth_m))});
  if (s.section.cavity_section.samples > 0)
    rows.push_back({"Cavity against swept tool",
                    fmt::format("mean {:.3f} mm, p95 {:.3f} mm", s.section.cavity_section.mean_abs_m * 1e3,
                                s.section.cavity_section.p95_m * 1e3)});
  rows.push_back({"State hash", s.state_hash});
}

std::string EngineProcessText(const EngineProcessResult& p) {
  std::string text = fmt::format("{}: {} frames, {} lost", p.where, p.counters.frames, p.counters.lost);
  if (p.counters.rejected > 0) text += fmt::format(", {} messages refused", p.counters.rejected);
  if (!p.ended.empty()) text += "; it has ended: " + p.ended;
  if (!p.unfetched.empty())
    text +=
        "; the carved state is cut again from the recording" + (p.ended.empty() ? ": " + p.unfetched : "");
  return text;
}

// Names the tools: "a hemispherical reamer 50 mm", or "the plan's tools of 44, 46, 48, 50 mm".
std::string ToolsText(const RunSummary& s) {
  if (s.diameters_mm.size() < 2) return "a " + s.tool;
  return fmt::format("the plan's tools of {:g} mm", fmt::join(s.diameters_mm, ", "));
}

// Makes "interrupted by SIGHUP; arm: …". The reason why a run never began is left out, since the verdict
// gives it.
std::string EndedText(const RunSummary& s) {
  return s.ended.substr(0, s.ended.find(": ")) + (s.ended_by.empty() ? "" : " by " + s.ended_by) +
         (s.arm_stop.empty() ? "" : "; arm: " + s.arm_stop);
}

// Adds rows that say what the cell did at each fault and how to go on, so that a user need not look it up.
void AddRemedies(const std::vector<report::FaultRow>& faults, std::vector<report::SummaryRow>& rows) {
  ForEachFault([&](safety::Fault, const safety::FaultText& text) {
    if (std::ranges::find(faults, text.name, &report::FaultRow::name) == faults.end()) return;
    const std::string prefix = faults.size() > 1 ? fmt::format("{}: ", text.name) : "";
    rows.push_back({"The cell", prefix + text.reaction});
    rows.push_back({"How to go on", prefix + text.clearing});
  });
}

}  // namespace

double ToolDiameterMm(const RunSummary& s, int tool_index) {
  return s.diameters_mm.at(static_cast<std::size_t>(tool_index));
}

std::vector<report::SummaryRow> Rows(const RunSummary& s) {
  std::vector<report::SummaryRow> rows{
      {"Ended", EndedText(s)},
      {"Engine", s.engine + " on " + s.device},
      {"Scene", fmt::format("{}: {} balls, {} mass points", s.scene, s.balls, s.points)},
      {"Packing", s.planned ? PlannedText(*s.planned) : "as the scene says, or as it was loaded"},
      {"Tool", s.diameters_mm.size() > 1 ? ToolsText(s) : s.tool},
      {"Servo loop",
       fmt::format(
           "{} ticks{}{}{}", s.ticks,
           s.servo_rate_hz > 0.0 ? fmt::format(", median {:.1f} Hz", s.servo_rate_hz) : "",
           s.virtual_time             ? " (virtual time)"
           : !s.servo_thread          ? ""
           : s.servo_thread->realtime ? ", SCHED_FIFO"
                                      : ", no SCHED_FIFO",
           s.servo_thread && s.servo_thread->cpu >= 0 ? fmt::format(", CPU {}", s.servo_thread->cpu) : "")},
      {"Simulation", fmt::format("{} frames, median {:.0f} frames/s", s.frames, s.simulation_rate_hz)}};
  if (s.engine_process)
    rows.insert(rows.begin() + 2, {"Engine's process", EngineProcessText(*s.engine_process)});
  if (s.without_plc) rows.insert(rows.begin() + 1, {"Permission to move", kWithoutPlc});
  if (s.wakeup.count > 0) {
    rows.push_back({"Tick wake-up, p50 / p99 / max", Text(s.wakeup)});
    rows.push_back({"Tick compute, p50 / p99 / max", Text(s.compute)});
    rows.push_back({"Frame, p50 / p99 / max", Text(s.frame)});
  }
  rows.push_back({"Latency", LatencyText(s.latency)});
  rows.push_back(
      {"Peak rendered force", fmt::format("{:.1f} N of {:.0f} N allowed", s.peak_force_N, s.force_limit_N)});
  rows.push_back({"Force cut off by limits", CutText(s)});
  rows.push_back({"Stabilisers acted", StabiliserText(s)});
  rows.push_back({"Limits that acted", ActedText(s)});
  if (std::isfinite(s.min_depth_left_m))
    rows.push_back({"Left to the depth limit", fmt::format("{:.2f} mm", s.min_depth_left_m * 1e3)});
  rows.push_back({"Peak sensor force", fmt::format("{:.1f} N", s.peak_sensor_force_N)});
  rows.push_back({"Deepest tool in bone", fmt::format("{:.2f} mm", s.peak_tool_in_bone_m * 1e3)});
  rows.push_back(
      {"Peak tool speed", fmt::format("{:.0f} mm/s, measured {:.0f} mm/s", s.peak_tool_speed_m_per_s * 1e3,
                                      s.peak_measured_tool_speed_m_per_s * 1e3)});
  if (s.rendered) AddCut(s, rows);
  if (s.recut)
    rows.push_back({"Bone cut again",
                    s.recut->SameAsRecorded()
                        ? std::string("as in the run")
                        : fmt::format("{:.2f} mm³ removed, {:.2f} mm³ in the run",
                                      s.recut->removed_volume_m3 * 1e9, s.recut->recorded_volume_m3 * 1e9)});
  for (const RezonedRow& row : s.rezoned) rows.push_back({fmt::format("At {:.2f} s", row.time_s), row.text});
  std::string events;
  for (const EventRow& event : s.events)
    events += fmt::format("{}{} at {:.2f} s ({:.2f} {}{})", events.empty() ? "" : "; ", event.name,
                          event.time_s, event.value, event.unit,
                          event.name == kPauseEvent    ? " until it rested"
                          : event.name == kResumeEvent ? " paused"
                                                       : "");
  if (!events.empty()) rows.push_back({"Events", events});
  if (s.min_wall_m)
    rows.push_back({"Thinnest wall left", *s.min_wall_m > 0.0 ? fmt::format("{:.2f} mm", *s.min_wall_m * 1e3)
                                                              : std::string("none: the cut is through")});
  std::string faults;
  for (const report::FaultRow& fault : s.faults)
    faults += (faults.empty() ? "" : "; ") + fault.name + (fault.seen.empty() ? "" : " (" + fault.seen + ")");
  rows.push_back({"Faults", faults.empty() ? "none" : faults});
  AddRemedies(s.faults, rows);
  if (!s.recovered_from.empty())
    rows.push_back(
        {"Recovered from", fmt::format("{}: {}, {} by an operator", fmt::join(s.recovered_from, ", "),
                                       s.recovered == 1 ? "once" : fmt::format("{} times", s.recovered),
                                       s.operator_recoveries)});
  std::string drive;
  for (const DriveFaultRow& row : s.drive_faults)
    drive += fmt::format("{}at {:.2f} s {}", drive.empty() ? "" : "; ", row.time_s, row.text);
  if (!drive.empty()) rows.push_back({"Faults of the drive", drive});
  for (const WrittenStop& stop : s.stops) {
    rows.push_back({stop.heading, stop.page.string(), stop.page.filename().string()});
    rows.push_back({"Its ticks, as a table", stop.ticks.string(), stop.ticks.filename().string()});
  }
  if (!s.session.empty()) {
    const auto undone =
        std::count_if(s.passes.begin(), s.passes.end(), [](const SessionPass& p) { return p.undone; });
    rows.push_back({"Session", s.session});
    rows.push_back({"Passes", fmt::format("{}, {} undone", s.passes.size(), undone)});
    for (const SessionPass& pass : s.passes)
      rows.push_back(
          {fmt::format("Pass {}", pass.number), PassText(pass, ToolDiameterMm(s, pass.tool_index))});
    for (const MissedChange& missed : s.missed_changes)
      rows.push_back({fmt::format("Change to {:g} mm", ToolDiameterMm(s, missed.tool_index)),
                      "not made: " + missed.reason});
  }
  rows.push_back(
      {"Recording", s.recording + (s.recording_error.empty() ? "" : ", not whole: " + s.recording_error)});
  return rows;
}

void PrintTable(const RunSummary& summary, const std::string& title) {
  fmt::print("{}: {} with {}\n", title, summary.scene, ToolsText(summary));
  PrintVerdict(summary.verdict, 30);
  constexpr std::size_t kKeyColumns = 30;
  for (const report::SummaryRow& row : Rows(summary))
    fmt::print("  {:<{}} {}\n", row.key, kKeyColumns, base::WrapForTerminal(row.value, kKeyColumns + 3));
}

}  // namespace osteon::session
