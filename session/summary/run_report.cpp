#include "session/summary/run_report.h"

#include <functional>
#include <utility>
#include <vector>

namespace osteon::session {
namespace {

std::vector<report::LimitRow> LimitRowsOf(const RunSummary& summary) {
  std::vector<report::LimitRow> rows;
  for (const ActedLimit& limit : summary.acted_limits)
    rows.push_back({.name = limit.text,
                    .first_s = limit.first_s,
                    .total_s = limit.total_s,
                    .longest_s = limit.longest_s,
                    .times = limit.events});
  return rows;
}

}  // namespace

tl::expected<report::ReportFigures, std::string> WriteRunReport(
    const CellSetup& setup, const CellRunResult& result, const RunAccumulator& run, const RunSummary& summary,
    const std::string& command, const std::string& command_line, const std::filesystem::path& page) {
  std::vector<simulation::ToolPath> paths;
  std::function<double(const Vector3&)> planned;  // distance of a point to the planned cavity [m]
  if (run.session_cut) {
    paths = run.session_cut->paths();
    if (const auto& cavity = run.session_cut->planned)
      planned = [cavity = *cavity](const Vector3& p_m) { return cavity.DistanceTo(p_m); };
  }
  // draw the last pass's tool and path as the run's, and the passes before it as earlier cuts
  simulation::ToolPath last{.tool = &setup.config.tool.tool, .X_GP = run.path.X_GP()};
  if (!paths.empty()) {
    last = paths.back();
    paths.pop_back();
  }
  return report::WriteReport(
      {.title = "Osteon " + command + ": " + summary.scene,
       .subtitle = summary.engine + " on " + summary.device + (summary.virtual_time ? ", virtual time" : ""),
       .verdict = summary.verdict.ForReport(),
       .summary = Rows(summary),
       .run = run.curves,
       .X_GP = last.X_GP,
       .bone = result.rezoned.empty() ? setup.bone : result.rezoned.back().bone,
       .after = result.after,
       .tool = *last.tool,
       .solid = setup.solid.get(),
       .force_limit_N = summary.force_limit_N,
       .tool_speed_limit_m_per_s = setup.config.servo.twist.max_speed_m_per_s,
       .max_tool_in_bone_m = setup.config.servo.on_force_limit.max_tool_in_bone_m,
       .earlier = std::move(paths),
       .planned = std::move(planned),
       .faults = summary.faults,
       .limits = LimitRowsOf(summary),
       .assumptions = summary.assumptions,
       .config_text = setup.config_text,
       .command_line = command_line,
       .version = OSTEON_VERSION},
      page);
}

}  // namespace osteon::session
