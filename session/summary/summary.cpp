#include "session/summary/summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "config/reading/apply_identified.h"
#include "hil/fri/fri_stop.h"
#include "session/procedure/procedure_session.h"
#include "session/setup/config_checksum.h"
#include "session/setup/setup_warnings.h"
#include "session/summary/assumed_figures.h"
#include "session/summary/each_fault.h"
#include "session/summary/fault_seen.h"
#include "simulation/engine/state_hash.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/removal/swept_volume.h"

namespace osteon::session {
namespace {

// Edge of a cell of the grid that measures the swept volume: kSweepCell_m, but for a small tool only so much
// that its first ball's radius spans kSweepCellsPerRadius cells.
constexpr double kSweepCell_m = 0.4e-3, kSweepCellsPerRadius = 25.0;

// Rate from the intervals: 1 / median [Hz]; 0 without intervals.
double MedianRate_hz(const report::DurationCounts& steps) {
  const double step_s = steps.count() > 0 ? rt::ToSeconds(steps.At(steps.count() / 2)) : 0.0;
  return step_s > 0.0 ? 1.0 / step_s : 0.0;
}

// Makes a row for each fault: when it first appeared, and what was measured then.
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

// Makes the rows of the events of scene, pauses and deflections, in the order of their times, which count
// from `start`.
std::vector<EventRow> EventRows(const std::vector<simulation::SceneEvent>& events, const RunAccumulator& run,
                                rt::Nanoseconds start) {
  std::vector<EventRow> rows;
  for (const simulation::SceneEvent& event : events)
    rows.push_back({.name = event.name,
                    .time_s = rt::ToSeconds(event.stamp - start),
                    .value = 1e3 * event.value,  // all values are lengths
                    .unit = "mm"});
  for (const auto* run_rows : {&run.pauses.rows(), &run.deflections.rows()})
    rows.insert(rows.end(), run_rows->begin(), run_rows->end());
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

// Fills in the figures of ticks and frames. @param timed  whether durations were measured (wall time)
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
  s.servo_rate_hz = MedianRate_hz(active.step);
  s.seconds = active.first ? rt::ToSeconds(active.stopped_at - *active.first) : 0.0;
  s.simulation_rate_hz = MedianRate_hz(run.frame_step);
  s.link = run.last_input;
  if (!timed) return;
  s.wakeup = Quantiles(active.wakeup);
  s.compute = Quantiles(active.compute);
  s.frame = Quantiles(run.curves.frame);
}

// Fills in the figures of the cut: removed and swept volume, work, depths, hash of the carved state.
void SummariseCut(const CellSetup& setup, const simulation::CarvedState& after, const RunAccumulator& run,
                  RunSummary& s) {
  const simulation::Tool& tool = setup.config.tool.tool;
  s.removed_volume_m3 = after.removed_volume_m3;
  s.removed_mass_kg = after.removed_mass_kg;
  s.cutting_work_J = after.cutting_work_J;
  s.cutting_debt_J = after.cutting_debt_J;
  if (setup.solid) {  // a loaded packing has only balls: its swept volume is not known
    const double cell_m = std::min(kSweepCell_m, tool.balls.front().radius_m / kSweepCellsPerRadius);
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
  s.state_hash = simulation::HashText(after);
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
  const auto quantile_s = [&](double share) {
    return rt::ToSeconds(
        durations.At(std::min(count - 1, static_cast<std::uint64_t>(share * static_cast<double>(count)))));
  };
  return {.count = count,
          .p50_s = quantile_s(0.5),
          .p99_s = quantile_s(0.99),
          .p999_s = quantile_s(0.999),
          .max_s = rt::ToSeconds(durations.At(count - 1))};
}

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
    s.missed_changes = file.missed_changes;
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
  s.events = EventRows(result.events, run, start);
  s.min_wall_m = result.min_wall_m;
  s.planned = setup.planned;
  s.rezoned = RezonedRows(result.rezoned, start);
  s.assumptions = AssumedFigures(setup.config, setup.bone.materials);
  if (params.cell || params.virtual_time)
    for (std::string& line : AssumedOfSimulation(setup.config)) s.assumptions.push_back(std::move(line));
  s.identified = config::IdentifiedText(setup.config);
  s.deflected = run.deflected;
  s.noticed_deflection_m = setup.config.servo.compliance.noticed_m;
  s.cell_report = result.cell_report;
  const nlohmann::json cell = nlohmann::json::parse(result.cell_report, nullptr, false);
  if (cell.is_object() && cell.contains("arm")) s.arm_stop = cell["arm"].value("stop", "");
  // not the reason of the end: the PLC has switched off the power of an arm that was already at rest
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
  // if the stop flag is set without a signal or an operator's stop, the simulated cell has died
  const bool interrupted = result.end == control::RunEnd::kStopFlag && base::InterruptName()[0] != '\0';
  const bool done = result.end == control::RunEnd::kSeconds && !result.faults.Any();
  const int code = interrupted ? base::InterruptExitCode() : done ? 0 : 1;
  return code == 0 && result.operator_recoveries > 0 ? 1 : code;
}

}  // namespace osteon::session
