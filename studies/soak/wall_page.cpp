#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "report/page.h"
#include "report/svg_plot.h"
#include "studies/soak/soak_parts.h"
#include "studies/soak/wall_soak.h"

namespace osteon::studies {
namespace {

using Value = std::function<double(const WallResult&)>;

// A series of one figure over the hours, with a point for each episode that has the figure.
report::Series SeriesOf(std::span<const WallResult> results, const char* name,
                        const std::function<bool(const WallResult&)>& has, const Value& value) {
  report::Series series = SoakPoints(name);
  double hours = 0.0;
  for (const WallResult& r : results) {
    hours += r.outcome.seconds_wall / 3600.0;
    if (!has(r)) continue;
    series.x.push_back(hours);
    series.y.push_back(value(r));
  }
  return series;
}

report::LineChart ChartOf(const char* title, const char* unit, std::vector<report::Series> series) {
  return SoakChart(title, "wall time [h]", unit, std::move(series));
}

// A chart of one figure of all episodes that ran.
report::LineChart ChartOverTime(std::span<const WallResult> results, const char* title, const char* unit,
                                const Value& value) {
  return ChartOf(title, unit,
                 {SeriesOf(
                     results, "", [](const WallResult& r) { return r.outcome.error.empty(); }, value)});
}

// A chart of one kind of use (memory, files or threads), with one curve and colour for each process.
report::LineChart UseChart(std::span<const WallResult> results, const char* title, const char* unit,
                           const std::function<double(const ProcessUse&)>& value) {
  std::vector<report::Series> series;
  for (std::size_t i = 0; i < kWallParts.size(); ++i)
    series.push_back(SeriesOf(
        results, kWallParts.at(i), [&](const WallResult& r) { return r.outcome.use.at(i).memory_MB > 0.0; },
        [&](const WallResult& r) { return value(r.outcome.use.at(i)); }));
  report::LineChart chart = ChartOf(title, unit, std::move(series));
  chart.legend = true;
  return chart;
}

// HTML table: the number of episodes with each event, and how many had an error.
std::string EpisodesByEvent(std::span<const WallResult> results) {
  std::vector<EpisodeCount> counts;
  for (int i = 0; i < kWallEvents; ++i) {
    const auto event = static_cast<WallEvent>(i);
    EpisodeCount& count = counts.emplace_back(EpisodeCount{.name = NameOf(event)});
    for (const WallResult& r : results) {
      if (r.episode.event != event) continue;
      ++count.episodes;
      count.wrong += r.wrong.empty() ? 0 : 1;
    }
  }
  return KindTable("event", counts);
}

}  // namespace

std::string WallSoakPage(std::span<const WallResult> results, const SoakOptions& options) {
  double wall_s = 0.0, rendered_s = 0.0;
  report::ReportVerdict verdict;
  for (const WallResult& r : results) {
    wall_s += r.outcome.seconds_wall;
    rendered_s += r.figures.rendered_s;
    for (const std::string& wrong : r.wrong)
      verdict.reasons.push_back(fmt::format("episode {} ({}): {}", r.episode.index, r.episode.text, wrong));
  }
  for (std::string& grows : JudgeGrowth(results)) verdict.reasons.push_back(std::move(grows));
  if (!verdict.reasons.empty()) verdict.level = "bad";
  std::string html = report::PageBegin(
      {.title = "Osteon soak",
       .subtitle = "The cell's real processes in wall time, with three pages, losses and kills",
       .verdict = verdict,
       .summary = {{"Wall time", fmt::format("{:.2f} h in {} episodes", wall_s / 3600.0, results.size())},
                   {"Rendered", fmt::format("{:.2f} h", rendered_s / 3600.0)},
                   {"Seed", std::to_string(options.seed)},
                   {"Controller's memory grew by",
                    fmt::format("{:.1f} MB", GrowthOf(WallPart::kController, results).memory_MB)}}});
  const auto ends_by_itself = [](const WallResult& r) {
    return r.outcome.error.empty() && !IsKill(r.episode.event);
  };
  const std::array panels{
      UseChart(results, "Resident memory", "memory [MB]", [](const ProcessUse& u) { return u.memory_MB; }),
      UseChart(results, "Open files", "files", [](const ProcessUse& u) { return double(u.files); }),
      ChartOverTime(results, "Peak rendered force", "force [N]",
                    [](const auto& r) { return r.figures.peak_rendered_N; }),
      ChartOverTime(results, "Age of the contact model, most while rendering", "age [ms]",
                    [](const auto& r) { return 1e3 * r.figures.max_model_age_s; }),
      ChartOverTime(results, "Age of the force sensor, most while rendering", "age [ms]",
                    [](const auto& r) { return 1e3 * r.figures.max_sensor_age_s; }),
      ChartOverTime(results, "Longest time in which a CPU stood still", "time [ms]",
                    [](const auto& r) { return 1e3 * rt::ToSeconds(r.outcome.cpu_stood_still); }),
      ChartOf("Commanded from measured apex at the end", "distance [µm]",
              {SeriesOf(results, "", ends_by_itself,
                        [](const WallResult& r) { return 1e6 * r.figures.rest_error_m; })}),
      ChartOverTime(results, "Bone removed", "volume [mm³]",
                    [](const auto& r) { return 1e9 * r.figures.removed_m3; }),
      ChartOverTime(results, "Momentum that does not close", "share [%]",
                    [](const auto& r) { return 100.0 * r.figures.momentum_residual; }),
      ChartOf("Energy of the cut that does not close", "share [%]",
              {SeriesOf(results, "", ends_by_itself,
                        [](const WallResult& r) { return 100.0 * std::abs(r.energy_residual()); })})};
  html += report::Figure(report::Svg(panels), "One point for each episode; a killed part's last value.") +
          "<h2>Episodes by event</h2>\n" + EpisodesByEvent(results);
  return html + report::RepeatSection(options.command_line) + report::PageEnd();
}

}  // namespace osteon::studies
