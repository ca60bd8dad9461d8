#include "studies/diff/diff.h"

#include <complex>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/write_text.h"
#include "report/page.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "safety/acting_limits.h"
#include "session/process/exit_code.h"
#include "studies/diff/run_difference.h"

namespace osteon::studies {
namespace {

// The document osteon.diff/1.
nlohmann::json ToJson(const DiffOptions& options, const RunFigures& first, const RunFigures& second,
                      const RunDifference& runs) {
  nlohmann::json differences = nlohmann::json::array(), config = nlohmann::json::array(),
                 limits = nlohmann::json::array();
  for (const FigureDifference& figure : runs.figures)
    differences.push_back(
        {{"figure", figure.first.key},
         {"unit", figure.first.unit},
         {"first", figure.first.value},
         {"second", figure.second.value},
         {"difference", figure.difference},
         {"accepted", figure.first.judged ? nlohmann::json(figure.accepted) : nlohmann::json()},
         {"differs", figure.differs()}});
  for (const ConfigDifference& file : runs.config)
    config.push_back(
        {{"file", file.file}, {"line", file.line}, {"first", file.first}, {"second", file.second}});
  for (std::size_t i = 0; i < safety::kLimitCount; ++i)
    if (first.limits[i] + second.limits[i] > 0)
      limits.push_back({{"limit", safety::kLimitNames[i]},
                        {"first_ticks", first.limits[i]},
                        {"second_ticks", second.limits[i]}});
  nlohmann::json responses = nlohmann::json::array();
  const auto complex = [](const std::complex<double>& value) {
    return nlohmann::json{{"re", value.real()}, {"im", value.imag()}};
  };
  for (const ResponseDifference& response : runs.responses)
    for (const LineDifference& line : response.lines)
      responses.push_back({{"by", response.by},
                           {"hz", line.first.hz},
                           {"first", complex(line.first.value)},
                           {"second", complex(line.second.value)},
                           {"accepted", line.accepted},
                           {"differs", line.differs()}});
  return {{"schema", "osteon.diff/1"},
          {"recordings", {options.recordings[0].string(), options.recordings[1].string()}},
          {"verdict", {{"level", runs.verdict.level}, {"reasons", runs.verdict.reasons}}},
          {"identical", runs.identical},
          {"ticks", {first.ticks, second.ticks}},
          {"differences", differences},
          {"responses", responses},
          {"excitation",
           {first.excited ? nlohmann::json(first.excited->excitation) : nlohmann::json(),
            second.excited ? nlohmann::json(second.excited->excitation) : nlohmann::json()}},
          {"limits", limits},
          {"faults_only_first", runs.only_first},
          {"faults_only_second", runs.only_second},
          {"ended", {first.end, second.end}},
          {"configuration", config},
          {"session", runs.session}};
}

// Prints verdict, figures and other differences to standard output.
void Print(const RunDifference& runs, double within_percent) {
  fmt::print("Osteon diff: {}\n", runs.verdict.level);
  for (const std::string& reason : runs.verdict.reasons) fmt::print("  {}\n", reason);
  fmt::print("\n  {:<52} {:>12} {:>12} {:>12}\n", "", "first", "second", "difference");
  for (const FigureDifference& figure : runs.figures) {
    const std::string name =
        figure.first.unit.empty() ? figure.first.name : figure.first.name + " [" + figure.first.unit + "]";
    fmt::print("{} {:<52} {:>12.5g} {:>12.5g} {:>+12.3g}\n", figure.differs() ? "*" : " ", name,
               figure.first.value, figure.second.value, figure.difference);
  }
  fmt::print("\n  * differs by more than {:g} %\n", within_percent);
  for (const std::string& line : runs.session) fmt::print("  {}\n", line);
  for (const ConfigDifference& file : runs.config)
    fmt::print("  {}:{}\n    {}\n    {}\n", file.file, file.line, file.first, file.second);
}

// Draws one value of both runs over the time since each run's first tick; the second run is dashed.
report::LineChart Chart(const char* title, const char* unit, const report::ThinCurve& a,
                        rt::Nanoseconds a_first, const report::ThinCurve& b, rt::Nanoseconds b_first) {
  report::LineChart chart{.title = title, .x_label = "time [s]", .y_label = unit, .zooms = true};
  auto first = a.Columns(a_first), second = b.Columns(b_first);
  chart.series.push_back({.name = "first", .x = std::move(first.first), .y = std::move(first.second)});
  chart.series.push_back(
      {.name = "second", .x = std::move(second.first), .y = std::move(second.second), .dash = "6 3"});
  return chart;
}

// Draws gain over frequency, for each response that both runs of `osteon identify` have.
std::string ResponseSvg(const RunDifference& runs) {
  std::vector<report::LineChart> panels;
  for (const ResponseDifference& response : runs.responses) {
    report::LineChart& chart = panels.emplace_back();
    chart = {.title = "Response by " + response.by,
             .x_label = "frequency [Hz]",
             .y_label = "gain",
             .y_from_zero = false,
             .log_x = true,
             .log_y = true};
    const auto add = [&](const char* name, const char* dash, RecordedResponse::Line LineDifference::*of) {
      report::Series& series = chart.series.emplace_back();
      series.name = name;
      series.dash = dash;
      for (const LineDifference& difference : response.lines) {
        const RecordedResponse::Line& line = difference.*of;
        const double gain = std::abs(line.value);
        series.x.push_back(line.hz);
        series.y.push_back(gain);
        series.y_low.push_back(std::max(1e-4 * gain, gain - 2.0 * line.sd));
        series.y_high.push_back(gain + 2.0 * line.sd);
      }
    };
    add("first", "", &LineDifference::first);
    add("second", "6 3", &LineDifference::second);
  }
  return report::Svg(panels);
}

// The figures as a table of HTML.
std::string Table(const RunDifference& runs) {
  std::string html =
      "<table>\n<tr><th>figure</th><th class=\"n\">first</th><th class=\"n\">second</th><th "
      "class=\"n\">difference</th><th class=\"n\">accepted</th><th></th></tr>\n";
  for (const FigureDifference& figure : runs.figures) {
    const char* level = figure.differs() ? "look" : "good";
    html += fmt::format(
        "<tr><td>{}{}</td><td class=\"n\">{:.5g}</td><td class=\"n\">{:.5g}</td><td "
        "class=\"n\">{:+.3g}</td><td "
        "class=\"n\">{}</td><td>{}</td></tr>\n",
        report::Escape(figure.first.name),
        figure.first.unit.empty() ? "" : " [" + report::Escape(figure.first.unit) + "]", figure.first.value,
        figure.second.value, figure.difference,
        figure.first.judged ? fmt::format("{:.3g}", figure.accepted) : "",
        figure.first.judged ? fmt::format("<span class=\"verdict {}\">{}</span>", level,
                                          figure.differs() ? "differs" : "same")
                            : "the machine's time");
  }
  return html + "</table>\n";
}

// The page diff.html.
std::string Page(const DiffOptions& options, const RunFigures& first, const RunFigures& second,
                 const RunDifference& runs) {
  std::string html = report::PageBegin(
      {.title = "Osteon diff",
       .subtitle = options.recordings[0].string() + " and " + options.recordings[1].string(),
       .verdict = runs.verdict,
       .summary = {{.key = "First ended", .value = first.end},
                   {.key = "Second ended", .value = second.end}}});
  html += Table(runs);
  if (!runs.responses.empty()) html += report::Figure(ResponseSvg(runs), "Bars: two standard deviations.");
  const std::vector<report::LineChart> panels{
      Chart("Force to the hand", "force [N]", first.force_N, first.first, second.force_N, second.first),
      Chart("Depth of the cut", "depth [mm]", first.depth_mm, first.first, second.depth_mm, second.first),
      Chart("Removed volume", "volume [mm³]", first.removed_mm3, first.first, second.removed_mm3,
            second.first)};
  html += report::Figure(report::Svg(panels), "");
  if (!runs.session.empty() || !runs.config.empty())
    html += "<h2>What is not the same in the two</h2>\n<ul>\n";
  for (const std::string& line : runs.session) html += "<li>" + report::Escape(line) + "</li>\n";
  for (const ConfigDifference& file : runs.config)
    html +=
        fmt::format("<li>{}, line {}: <code>{}</code> | <code>{}</code></li>\n", report::Escape(file.file),
                    file.line, report::Escape(file.first), report::Escape(file.second));
  if (!runs.session.empty() || !runs.config.empty()) html += "</ul>\n";
  html += fmt::format("<footer><code>{}</code>; both side by side: <code>osteon view {} {}</code></footer>\n",
                      report::Escape(options.command_line), report::Escape(options.recordings[0].string()),
                      report::Escape(options.recordings[1].string()));
  return html + report::PageEnd();
}

}  // namespace

int RunDiff(const DiffOptions& options) {
  std::array<RunFigures, 2> read;
  for (std::size_t i = 0; i < 2; ++i) {
    auto run = ReadRunFigures(options.recordings[i]);
    if (!run) return session::Fail("diff", run.error());
    read[i] = std::move(*run);
  }
  if (const std::string wrong = NotComparable(read[0], read[1]); !wrong.empty())
    return session::Fail("diff", fmt::format("{}, {}: {}", options.recordings[0].string(),
                                             options.recordings[1].string(), wrong));
  const RunDifference runs = CompareRuns(read[0], read[1], 0.01 * options.within_percent);
  Print(runs, options.within_percent);
  if (!options.json.empty())
    if (const auto written =
            base::WriteText(options.json, base::JsonText(ToJson(options, read[0], read[1], runs)));
        !written)
      return session::Fail("diff", written.error(), session::kFailed);
  if (!options.out.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.out, error);
    const std::filesystem::path page = options.out / "diff.html";
    if (const auto written = report::WritePage(Page(options, read[0], read[1], runs), page); !written)
      return session::Fail("diff", written.error(), session::kFailed);
    fmt::print("  {}\n", page.string());
  }
  return runs.verdict.level == "good" ? 0 : session::kFailed;
}

}  // namespace osteon::studies
