#include "studies/sweep/sweep_page.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "report/page.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"

namespace osteon::studies {
namespace {

// With more combinations than this, the chart of a distribution has a single curve for all runs.
constexpr std::size_t kMaxCurves = 8;

// Returns the number if the whole text is a number; otherwise nothing.
std::optional<double> NumberFrom(const std::string& text) {
  double value = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || rest != text.data() + text.size()) return {};
  return value;
}

// Whether a figure differs between the runs. On a rigid plane, for example, no bone is removed in any run.
bool Varies(const SweepResult& result, const SweepFigure& figure) {
  const Quantiles q = QuantilesOf(ValuesOf(result.outcomes, figure));
  return q.max > q.min;
}

// Draws the share of runs with at most a value, over the value: one curve for each combination, or a single
// curve for all runs.
report::LineChart Distribution(const SweepResult& result, const SweepFigure& figure) {
  report::LineChart chart{.title = fmt::format("Distribution of the {}", figure.label),
                          .x_label = std::string(figure.label),
                          .y_label = "share of the runs",
                          .plot_height_px = 200.0};
  const auto groups = ByCombination(result);
  for (const auto& group : groups) {
    if (groups.size() > kMaxCurves && &group != &groups.front()) break;
    const bool one_curve = groups.size() > kMaxCurves;
    std::vector<double> values =
        ValuesOf(one_curve ? std::span<const SweepOutcome>(result.outcomes) : group, figure);
    std::ranges::sort(values);
    report::Series curve{.name = one_curve ? "all combinations" : NameOfCombination(result, group.front())};
    for (std::size_t i = 0; i < values.size(); ++i) {
      curve.x.push_back(values[i]);
      curve.y.push_back(static_cast<double>(i + 1) / static_cast<double>(values.size()));
    }
    chart.series.push_back(std::move(curve));
  }
  return chart;
}

// Draws a figure of every run over the value of one parameter, with medians if the parameter's values are
// listed. Empty if the parameter has no numbers.
std::optional<report::LineChart> OverParameter(const SweepResult& result, std::size_t parameter,
                                               const SweepFigure& figure) {
  const config::SweepParameter& p = result.config.parameters[parameter];
  if (p.draw == config::SweepDraw::kSeed) return {};
  report::Series runs{.name = "runs", .width_px = 0.0, .marker = report::Marker::kCircle, .opacity = 0.5};
  for (const SweepOutcome& outcome : result.outcomes) {
    const auto x = NumberFrom(outcome.run.values[parameter]);
    if (!x) return {};
    if (!outcome.error.empty()) continue;
    runs.x.push_back(*x);
    runs.y.push_back(outcome.figures.*figure.value);
  }
  report::LineChart chart{.title = fmt::format("{} over {}", figure.label, p.key),
                          .x_label = p.key,
                          .y_label = std::string(figure.label),
                          .plot_height_px = 200.0};
  if (p.draw == config::SweepDraw::kListed) {
    report::Series medians{.name = "median, 5th to 95th percentile", .marker = report::Marker::kSquare};
    std::vector<double> sorted;
    for (const std::string& value : p.values) sorted.push_back(NumberFrom(value).value_or(0.0));
    std::ranges::sort(sorted);
    for (const double x : sorted) {
      std::vector<double> values;
      for (std::size_t i = 0; i < runs.x.size(); ++i)
        if (runs.x[i] == x) values.push_back(runs.y[i]);
      if (values.empty()) continue;
      const Quantiles q = QuantilesOf(values);
      medians.x.push_back(x);
      medians.y.push_back(q.median);
      medians.y_low.push_back(q.p05);
      medians.y_high.push_back(q.p95);
    }
    chart.series.push_back(std::move(medians));
  }
  chart.series.push_back(std::move(runs));
  return chart;
}

// HTML table: the quantiles of each figure, a row for each combination.
std::string QuantilesTable(const SweepResult& result) {
  std::string html = "<table>\n<tr><th>combination</th><th class=\"n\">runs</th>";
  for (const SweepFigure& figure : kSweepFigures)
    html += fmt::format("<th class=\"n\">{}: median</th><th class=\"n\">5th to 95th percentile</th>",
                        figure.label);
  html += "</tr>\n";
  for (const auto& group : ByCombination(result)) {
    html += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td>",
                        report::Escape(NameOfCombination(result, group.front())), group.size());
    for (const SweepFigure& figure : kSweepFigures) {
      const Quantiles q = QuantilesOf(ValuesOf(group, figure));
      html += fmt::format("<td class=\"n\">{:.4g}</td><td class=\"n\">{:.4g} … {:.4g}</td>", q.median, q.p05,
                          q.p95);
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

}  // namespace

std::string SweepPage(const SweepResult& result, const std::string& command_line) {
  std::size_t faulted = 0, failed = 0;
  for (const SweepOutcome& outcome : result.outcomes) {
    faulted += outcome.faults.empty() ? 0u : 1u;
    failed += outcome.error.empty() ? 0u : 1u;
  }
  report::ReportVerdict verdict{.level = failed > 0 ? "bad" : "good"};
  if (failed > 0) verdict.reasons.push_back(fmt::format("{} runs could not be made", failed));
  std::string html = report::PageBegin({.title = "Sweep " + result.config.name,
                                        .subtitle = result.config.shows,
                                        .verdict = verdict,
                                        .summary = {{"Scenario", result.scenario},
                                                    {"Runs", std::to_string(result.outcomes.size())},
                                                    {"Seeds", std::to_string(result.config.seeds)},
                                                    {"Runs with a fault", std::to_string(faulted)}}});
  html += "<h2>By combination</h2>\n" + QuantilesTable(result);
  for (const SweepFigure& figure : kSweepFigures) {
    if (!Varies(result, figure)) continue;
    html += fmt::format("<h2>{}</h2>\n", report::Escape(figure.label)) +
            report::Figure(report::Svg(Distribution(result, figure), 860.0), "");
    for (std::size_t i = 0; i < result.config.parameters.size(); ++i)
      if (const auto chart = OverParameter(result, i, figure))
        html += report::Figure(report::Svg(*chart, 860.0), "");
  }
  return html + report::RepeatSection(command_line) + report::PageEnd();
}

}  // namespace osteon::studies
