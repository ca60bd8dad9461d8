#include "session/summary/run_report.h"

namespace osteon::app {

tl::expected<ReportFigures, std::string> WriteRunReport(const CellSetup& setup, const CellRunResult& result,
                                                        const RunAccumulator& run, const RunSummary& summary,
                                                        const std::string& command,
                                                        const std::string& command_line,
                                                        const std::filesystem::path& page) {
  return WriteReport(
      {.title = "Osteon " + command + ": " + summary.scene,
       .subtitle = summary.engine + " on " + summary.device + (summary.virtual_time ? ", virtual time" : ""),
       .verdict = summary.verdict.ForReport(),
       .summary = Rows(summary),
       .run = run.curves,
       .X_GP = run.path.X_GP(),
       .bone = result.rezoned.empty() ? setup.bone : result.rezoned.back().bone,
       .after = result.after,
       .tool = setup.config.tool.tool,
       .solid = setup.solid.get(),
       .force_limit_N = summary.force_limit_N,
       .tool_speed_limit_m_per_s = setup.config.servo.twist.max_speed_m_per_s,
       .max_tool_in_bone_m = setup.config.servo.on_force_limit.max_tool_in_bone_m,
       .faults = summary.faults,
       .config_text = setup.config_text,
       .command_line = command_line,
       .version = OSTEON_VERSION},
      page);
}

}  // namespace osteon::app
