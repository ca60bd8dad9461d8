#include "studies/failures/page/failure_page.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "base/text.h"
#include "report/page.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "studies/failures/page/failure_scenes.h"

namespace osteon::studies {
namespace {

// "01_thin_sheet.svg". @param what  added to the name: "_scene" for the sketch
std::string FileName(const FailureResult& result, const char* what = "") {
  std::string name = fmt::format("{:02}_{}{}.svg", result.id, result.name, what);
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '.'; }, '_');
  return name;
}

// Formats a value with two digits, enough to distinguish a pass from a failure, and without an exponent if
// possible.
std::string ShortValue(double value, const std::string& unit) {
  const std::string number =
      std::abs(value) >= 100.0 ? fmt::format("{:.0f}", value) : fmt::format("{:.2g}", value);
  return number + (unit == "1" ? "" : " " + unit);
}
std::string HtmlValue(double value, const std::string& unit) {
  return report::Escape(ShortValue(value, unit));
}

/// The quantity that the chart shows, without its unit: the metric, or the quantity of the y axis.
std::string Plotted(const FailureResult& result) {
  if (result.plot.bound_is_on_y) return result.metric;
  return result.plot.y_label.substr(0, result.plot.y_label.find(" ["));
}

const char* Verdict(const FailurePageEntry& entry) {
  return entry.passed                   ? "passes"
         : !entry.error.empty()         ? "no result"
         : !entry.result.baseline_fails ? "baseline does not fail"
                                        : "fails";
}

/// A scenario's row of the table, in HTML.
std::string Row(const FailurePageEntry& entry) {
  const FailureResult& r = entry.result;
  const std::string figures =
      entry.error.empty()
          ? fmt::format(
                "<td>{}</td><td class=\"n\">{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>",
                report::Escape(r.metric), HtmlValue(r.bound, r.unit), report::Escape(r.baseline_name),
                HtmlValue(r.baseline, r.unit), HtmlValue(r.ours, r.unit))
          : fmt::format("<td colspan=\"5\">{}</td>", report::Escape(entry.error));
  return fmt::format(
      "<tr><td class=\"n\">{}</td><td>{}</td>{}<td><span class=\"verdict {}\">{}</span></td></tr>\n", r.id,
      report::Escape(r.name), figures, entry.passed ? "good" : "bad", Verdict(entry));
}

}  // namespace

std::string FailureSvg(const FailureResult& result) {
  // ours: blues and greens; baseline: reds and browns
  static constexpr std::array kOurs{"#0072b2", "#56b4e9", "#009e73"},
      kTheirs{"#d55e00", "#b07d00", "#cc79a7"};
  report::LineChart chart{.title = fmt::format("{} {}: {}", result.id, result.name, Plotted(result)),
                          .x_label = result.plot.x_label,
                          .y_label = result.plot.y_label,
                          .log_x = result.plot.log_x,
                          .log_y = result.plot.log_y};
  std::size_t ours = 0, theirs = 0;
  for (const FailureSeries& series : result.plot.series)
    chart.series.push_back(
        {.name = series.name,
         .x = series.x,
         .y = series.y,
         .color = series.ours ? kOurs[ours++ % kOurs.size()] : kTheirs[theirs++ % kTheirs.size()],
         .width_px = series.ours ? 2.2 : 1.6});
  if (result.plot.bound_is_on_y)
    chart.limits = {{.value = result.bound, .label = "bound " + ShortValue(result.bound, result.unit)}};
  return report::Svg(chart);
}

tl::expected<void, std::string> WriteFailurePage(std::span<const FailurePageEntry> entries,
                                                 const FailurePageHead& head,
                                                 const std::filesystem::path& folder) {
  const auto passed = std::ranges::count_if(entries, &FailurePageEntry::passed);
  const bool all = passed == std::ssize(entries);
  std::string html = report::PageBegin(
      {.title = "Where methods fail",
       .subtitle = fmt::format("{} on {}{}", head.engine, head.device, head.quick ? ", small scenes" : ""),
       .verdict = report::ReportVerdict{
           .level = all ? "good" : "bad",
           .text = fmt::format("{} of {} kept, with their baselines seen to fail", passed, entries.size())}});
  html +=
      "<table>\n<tr><th class=\"n\"></th><th>scenario</th><th>metric</th><th "
      "class=\"n\">bound</th><th>baseline</th>"
      "<th class=\"n\"></th><th class=\"n\">ours</th><th></th></tr>\n";
  for (const FailurePageEntry& entry : entries) html += Row(entry);
  html += "</table>\n";
  for (const FailurePageEntry& entry : entries) {
    if (!entry.error.empty()) continue;
    const std::string svg = FailureSvg(entry.result);
    const std::string scene = FailureSceneSvg(entry.result.id, entry.result.name);
    html += fmt::format("<h2>{} {}</h2>\n", entry.result.id, report::Escape(entry.result.name)) +
            report::Figure(scene, "") +
            report::Figure(svg, fmt::format("Baseline: {}. {}{}It took {:.1f} s.", entry.result.baseline_name,
                                            base::ToSentence(entry.result.note),
                                            entry.result.note.empty() ? "" : " ", entry.seconds));
    if (const auto written = report::WritePage(svg, folder / FileName(entry.result)); !written)
      return written;
    if (const auto written = report::WritePage(scene, folder / FileName(entry.result, "_scene")); !written)
      return written;
  }
  html += fmt::format("<footer>Osteon {}: <code>{}</code></footer>\n", report::Escape(head.version),
                      report::Escape(head.command_line));
  return report::WritePage(html + report::PageEnd(), folder / "failures.html");
}

std::string FailureMarkdown(std::span<const FailurePageEntry> entries, const FailurePageHead& head,
                            const std::string& pictures) {
  const auto passed = std::ranges::count_if(entries, &FailurePageEntry::passed);
  std::string page = fmt::format(
      "# Where methods fail\n\n"
      "*In which scenes does haptic cutting go wrong, what does that look like, and what does ours do "
      "there?*\n\n{}\n\n{}\n\n"
      "| | scenario | metric | bound | baseline | ours | |\n|---|---|---|---|---|---|---|\n",
      base::WrapMarkdown(
          "Each scenario has a baseline, a plainer method or setting, which must be *seen* to fail, and a "
          "bound that ours must keep. Orange and brown are the baseline's lines, blue and green ours. In the "
          "sketches black is what the hand does, and dashed what is meant, or was, but is not."),
      base::WrapMarkdown(fmt::format(
          "{} of {} kept, with their baselines seen to fail. Written by `{}`: {} on {}{}.", passed,
          entries.size(), head.command_line, head.engine, head.device, head.quick ? ", small scenes" : "")));
  for (const FailurePageEntry& entry : entries) {
    const FailureResult& r = entry.result;
    page += entry.error.empty()
                ? fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", r.id, r.name, r.metric,
                              ShortValue(r.bound, r.unit), ShortValue(r.baseline, r.unit),
                              ShortValue(r.ours, r.unit), Verdict(entry))
                : fmt::format("| {} | {} | | | | | {}: {} |\n", r.id, r.name, Verdict(entry), entry.error);
  }
  for (const FailurePageEntry& entry : entries) {
    const FailureResult& r = entry.result;
    if (!entry.error.empty()) continue;
    page += fmt::format(
        "\n## {} {}\n\n{}\n\n![{}: the scene, baseline and ours]({}/{})\n\n", r.id, r.name,
        base::WrapMarkdown(fmt::format("Baseline: {}. {}", r.baseline_name, base::ToSentence(r.note))),
        r.name, pictures, FileName(r, "_scene"));
    page += base::WrapMarkdown(fmt::format("![{}: {}, baseline and ours]({}/{})", r.name, Plotted(r),
                                           pictures, FileName(r))) +
            "\n";
  }
  return page;
}

}  // namespace osteon::studies
