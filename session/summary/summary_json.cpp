#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/units.h"
#include "session/summary/summary.h"

namespace osteon::session {
namespace {

// Makes the JSON of a duration's figures, in microseconds.
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

// Makes the JSON of the largest displacements; null if the cell is rigid.
nlohmann::ordered_json DeflectionJson(const PeakDeflection& peak, double noticed_m) {
  if (!peak.present) return nullptr;
  return {{"peak_bend_mm", 1e3 * peak.bend_m},
          {"peak_layer_mm", 1e3 * peak.layer_m},
          {"peak_mount_mm", 1e3 * peak.mount_m},
          {"peak_mount_deg", peak.mount_rad / kDegree},
          {"error_mm", 1e3 * noticed_m}};
}

}  // namespace

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
      {"cutting_debt_J", s.cutting_debt_J},
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
      {"identified", s.identified},
      {"recording", s.recording},
      {"recording_error",
       s.recording_error.empty() ? nlohmann::json(nullptr) : nlohmann::json(s.recording_error)}};
  out["events"] = events;
  out["deflection"] = DeflectionJson(s.deflected, s.noticed_deflection_m);
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
  if (s.recut)
    out["recut"] = {{"removed_volume_mm3", s.recut->removed_volume_m3 * 1e9},
                    {"recorded_volume_mm3", s.recut->recorded_volume_m3 * 1e9},
                    {"same", s.recut->SameAsRecorded()},
                    {"packing_unknown", s.recut->packing_unknown}};
  nlohmann::json stops = nlohmann::json::array();
  nlohmann::json stop_ticks = nlohmann::json::array();
  for (const WrittenStop& stop : s.stops) {
    stops.push_back(stop.page.string());
    stop_ticks.push_back(stop.ticks.string());
  }
  out["stops"] = stops;
  out["stop_ticks"] = stop_ticks;
  out["min_wall_mm"] = s.min_wall_m ? nlohmann::json(*s.min_wall_m * 1e3) : nlohmann::json(nullptr);
  out["least_wall_mm"] = out["min_wall_mm"];  // the old name of this key, kept for programs that read it
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
           {"tool_diameter_mm", ToolDiameterMm(s, pass.tool_index)},
           {"time_s", rt::ToSeconds(pass.end - pass.begin)},
           {"to_go_mm", pass.to_go_mm ? nlohmann::json(*pass.to_go_mm) : nlohmann::json()},
           {"cutting_s", pass.cutting_s},
           {"removed_mm3", pass.removed_mm3},
           {"state", pass.state},
           {"state_hash", pass.state_hash},
           {"undone", pass.undone}});
    out["missed_changes"] = nlohmann::json::array();
    for (const MissedChange& missed : s.missed_changes)
      out["missed_changes"].push_back({{"tool_index", missed.tool_index},
                                       {"tool_diameter_mm", ToolDiameterMm(s, missed.tool_index)},
                                       {"reason", missed.reason}});
  }
  return base::JsonText(out);
}

}  // namespace osteon::session
