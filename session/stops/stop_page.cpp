#include "session/stops/stop_page.h"

#include <fmt/format.h>

#include "report/page.h"
#include "report/run_charts.h"
#include "report/svg_text.h"

namespace osteon::session {
namespace {

// Makes an HTML table of the faults, or no_fault_text if there are none.
std::string FaultTable(const StopPageInput& input) {
  if (input.faults.empty()) return "<p>" + report::Escape(input.no_fault_text) + "</p>\n";
  std::string out =
      "<table>\n<tr><th>fault</th><th>what was seen</th><th>what the cell does</th><th>how to go "
      "on</th></tr>\n";
  for (const StopFaultRow& row : input.faults)
    out += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", report::Escape(row.name),
                       report::Escape(row.seen), report::Escape(row.reaction), report::Escape(row.clearing));
  return out + "</table>\n";
}

// Makes a chart for each fault that has one. It shows the quantity that caused the fault, and its limit.
std::string TripFigures(const StopPageInput& input) {
  std::string out;
  for (const StopFaultRow& row : input.faults) {
    const std::string chart = TripChart(row.fault, input.ticks, input.limits, input.time);
    if (!chart.empty()) out += report::Figure(chart, "What tripped: " + row.name + ".");
  }
  return out;
}

}  // namespace

std::string MakeStopPage(const StopPageInput& input) {
  const control::ServoParams& servo = input.limits.servo;
  report::RunCurves curves;
  for (const control::TickRecord& tick : input.ticks) curves.Add(tick);
  std::string page = report::PageBegin({.title = input.title});
  page += fmt::format(
      "<p>{}{}</p>\n", report::Escape(input.where),
      input.ticks_file.empty() ? "" : " Every tick is in " + report::FileLink(input.ticks_file) + ".");
  if (!input.console_url.empty())
    page += fmt::format("<p>The cell still runs: <a href=\"{0}\">{0}</a>.</p>\n",
                        report::Escape(input.console_url));
  if (!input.view_command.empty())
    page += "<p>This command shows the stop in a browser, with the bone:</p>\n<pre>" +
            report::Escape(input.view_command) + "</pre>\n";
  page +=
      fmt::format("<h2>{}</h2>\n", report::Escape(input.heading)) + FaultTable(input) + TripFigures(input);
  page += "<h2>Forces and motion</h2>\n";
  page += report::Figure(report::ForceChart(curves, input.force_limit_N, input.time), "Forces on the tool.");
  page += report::Figure(report::MotionChart(curves, servo.twist.max_speed_m_per_s,
                                             servo.on_force_limit.max_tool_in_bone_m, input.time),
                         "Tool speed, how deep the tool is in bone, and the contact model's age.");
  return page + report::PageEnd();
}

}  // namespace osteon::session
