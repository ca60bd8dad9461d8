#include "studies/regress/regress_page.h"

#include <span>

#include <fmt/format.h>

#include "report/page.h"
#include "report/svg_text.h"

namespace osteon::studies {
namespace {

// Table of the quantities that differ.
std::string Table(const RegressPageEntry& entry) {
  std::string html =
      "<table>\n<tr><th>quantity</th><th class=\"n\">left its tolerance</th><th class=\"n\">at most</th><th "
      "class=\"n\">may be</th><th class=\"n\">golden</th><th class=\"n\">now</th><th></th></tr>\n";
  for (const RegressPageEntry::Row& row : entry.rows)
    html += fmt::format(
        "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{:.3g}</td><td class=\"n\">{:.3g}</td><td "
        "class=\"n\">{:.6g}</td><td "
        "class=\"n\">{:.6g}</td><td><span class=\"verdict {}\">{}</span></td></tr>\n",
        report::Escape(row.name), row.left_s ? fmt::format("{:.3f} s", *row.left_s) : std::string(),
        row.worst, row.tolerance, row.golden, row.now, row.beyond ? "bad" : "good",
        row.beyond ? "beyond" : "within");
  return html + "</table>\n";
}

std::string List(const std::vector<std::string>& lines) {
  std::string html = "<ul>\n";
  for (const std::string& line : lines) html += "<li>" + report::Escape(line) + "</li>\n";
  return html + "</ul>\n";
}

}  // namespace

tl::expected<void, std::string> WriteRegressPage(const RegressPage& page, const std::filesystem::path& file) {
  const bool all = page.passed == page.scenarios;
  std::string html =
      report::PageBegin({.title = "Osteon regress",
                         .verdict = report::ReportVerdict{
                             .level = all ? "good" : "bad",
                             .text = fmt::format("{} of {} scenarios passed", page.passed, page.scenarios)}});
  html += "<p>Below are those that are not bit-identical with their golden traces.</p>\n";
  for (const RegressPageEntry& entry : page.entries) {
    html += fmt::format("<h2>{} <span class=\"verdict {}\">{}</span></h2>\n<p class=\"sub\">{}</p>\n",
                        report::Escape(entry.name), entry.good ? "good" : "bad",
                        report::Escape(entry.verdict), report::Escape(entry.shows));
    html += List(entry.lines);
    if (!entry.rows.empty()) html += Table(entry);
    for (std::size_t i = 0; i + 1 < entry.panels.size(); i += 2)
      html += report::Figure(report::Svg(std::span(entry.panels).subspan(i, 2)), "");
    if (!entry.reasons.empty())
      html += "<p class=\"sub\">The golden trace was accepted for:</p>\n" + List(entry.reasons);
  }
  html += fmt::format("<footer>Osteon {}: <code>{}</code></footer>\n", report::Escape(page.version),
                      report::Escape(page.command_line));
  return report::WritePage(html + report::PageEnd(), file);
}

}  // namespace osteon::studies
