#include "studies/validate/validate_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "report/page.h"
#include "report/svg_text.h"
#include "studies/validate/fitted_constants.h"
#include "studies/validate/validate.h"
#include "studies/validate/validate_plot.h"

namespace osteon::studies {
namespace {

// The unit with a space before it; empty for a ratio.
std::string UnitText(const Measurement& m) { return m.unit == "1" ? "" : " " + std::string(m.unit); }

std::string SpreadText(const Measurement& m) {
  return m.judged() ? fmt::format("{:.3g} to {:.3g}", m.low, m.high) : "not stated";
}

// The verdict as an HTML table cell, coloured if the row is judged or has failed.
std::string VerdictCell(const ValidationRow& row) {
  const std::string_view verdict = row.verdict();
  const char* level = verdict == "within" ? "good" : verdict == "misses" ? "look" : "bad";
  if (verdict == "calibrates" || verdict == "not judged") return std::string(verdict);
  return fmt::format("<span class=\"verdict {}\">{}</span>", level, verdict);
}

// Names the part that yields in a variant, for the reader of the page.
const char* TextOf(CompliantPart part) {
  switch (part) {
    case CompliantPart::kTool:
      return "a tool that bends";
    case CompliantPart::kLayer:
      return "cartilage that yields";
    case CompliantPart::kMount:
      break;
  }
  return "the bone on the mount of cell pelvis_mount";
}

// The HTML table cells of the variants, in the order tool, layer, mount.
std::string VariantCells(const ValidationRow& row) {
  std::string html;
  for (const CompliantPart part : {CompliantPart::kTool, CompliantPart::kLayer, CompliantPart::kMount}) {
    const ComplianceVariant* variant = row.simulated.With(part);
    std::string text;
    if (variant != nullptr) text = variant->simulated ? fmt::format("{:.4g}", *variant->simulated) : "–";
    html += fmt::format("<td class=\"n\">{}</td>", text);
  }
  return html;
}

// HTML table with a line for each row.
std::string RowTable(std::span<const ValidationRow> rows) {
  std::string html =
      "<table>\n<tr><th>row</th><th>quantity</th><th class=\"n\">measured by others</th><th "
      "class=\"n\">spread</th><th class=\"n\">simulated here</th><th class=\"n\">tool bends</th><th "
      "class=\"n\">layer yields</th><th class=\"n\">on a mount</th><th>use</th><th>verdict</th></tr>\n";
  for (const ValidationRow& row : rows) {
    const Measurement& m = *row.measurement;
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td class=\"n\">{:.4g}{}</td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td>{}<td>{}</td><td>{}</td></tr>\n",
        report::Escape(m.id), report::Escape(m.quantity), m.measured, report::Escape(UnitText(m)),
        SpreadText(m),
        row.error.empty() ? fmt::format("{:.4g}{}", row.simulated.value, report::Escape(UnitText(m))) : "–",
        VariantCells(row), NameOf(m.use), VerdictCell(row));
  }
  return html + "</table>\n";
}

// HTML list of the details of a row: source, conditions, ablations, variants.
std::string RowDetails(const ValidationRow& row) {
  const Measurement& m = *row.measurement;
  std::string html = fmt::format("<h3>{}: {}</h3>\n<ul>\n", report::Escape(m.id), report::Escape(m.quantity));
  const auto item = [&](const char* name, const std::string& text) {
    if (!text.empty()) html += fmt::format("<li>{}: {}</li>\n", name, report::Escape(text));
  };
  item("Measured", fmt::format("{}; {}", m.source, m.conditions));
  item("Spread", std::string(m.spread));
  item("Simulated", row.error.empty() ? row.simulated.how : "no result: " + row.error);
  item("Left out", std::string(m.leaves_out));
  for (const Ablation& ablation : row.simulated.ablations)
    item("With one thing changed",
         fmt::format("{:.4g}{}: {}", ablation.simulated, UnitText(m), ablation.what));
  for (const ComplianceVariant& variant : row.simulated.compliance)
    item("With a part that gives way",
         fmt::format("{}: {}",
                     variant.simulated ? fmt::format("{:.4g}{}", *variant.simulated, UnitText(m))
                                       : "no result, " + variant.error,
                     TextOf(variant.part)));
  if (row.verdict() == "misses") item("Why it misses", row.simulated.reason);
  item("Depends on", fmt::format("{}", fmt::join(row.simulated.constants, ", ")));
  return html + "</ul>\n";
}

// HTML table of the fitted constants.
std::string ConstantsTable() {
  std::string html =
      "<table>\n<tr><th>constant</th><th class=\"n\">value</th><th>fitted to rows</th><th>how</th></tr>\n";
  for (const FittedConstant& c : FittedConstants()) {
    const bool energy = c.constant == CutConstant::kCuttingEnergy;
    std::string rows = fmt::format("{}", fmt::join(c.fitted_to, ", "));
    if (!c.minor.empty())
      rows += fmt::format("; below {:g} % of it: {}", 100.0 * c.minor_share, fmt::join(c.minor, ", "));
    html += fmt::format("<tr><td>{}</td><td class=\"n\">{:g}{}</td><td>{}</td><td>{}</td></tr>\n",
                        report::Escape(c.name()), energy ? 1e-9 * c.value : c.value, energy ? " J/mm³" : "",
                        report::Escape(rows), report::Escape(c.how));
  }
  return html + "</table>\n";
}

// HTML list of the published figures that the product itself uses.
std::string PublishedUsesList() {
  std::string html = "<ul>\n";
  for (const PublishedUse& use : PublishedUses())
    html += fmt::format("<li>Row {}: {}: {}</li>\n", report::Escape(use.row), report::Escape(use.value),
                        report::Escape(use.where));
  return html + "</ul>\n";
}

}  // namespace

std::string ValidationPage(std::span<const ValidationRow> rows, const std::string& command_line) {
  const ValidationCounts counts = CountRows(rows);
  report::ReportVerdict verdict;
  if (counts.missed > 0) {
    verdict.level = "look";
    verdict.reasons.push_back(fmt::format("{} of {} judged rows miss the measured spread; each says why",
                                          counts.missed, counts.judged));
  }
  if (counts.failed > 0) {
    verdict.level = "bad";
    verdict.reasons.push_back(fmt::format("{} rows have no result", counts.failed));
  }
  std::string html = report::PageBegin(
      {.title = "Osteon validate",
       .subtitle = "Measured by others, simulated here",
       .verdict = verdict,
       .summary = {{"Rows", std::to_string(counts.rows)},
                   {"Within the measured spread", fmt::format("{} of {}", counts.within, counts.judged)},
                   {"Levels and trends within",
                    fmt::format("{} of {}", counts.levels_and_trends_within, counts.levels_and_trends)},
                   {"By kind", KindsText(counts)},
                   {"Calibrate", std::to_string(counts.calibrates)},
                   {"Not judged", std::to_string(counts.not_judged)}}});
  html += report::Figure(
      ValidationPlot(rows),
      "Simulated over measured for each row, beside the measured spread. A row that a constant was "
      "fitted to shows nothing and is grey. The table has beside each row the same with a tool that bends, "
      "with cartilage that yields, and with the bone on a mount.");
  html += "<h2>Rows</h2>\n" + RowTable(rows) + "<h2>What was fitted to what</h2>\n" + ConstantsTable();
  html +=
      "<h2>Published figures that the product uses</h2>\n" + PublishedUsesList() + "<h2>Row by row</h2>\n";
  for (const ValidationRow& row : rows) html += RowDetails(row);
  return html + report::RepeatSection(command_line) + report::PageEnd();
}

}  // namespace osteon::studies
