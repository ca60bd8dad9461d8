#include "session/summary/summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/text.h"
#include "hil/fri/fri_stop.h"
#include "session/procedure/procedure_session.h"
#include "session/setup/config_checksum.h"
#include "session/setup/setup_warnings.h"
#include "session/summary/each_fault.h"
#include "session/summary/fault_seen.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/removal/swept_volume.h"

namespace osteon::session {
namespace {

// Cells of the grid that measures the swept volume.
constexpr double kSweepCell_m = 0.4e-3, kSweepCellsARadius = 25.0;

// Returns 1 / the median.
double RateOf(const report::DurationCounts& steps) {
  const double step_s = steps.count() > 0 ? rt::ToSeconds(steps.At(steps.count() / 2)) : 0.0;
  return step_s > 0.0 ? 1.0 / step_s : 0.0;
}

// Finds in the ticks when each fault first appeared.
std::vector<report::FaultRow> FaultRows(safety::FaultSet faults, const RunAccumulator& run,
                                        const control::ServoParams& servo) {
  std::vector<report::FaultRow> rows;
  ForEachFault(faults, [&](safety::Fault fault, const safety::FaultText& text) {
    report::FaultRow& row = rows.emplace_back(
        report::FaultRow{.name = text.name, .time_s = std::nan(""), .reaction = text.reaction});
    const auto first = run.first_with.find(fault);
    if (first == run.first_with.end()) return;
    row.time_s = rt::ToSeconds(first->second.stamp - *run.curves.first_tick);
    row.seen = SeenAt(fault, first->second, &servo);
  });
  return rows;
}

std::vector<EventRow> EventRows(const std::vector<simulation::SceneEvent>& events,
                                const std::vector<EventRow>& pauses, rt::Nanoseconds start) {
  std::vector<EventRow> rows;
  for (const simulation::SceneEvent& event : events)
    rows.push_back({.name = event.name,
                    .time_s = rt::ToSeconds(event.stamp - start),
                    .value = 1e3 * event.value,  // all values are lengths
                    .unit = "mm"});
  rows.insert(rows.end(), pauses.begin(), pauses.end());
  std::ranges::stable_sort(rows, {}, &EventRow::time_s);
  return rows;
}

std::vector<RezonedRow> RezonedRows(const std::vector<Rezoned>& rezoned, rt::Nanoseconds start) {
  std::vector<RezonedRow> rows;
  for (const Rezoned& change : rezoned)
    rows.push_back({.time_s = rt::ToSeconds(change.stamp - start),
                    .balls = change.bone.balls.size(),
                    .zones = change.zones,
                    .seen_us = change.seen_us,
                    .text = RezonedText(change)});
  return rows;
}

// Fills in the figures of ticks and frames.
void SummariseRecording(const RunAccumulator& run, bool timed, RunSummary& s) {
  const ActiveTicks& active = run.active;
  s.ticks = run.ticks;
  s.frames = run.frames;
  s.cut_ticks = active.cut;
  s.arm_cut_ticks = active.arm_cut;
  s.min_wrench_share = active.min_wrench_share;
  s.min_arm_share = active.min_arm_share;
  s.age_governor_ticks = active.age_governor;
  s.passivity_ticks = active.passivity;
  s.tank_ticks = active.tank;
  s.max_age_damping = active.max_age_damping;
  s.min_age_share = active.min_age_share;
  if (active.rendering > 0) {
    s.stale_share = static_cast<double>(active.stale) / static_cast<double>(active.rendering);
    s.sensor_late_share = static_cast<double>(active.sensor_late) / static_cast<double>(active.rendering);
  }
  s.servo_rate_hz = RateOf(active.step);
  s.seconds = active.first ? rt::ToSeconds(active.stopped_at - *active.first) : 0.0;
  s.simulation_rate_hz = RateOf(run.frame_step);
  s.link = run.last_input;
  if (!timed) return;
  s.wakeup = Quantiles(active.wakeup);
  s.compute = Quantiles(active.compute);
  s.frame = Quantiles(run.curves.frame);
}

// Fills in the figures of the cut.
void SummariseCut(const CellSetup& setup, const simulation::CarvedState& after, const RunAccumulator& run,
                  RunSummary& s) {
  const simulation::Tool& tool = setup.config.tool.tool;
  s.removed_volume_m3 = after.removed_volume_m3;
  s.removed_mass_kg = after.removed_mass_kg;
  s.cutting_work_J = after.cutting_work_J;
  if (setup.solid) {  // of a loaded packing only the balls are known
    const double cell_m = std::min(kSweepCell_m, tool.balls.front().radius_m / kSweepCellsARadius);
    const SessionCut* cut = run.session_cut.get();
    s.swept_volume_m3 =
        cut ? simulation::SweptVolume(*setup.solid, simulation::SweptTool(cut->paths()), cell_m)
            : simulation::SweptVolume(*setup.solid, tool, run.path.X_GP(), cell_m);
    s.swept_path_tolerance_m = cut ? cut->tolerance_m() : run.path.tolerance_m();
  }
  const simulation::ApexDepth depth(setup.bone, tool);
  s.cup_depth_m = run.cup_depth_m;
  s.reamed_depth_m = run.reamed.depth_m();
  const auto floor_m = simulation::FirstHit(simulation::LiveBalls(after), setup.bone.site.center_m,
                                            -Vector3(setup.bone.site.axis));
  s.cavity_depth_m = floor_m ? *floor_m - depth.floor_m() : -1.0;
  s.state_hash = fmt::format("{:016x}", simulation::HashState(after));
}

nlohmann::json ToJson(const DurationFigures& d) {
  return {{"p50", d.p50_s * 1e6}, {"p99", d.p99_s * 1e6}, {"p999", d.p999_s * 1e6}, {"max", d.max_s * 1e6}};
}

nlohmann::json ToJson(const std::vector<DriveFaultRow>& rows) {
  const auto code = [](std::uint16_t value) {
    return value == 0 ? nlohmann::json(nullptr) : nlohmann::json(fmt::format("0x{:04X}", value));
  };
  nlohmann::json all = nlohmann::json::array();
  for (const DriveFaultRow& row : rows)
    all.push_back({{"time_s", row.time_s},
                   {"latched", row.latched},
                   {"nmt_state", row.nmt_state},
                   {"emergency_code", code(row.emergency_code)},
                   {"error_code", code(row.error_code)},
                   {"text", row.text}});
  return all;
}

// Says how much of the wrench limits withheld from the hand.
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

// Says what the stabilisers did.
std::string StabiliserText(const RunSummary& s) {
  const auto times = [](std::uint64_t ticks, const std::string& how) {
    return ticks == 0 ? std::string("no") : fmt::format("{} ticks{}", ticks, how);
  };
  return fmt::format("age governor: {}; passivity: {}; tank: {}, {:.2f} J at least",
                     times(s.age_governor_ticks, fmt::format(", damping × {:.1f} at most, coupling × {:.2f}",
                                                             s.max_age_damping, s.min_age_share)),
                     times(s.passivity_ticks, ""), times(s.tank_ticks, ""), s.min_tank_J);
}

std::string Text(const DurationFigures& d) {
  return fmt::format("{:.0f} / {:.0f} / {:.0f} µs", d.p50_s * 1e6, d.p99_s * 1e6, d.max_s * 1e6);
}

// Says by how much a path was thinned, if it was.
std::string Thinned(double tolerance_m) {
  return tolerance_m > 0.0 ? fmt::format(", its path within {:.3g} µm", 1e6 * tolerance_m) : "";
}

double ToolOfPass(const RunSummary& s, const SessionPass& pass) {
  return s.diameters_mm.at(static_cast<std::size_t>(pass.tool_index));
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
  const double swept_share = s.swept_volume_m3 > 0.0 ? s.removed_volume_m3 / s.swept_volume_m3 - 1.0 : 0.0;
  const std::string swept = s.swept_volume_m3 > 0.0
                                ? fmt::format("; swept {:.0f} mm³ ({:+.1f} %{})", s.swept_volume_m3 * 1e9,
                                              100.0 * swept_share, Thinned(s.swept_path_tolerance_m))
                                : "";
  rows.push_back({"Bone removed", fmt::format("{:.0f} mm³, {:.2f} g{}", s.removed_volume_m3 * 1e9,
                                              s.removed_mass_kg * 1e3, swept)});
  rows.push_back(
      {"Reamed since first touch", fmt::format("{:.2f} mm along the site's axis", s.reamed_depth_m * 1e3)});
  const auto below = [](double depth_m) {
    return fmt::format("{:.2f} mm {}", std::abs(depth_m) * 1e3, depth_m < 0.0 ? "above" : "below");
  };
  rows.push_back({"Against the first floor",
                  fmt::format("tool's apex {}, carved floor {}", below(s.cup_depth_m),
                              s.cavity_depth_m <= -1.0 ? "carved through" : below(s.cavity_depth_m))});
  if (s.section.cavity_section.samples > 0)
    rows.push_back({"Cavity against swept tool",
                    fmt::format("mean {:.3f} mm, p95 {:.3f} mm", s.section.cavity_section.mean_abs_m * 1e3,
                                s.section.cavity_section.p95_m * 1e3)});
  rows.push_back({"State hash", s.state_hash});
}

}  // namespace

const char* EndText(control::RunEnd end) {
  switch (end) {
    case control::RunEnd::kSeconds:
      return "completed";
    case control::RunEnd::kStopFlag:
      return "interrupted";
    case control::RunEnd::kFault:
      return "fault";
    case control::RunEnd::kNeverActive:
      return "arm never ready";
    case control::RunEnd::kLinkClosed:
      return "link closed";
  }
  return "";
}

DurationFigures Quantiles(const report::DurationCounts& durations) {
  const std::uint64_t count = durations.count();
  if (count == 0) return {};
  const auto at = [&](double share) {
    return rt::ToSeconds(
        durations.At(std::min(count - 1, static_cast<std::uint64_t>(share * static_cast<double>(count)))));
  };
  return {.count = count,
          .p50_s = at(0.5),
          .p99_s = at(0.99),
          .p999_s = at(0.999),
          .max_s = rt::ToSeconds(durations.At(count - 1))};
}

namespace {

std::string EngineProcessText(const EngineProcessResult& p) {
  std::string text = fmt::format("{}: {} frames, {} lost", p.where, p.counters.frames, p.counters.lost);
  if (p.counters.rejected > 0) text += fmt::format(", {} messages refused", p.counters.rejected);
  if (!p.ended.empty()) text += "; it has ended: " + p.ended;
  if (!p.unfetched.empty())
    text +=
        "; the carved state is cut again from the recording" + (p.ended.empty() ? ": " + p.unfetched : "");
  return text;
}

nlohmann::ordered_json EngineProcessJson(const EngineProcessResult& p) {
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
  };
  return {{"where", p.where},
          {"frames", p.counters.frames},
          {"lost", p.counters.lost},
          {"rejected", p.counters.rejected},
          {"ended", text_or_null(p.ended)},
          {"carved_again", text_or_null(p.unfetched)}};
}

}  // namespace

RunSummary Summarise(const CellSetup& setup, const simulation::CuttingEngine& engine,
                     const CellRunParams& params, const CellRunResult& result, const RunAccumulator& run) {
  RunSummary s;
  s.engine = engine.name();
  s.device = engine.device();
  s.engine_process = result.engine_process;
  s.scene = setup.bone.name;
  s.tool = setup.config.tool.tool.name;
  s.recording = params.recording.string();
  s.recording_error = result.recording_error;
  if (params.procedure) {
    s.session = params.procedure->folder().string();
    const SessionFile file = params.procedure->File();
    s.passes = file.passes;
    s.diameters_mm = file.diameters_mm;
  }
  s.ended = EndText(result.end);
  if (!result.diagnosis.empty()) s.ended += ": " + result.diagnosis;
  if (result.end == control::RunEnd::kStopFlag) s.ended_by = base::InterruptName();
  s.console_url = params.console_url;
  s.virtual_time = params.virtual_time;
  s.end = result.end;
  s.wanted_s = params.seconds;
  s.period_s = setup.config.servo.period_s;
  s.warnings = SetupWarnings(setup.config, !params.cell && !params.virtual_time);
  if (!setup.bone_warning.empty()) s.warnings.push_back(setup.bone_warning);
  s.without_plc = !setup.config.devices.plc;
  s.servo_thread = result.servo_thread;
  s.balls = setup.bone.balls.size();
  s.points = setup.bone.points.size();
  s.rendered = result.statistics.active_ticks > 0;
  s.dropped = result.recording.dropped_ticks + result.recording.dropped_frames;
  s.peak_force_N = result.statistics.peak_coupling_force_N;
  s.peak_torque_Nm = result.statistics.peak_coupling_torque_Nm;
  s.peak_sensor_force_N = result.statistics.peak_sensor_force_N;
  s.peak_tool_speed_m_per_s = result.statistics.peak_tool_speed_m_per_s;
  s.peak_tool_in_bone_m = result.statistics.peak_tool_in_bone_m;
  s.peak_power_W = result.statistics.peak_power_W;
  s.peak_measured_tool_speed_m_per_s = result.statistics.peak_measured_tool_speed_m_per_s;
  s.min_tank_J = std::isfinite(result.statistics.min_tank_J) ? result.statistics.min_tank_J : 0.0;
  s.force_limit_N = control::ForceLimit_N(setup.config.servo);
  s.limits = EffectiveLimits(setup.config.servo);
  s.acted_limits = run.limits.Rows(setup.config.servo.period_s);
  s.min_depth_left_m = result.statistics.min_depth_left_m;
  SummariseRecording(run, !params.virtual_time, s);
  s.latency =
      run.latency.Figures(setup.config.servo.period_s, LatencyContextOf(setup.config, params.virtual_time));
  SummariseCut(setup, result.after, run, s);
  const rt::Nanoseconds start = run.curves.first_tick.value_or(0);
  s.faults = FaultRows(result.faults, run, setup.config.servo);
  s.drive_faults = run.drive_faults.rows();
  s.events = EventRows(result.events, run.pauses.rows(), start);
  s.min_wall_m = result.min_wall_m;
  s.planned = setup.planned;
  s.rezoned = RezonedRows(result.rezoned, start);
  s.assumptions = simulation::Assumptions(setup.bone.materials);
  s.cell_report = result.cell_report;
  const nlohmann::json cell = nlohmann::json::parse(result.cell_report, nullptr, false);
  if (cell.is_object() && cell.contains("arm")) s.arm_stop = cell["arm"].value("stop", "");
  // a PLC switches off the power of an arm at rest: then this is not the reason of the end
  if (s.arm_stop == hil::kNoPower && !result.faults.Has(safety::Fault::kSession)) s.arm_stop.clear();
  s.recovered = result.recovered + result.operator_recoveries;
  s.operator_recoveries = result.operator_recoveries;
  ForEachFault(result.cleared, [&](safety::Fault, const safety::FaultText& text) {
    s.recovered_from.emplace_back(text.name);
  });
  s.config_checksum = ConfigChecksum(setup.config_source);
  s.verdict = JudgeRun(s);
  return s;
}

std::vector<report::SummaryRow> Rows(const RunSummary& s) {
  std::vector<report::SummaryRow> rows{
      {"Ended", s.ended + (s.ended_by.empty() ? "" : " by " + s.ended_by) +
                    (s.arm_stop.empty() ? "" : "; arm: " + s.arm_stop)},
      {"Engine", s.engine + " on " + s.device},
      {"Scene", fmt::format("{}: {} balls, {} mass points", s.scene, s.balls, s.points)},
      {"Packing", s.planned ? PlannedText(*s.planned) : "as the scene says, or as it was loaded"},
      {"Tool", s.passes.size() > 1 ? s.tool + ", the first; the passes name the others" : s.tool},
      {"Servo loop",
       fmt::format(
           "{} ticks, median {:.1f} Hz{}{}", s.ticks, s.servo_rate_hz,
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
      rows.push_back({fmt::format("Pass {}", pass.number), PassText(pass, ToolOfPass(s, pass))});
  }
  rows.push_back(
      {"Recording", s.recording + (s.recording_error.empty() ? "" : ", not whole: " + s.recording_error)});
  return rows;
}

void PrintTable(const RunSummary& summary, const std::string& title) {
  fmt::print("{}: {} with a {}\n", title, summary.scene, summary.tool);
  PrintVerdict(summary.verdict, 30);
  constexpr std::size_t kKeyColumns = 30;
  for (const report::SummaryRow& row : Rows(summary))
    fmt::print("  {:<{}} {}\n", row.key, kKeyColumns, base::WrapForTerminal(row.value, kKeyColumns + 3));
}

void AddReason(std::string& reasons, const std::string& reason) {
  if (!reason.empty()) reasons += (reasons.empty() ? "" : "; ") + reason;
}

std::string DescribeRecordingErrors(const CellRunResult& result, const std::string& unreadable) {
  std::string why;
  AddReason(why, result.recording_error);
  AddReason(why, result.session_error);
  AddReason(why, unreadable);
  return why;
}

int ExitCode(const CellRunResult& result) {
  // without a signal or an operator's stop, the simulated cell has died
  const bool interrupted = result.end == control::RunEnd::kStopFlag && base::InterruptName()[0] != '\0';
  const bool done = result.end == control::RunEnd::kSeconds && !result.faults.Any();
  const int code = interrupted ? base::InterruptExitCode() : done ? 0 : 1;
  return code == 0 && result.operator_recoveries > 0 ? 1 : code;
}

std::string ToJson(const RunSummary& s, const std::string& schema) {
  nlohmann::json faults = nlohmann::json::array();
  nlohmann::json faults_seen = nlohmann::json::array();
  for (const report::FaultRow& fault : s.faults) {
    faults.push_back(fault.name);
    faults_seen.push_back(
        {{"name", fault.name},
         {"time_s", std::isfinite(fault.time_s) ? nlohmann::json(fault.time_s) : nlohmann::json(nullptr)},
         {"seen", fault.seen}});
  }
  nlohmann::json events = nlohmann::json::array();
  for (const EventRow& event : s.events)
    events.push_back(
        {{"time_s", event.time_s}, {"name", event.name}, {"value", event.value}, {"unit", event.unit}});
  const report::CavityError& section = s.section.cavity_section;
  nlohmann::ordered_json out{
      {"verdict", {{"level", NameOf(s.verdict.level)}, {"reasons", s.verdict.reasons}}},
      {"schema", schema},
      {"version", OSTEON_VERSION},
      {"config_checksum", s.config_checksum},
      {"engine", s.engine},
      {"device", s.device},
      {"engine_process",
       s.engine_process ? EngineProcessJson(*s.engine_process) : nlohmann::ordered_json(nullptr)},
      {"scene", s.scene},
      {"tool", s.tool},
      {"virtual_time", s.virtual_time},
      {"without_plc", s.without_plc},
      {"ended", s.ended},
      {"console", s.console_url.empty() ? nlohmann::json(nullptr) : nlohmann::json(s.console_url)},
      {"ended_by", s.ended_by.empty() ? nlohmann::json(nullptr) : nlohmann::json(s.ended_by)},
      {"recovered", s.recovered},
      {"operator_recoveries", s.operator_recoveries},
      {"recovered_from", s.recovered_from},
      {"link",
       {{"lost", s.link.lost},
        {"duplicate", s.link.duplicate},
        {"late", s.link.late},
        {"reordered", s.link.reordered},
        {"rejected", s.link.rejected},
        {"answers_lost", s.link.answers_lost},
        {"answers_foreign", s.link.answers_foreign}}},
      {"cell", s.cell_report.empty() ? nlohmann::json(nullptr)
                                     : nlohmann::json::parse(s.cell_report, nullptr, false)},
      {"seconds", s.seconds},
      {"spheres", s.balls},
      {"mass_points", s.points},
      {"ticks", s.ticks},
      {"frames", s.frames},
      {"dropped_records", s.dropped},
      {"servo_rate_hz", s.servo_rate_hz},
      {"simulation_rate_hz", s.simulation_rate_hz},
      {"peak_force_N", s.peak_force_N},
      {"peak_torque_Nm", s.peak_torque_Nm},
      {"peak_sensor_force_N", s.peak_sensor_force_N},
      {"force_limit_N", s.force_limit_N},
      {"wrench_cut_ticks", s.cut_ticks},
      {"wrench_share_min", s.min_wrench_share},
      {"arm_cut_ticks", s.arm_cut_ticks},
      {"arm_share_min", s.min_arm_share},
      {"age_governor_ticks", s.age_governor_ticks},
      {"age_damping_max", s.max_age_damping},
      {"age_wrench_share_min", s.min_age_share},
      {"passivity_ticks", s.passivity_ticks},
      {"tank_ticks", s.tank_ticks},
      {"tank_min_J", s.min_tank_J},
      {"limits", ToJson(s.limits, s.acted_limits)},
      {"depth_left_min_mm", std::isfinite(s.min_depth_left_m) ? nlohmann::json(s.min_depth_left_m * 1e3)
                                                              : nlohmann::json(nullptr)},
      {"peak_tool_speed_mm_per_s", s.peak_tool_speed_m_per_s * 1e3},
      {"peak_tool_in_bone_mm", s.peak_tool_in_bone_m * 1e3},
      {"peak_power_W", s.peak_power_W},
      {"stale_model_share", s.stale_share},
      {"latency_ms", ToJson(s.latency)},
      {"warnings", s.warnings},
      {"peak_measured_tool_speed_mm_per_s", s.peak_measured_tool_speed_m_per_s * 1e3},
      {"removed_volume_mm3", s.removed_volume_m3 * 1e9},
      {"removed_mass_g", s.removed_mass_kg * 1e3},
      {"swept_volume_mm3", s.swept_volume_m3 * 1e9},
      {"swept_path_tolerance_um", s.swept_path_tolerance_m * 1e6},
      {"cutting_work_J", s.cutting_work_J},
      {"cup_depth_mm", s.cup_depth_m * 1e3},
      {"reamed_depth_mm", s.reamed_depth_m * 1e3},
      {"cavity_depth_mm",
       s.cavity_depth_m <= -1.0 ? nlohmann::json(nullptr) : nlohmann::json(s.cavity_depth_m * 1e3)},
      {"cavity_error_mean_mm",
       section.samples > 0 ? nlohmann::json(section.mean_abs_m * 1e3) : nlohmann::json(nullptr)},
      {"cavity_error_p95_mm",
       section.samples > 0 ? nlohmann::json(section.p95_m * 1e3) : nlohmann::json(nullptr)},
      {"state_hash", s.state_hash},
      {"faults", faults},
      {"faults_seen", faults_seen},
      {"drive_faults", ToJson(s.drive_faults)},
      {"assumptions", s.assumptions},
      {"recording", s.recording},
      {"recording_error",
       s.recording_error.empty() ? nlohmann::json(nullptr) : nlohmann::json(s.recording_error)}};
  out["events"] = events;
  out["planned"] = s.planned ? PlannedJson(*s.planned) : nlohmann::json(nullptr);
  out["surface"] = s.surface ? nlohmann::json(SurfaceJson(*s.surface)) : nlohmann::json(nullptr);
  out["rezoned"] = nlohmann::json::array();
  for (const RezonedRow& row : s.rezoned)
    out["rezoned"].push_back({{"time_s", row.time_s},
                              {"spheres", row.balls},
                              {"zone_spacing_mm", row.zones.level.fine.spacing_m * 1e3},
                              {"promised_error_mm", row.zones.promised_m * 1e3},
                              {"frame_us_before", row.seen_us},
                              {"predicted_frame_us", row.zones.frame_us}});
  nlohmann::json stops = nlohmann::json::array();
  nlohmann::json stop_ticks = nlohmann::json::array();
  for (const WrittenStop& stop : s.stops) {
    stops.push_back(stop.page.string());
    stop_ticks.push_back(stop.ticks.string());
  }
  out["stops"] = stops;
  out["stop_ticks"] = stop_ticks;
  out["min_wall_mm"] = s.min_wall_m ? nlohmann::json(*s.min_wall_m * 1e3) : nlohmann::json(nullptr);
  out["least_wall_mm"] = out["min_wall_mm"];  // its older name, which stays for programs that read it
  if (s.wakeup.count > 0) {
    out["wakeup_us"] = ToJson(s.wakeup);
    out["compute_us"] = ToJson(s.compute);
    out["frame_us"] = ToJson(s.frame);
    out["realtime_priority"] = s.servo_thread->realtime;
    out["servo_cpu"] =
        s.servo_thread->cpu >= 0 ? nlohmann::json(s.servo_thread->cpu) : nlohmann::json(nullptr);
    out["memory_locked"] = s.servo_thread->memory_locked;
    out["cpus_awake"] = s.servo_thread->cpus_awake;
  }
  if (!s.arm_stop.empty()) out["arm_stop"] = s.arm_stop;
  if (!s.session.empty()) {
    out["session"] = s.session;
    out["passes"] = nlohmann::json::array();
    for (const SessionPass& pass : s.passes)
      out["passes"].push_back(
          {{"number", pass.number},
           {"tool_index", pass.tool_index},
           {"tool_diameter_mm", ToolOfPass(s, pass)},
           {"time_s", rt::ToSeconds(pass.end - pass.begin)},
           {"to_go_mm", pass.to_go_mm ? nlohmann::json(*pass.to_go_mm) : nlohmann::json()},
           {"cutting_s", pass.cutting_s},
           {"removed_mm3", pass.removed_mm3},
           {"state", pass.state},
           {"state_hash", pass.state_hash},
           {"undone", pass.undone}});
  }
  return base::JsonText(out);
}

}  // namespace osteon::session
