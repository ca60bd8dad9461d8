#include "studies/regress/regress_result.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "report/svg_text.h"
#include "session/setup/build_name.h"
#include "session/summary/chart_files.h"
#include "studies/regress/regress_page.h"

namespace osteon::studies {
namespace {

constexpr std::size_t kCharts = 4;  // maximum number of quantities that a scenario's charts show

std::string Hex(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

bool Passed(const RegressSummary& summary, const RegressResult& r) { return r.Passed(summary.options.exact); }

const char* OutcomeText(const RegressSummary& summary, const RegressResult& r) {
  return r.updated ? "updated" : !r.error.empty() ? "ERROR" : Passed(summary, r) ? "passed" : "FAILED";
}

// The lines of explanation, the most informative first.
std::vector<std::string> Reasons(const RegressResult& r) {
  if (!r.updated) return r.error.empty() ? r.explained : std::vector{r.error};
  // Say how the run of a new golden trace ended: a run that never finished can become golden, too.
  std::vector<std::string> lines = r.explained;
  lines.insert(lines.begin(), fmt::format("{}its run: {}",
                                          !r.golden       ? "the first of its golden traces; "
                                          : r.identical() ? "the same bits, from files that have changed; "
                                                          : "",
                                          r.run->trace.ended));
  return lines;
}

// Ratio of simulated time to wall time; 0 if the wall time is not known.
double TimesRealTime(const ScenarioRun& run) {
  return run.seconds_wall > 0.0 ? run.seconds_simulated / run.seconds_wall : 0.0;
}

// Adds panels of a quantity: golden and new values, and below them the difference with its tolerance band.
void AddPanels(const RegressResult& r, const QuantityDifference& d, std::vector<report::LineChart>& panels) {
  const TraceQuantity& quantity = TraceQuantities()[d.quantity];
  const ScenarioTrace& now = r.run->trace;
  const auto series = [&](const ScenarioTrace& trace, const char* name, const char* color, double width_px) {
    report::Series line{.name = name, .color = color, .width_px = width_px};
    for (const TraceSample& sample : trace.samples) {
      line.x.push_back(now.TimeOf_s(sample.tick));
      line.y.push_back(sample.values[d.quantity]);
    }
    return line;
  };
  report::LineChart values{
      .title = quantity.name,
      .x_label = "virtual time [s]",
      .y_label = quantity.name,
      .y_from_zero = false,
      .series = {series(r.golden->trace, "golden", "#0072b2", 3.2), series(now, "now", "#d55e00", 1.4)},
      .plot_height_px = 170.0};
  report::LineChart errors{
      .title = fmt::format("now - golden; may be ±{:.3g}", d.tolerance),
      .x_label = "virtual time [s]",
      .y_label = "difference",
      .limits = {{.value = d.tolerance, .label = "tolerance"}, {.value = -d.tolerance, .label = ""}},
      .legend = false,
      .plot_height_px = 110.0};
  report::Series difference{.name = "now - golden", .color = "#d55e00"};
  VisitCommonSamples(r.golden->trace, now, [&](const TraceSample& was, const TraceSample& is) {
    difference.x.push_back(now.TimeOf_s(is.tick));
    difference.y.push_back(is.values[d.quantity] - was.values[d.quantity]);
  });
  errors.series.push_back(std::move(difference));
  if (!r.difference.parts.empty()) {
    const double first_s = now.TimeOf_s(r.difference.parts.front().tick);
    values.x_limits.push_back({.value = first_s, .label = "first bit"});
    errors.x_limits.push_back({.value = first_s, .label = ""});
  }
  panels.push_back(std::move(values));
  panels.push_back(std::move(errors));
}

// Makes a scenario's entry of the page: verdict, explanation, the quantities that differ, charts.
RegressPageEntry PageEntry(const RegressSummary& summary, const RegressResult& r) {
  RegressPageEntry entry{.name = r.scenario.name,
                         .shows = r.scenario.shows,
                         .verdict = OutcomeText(summary, r),
                         .good = r.updated || Passed(summary, r),
                         .lines = Reasons(r)};
  if (!r.golden || !r.run) return entry;
  entry.reasons = r.golden->head.reasons;
  for (const QuantityDifference& d : r.difference.quantities) {
    const TraceQuantity& quantity = TraceQuantities()[d.quantity];
    entry.rows.push_back(
        {.name = quantity.name,
         .beyond = d.beyond(),
         .left_s = d.left_tick ? std::optional(r.run->trace.TimeOf_s(*d.left_tick)) : std::nullopt,
         .worst = d.worst,
         .tolerance = d.tolerance,
         .golden = d.golden,
         .now = d.now});
  }
  for (const QuantityDifference& d : Telling(r.difference, kCharts)) AddPanels(r, d, entry.panels);
  return entry;
}

}  // namespace

std::string RegressTable(const RegressSummary& summary) {
  std::size_t width = 8;
  for (const RegressResult& r : summary.results) width = std::max(width, r.scenario.name.size());
  std::string text = fmt::format("{:<{}}  {:<8}{:<18}{:>10}{:>9}{:>9}\n", "scenario", width, "verdict",
                                 "every bit", "simulated", "wall", "speed");
  std::size_t passed = 0, compared = 0, identical = 0, updated = 0;
  std::string differing;
  for (const RegressResult& r : summary.results) {
    if (!r.updated && r.error.empty() && !Passed(summary, r)) differing += " " + r.scenario.file.string();
    if (r.updated) {
      ++updated;
    } else {
      ++compared;
      passed += Passed(summary, r) ? 1u : 0u;
      identical += r.identical() ? 1u : 0u;
    }
    text += fmt::format("{:<{}}  {:<8}{:<18}", r.scenario.name, width, OutcomeText(summary, r),
                        !r.golden       ? "-"
                        : r.identical() ? "the same"
                                        : "differs");
    text += r.run ? fmt::format("{:>8.2f} s{:>7.2f} s{:>8.1f}x\n", r.run->seconds_simulated,
                                r.run->seconds_wall, TimesRealTime(*r.run))
                  : "\n";
    for (const std::string& line : Reasons(r)) text += "    " + line + "\n";
  }
  if (!differing.empty() && summary.options.set.empty())
    text += fmt::format("If that is meant: osteon regress{} --update --reason \"…\"\n", differing);
  if (updated > 0) text += fmt::format("{} golden trace{} written, ", updated, updated > 1 ? "s" : "");
  if (compared > 0) text += fmt::format("{} of {} passed, {} bit for bit, ", passed, compared, identical);
  return text + fmt::format("in {:.1f} s\n", summary.seconds);
}

std::string RegressJson(const RegressSummary& summary) {
  nlohmann::ordered_json json{
      {"schema", "osteon.regress/1"},
      {"passed",
       std::ranges::all_of(summary.results, [&](const RegressResult& r) { return Passed(summary, r); })},
      {"exact", summary.options.exact},
      {"seconds_wall", summary.seconds},
      {"build", session::BuildName()},
      {"machine", session::MachineName()},
      {"scenarios", nlohmann::ordered_json::array()}};
  for (const RegressResult& r : summary.results) {
    nlohmann::ordered_json scenario{{"name", r.scenario.name},
                                    {"file", r.scenario.file.string()},
                                    {"shows", r.scenario.shows},
                                    {"passed", Passed(summary, r)},
                                    {"identical", r.identical()},
                                    {"updated", r.updated},
                                    {"hash", r.run ? Hex(r.run->trace.hash) : ""},
                                    {"golden_hash", r.golden ? Hex(r.golden->trace.hash) : ""},
                                    {"seconds_simulated", r.run ? r.run->seconds_simulated : 0.0},
                                    {"seconds_wall", r.run ? r.run->seconds_wall : 0.0},
                                    {"control_only", r.scenario.engine == config::ScenarioEngine::kPlane}};
    if (r.run)
      scenario.update({{"seconds_set_up", r.run->seconds_set_up},
                       {"seconds_cpu", r.run->seconds_cpu},
                       {"times_real_time", TimesRealTime(*r.run)},
                       {"engine", r.run->engine},
                       {"ticks", r.run->trace.ticks},
                       {"ended", r.run->trace.ended}});
    scenario["error"] = r.error.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(r.error);
    scenario["explained"] = r.explained;
    scenario["first_difference"] = nullptr;
    if (!r.difference.parts.empty())
      scenario["first_difference"] = {{"tick", r.difference.parts.front().tick},
                                      {"part", NameOf(r.difference.parts.front().part)}};
    scenario["quantities"] = nlohmann::ordered_json::array();
    for (const QuantityDifference& d : r.difference.quantities)
      scenario["quantities"].push_back(
          {{"name", TraceQuantities()[d.quantity].name},
           {"beyond", d.beyond()},
           {"left_tick", d.left_tick ? nlohmann::ordered_json(*d.left_tick) : nlohmann::ordered_json()},
           {"worst", d.worst},
           {"tolerance", d.tolerance},
           {"golden", d.golden},
           {"now", d.now}});
    json["scenarios"].push_back(std::move(scenario));
  }
  return base::JsonText(json);
}

std::string RegressJunit(const RegressSummary& summary) {
  std::size_t failures = 0, errors = 0;
  std::string cases;
  for (const RegressResult& r : summary.results) {
    const std::vector<std::string> lines = Reasons(r);
    std::string all;
    for (const std::string& line : lines) all += line + "\n";
    cases += fmt::format("    <testcase classname=\"osteon.regress\" name=\"{}\" time=\"{:.3f}\">\n",
                         report::Escape(r.scenario.name), r.run ? r.run->seconds_wall : 0.0);
    const std::string first = report::Escape(lines.empty() ? "" : lines.front());
    if (!r.error.empty() && !r.updated) {
      ++errors;
      cases += fmt::format("      <error message=\"{}\">{}</error>\n", first, report::Escape(all));
    } else if (!Passed(summary, r) && !r.updated) {
      ++failures;
      cases += fmt::format("      <failure message=\"{}\">{}{}</failure>\n", first, report::Escape(all),
                           report::Escape((summary.options.out / "regress.html").string()));
    } else if (!all.empty()) {
      cases += fmt::format("      <system-out>{}</system-out>\n", report::Escape(all));
    }
    cases += "    </testcase>\n";
  }
  const std::string counts = fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{:.3f}\"",
                                         summary.results.size(), failures, errors, summary.seconds);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {0}>\n  <testsuite name=\"osteon regress\" "
      "{0}>\n{1}  </testsuite>\n</testsuites>\n",
      counts, cases);
}

tl::expected<std::filesystem::path, std::string> WriteRegressReport(const RegressSummary& summary) {
  RegressPage page{.command_line = summary.options.command_line, .version = OSTEON_VERSION};
  for (const RegressResult& r : summary.results) {
    page.passed += Passed(summary, r) ? 1u : 0u;
    if (!r.identical()) page.entries.push_back(PageEntry(summary, r));
  }
  page.scenarios = summary.results.size();
  const std::filesystem::path file = summary.options.out / "regress.html";
  std::error_code error;
  if (page.entries.empty()) {
    std::filesystem::remove(file, error);  // remove the page of an earlier run, which would be out of date
    return std::filesystem::path();
  }
  std::filesystem::create_directories(summary.options.out, error);
  if (error)
    return tl::make_unexpected(fmt::format("--out {}: {}", summary.options.out.string(), error.message()));
  const auto written = WriteRegressPage(page, file);
  if (!written) return tl::make_unexpected(written.error());
  return file;
}

}  // namespace osteon::studies
