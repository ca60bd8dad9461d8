#include "studies/soak/soak_page.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "report/page.h"
#include "report/svg_plot.h"
#include "studies/soak/soak_parts.h"

namespace osteon::studies {
namespace {

// A chart of one figure, a point for each episode, over the simulated hours.
report::LineChart ChartOverTime(std::span<const EpisodeResult> episodes, const char* title, const char* unit,
                                const std::function<double(const EpisodeResult&)>& value) {
  report::Series series = SoakPoints("");
  double hours = 0.0;
  for (const EpisodeResult& result : episodes) {
    hours += result.seconds_simulated / 3600.0;
    series.x.push_back(hours);
    series.y.push_back(value(result));
  }
  return SoakChart(title, "simulated time [h]", unit, {std::move(series)});
}

// HTML table: the number of episodes of each kind, and how many had an error.
std::string EpisodesByKind(std::span<const EpisodeResult> episodes) {
  std::vector<EpisodeCount> counts;
  for (int i = 0; i < kEpisodeKinds; ++i) {
    const auto kind = static_cast<EpisodeKind>(i);
    EpisodeCount& count = counts.emplace_back(EpisodeCount{.name = NameOf(kind)});
    for (const EpisodeResult& r : episodes) {
      if (r.episode.kind != kind) continue;
      ++count.episodes;
      count.wrong += r.wrong.empty() ? 0 : 1;
    }
  }
  return KindTable("kind", counts);
}

}  // namespace

std::string SoakPage(std::span<const EpisodeResult> episodes, const SoakOptions& options) {
  double simulated_s = 0.0, wall_s = 0.0;
  report::ReportVerdict verdict;
  for (const EpisodeResult& result : episodes) {
    simulated_s += result.seconds_simulated;
    wall_s += result.seconds_wall;
    for (const std::string& wrong : result.wrong)
      verdict.reasons.push_back(
          fmt::format("episode {} ({}): {}", result.episode.index, result.episode.text, wrong));
  }
  const double growth_MB = MemoryGrowth_MB(episodes);
  if (growth_MB > kMaxMemoryGrowth_MB)
    verdict.reasons.push_back(fmt::format("the memory grew by {:.1f} MB", growth_MB));
  if (!verdict.reasons.empty()) verdict.level = "bad";
  std::string html = report::PageBegin(
      {.title = "Osteon soak",
       .subtitle = "The simulated cell in virtual time, episode after episode",
       .verdict = verdict,
       .summary = {
           {"Simulated", fmt::format("{:.2f} h in {} episodes", simulated_s / 3600.0, episodes.size())},
           {"Wall time", fmt::format("{:.2f} h", wall_s / 3600.0)},
           {"Seed", std::to_string(options.seed)},
           {"Memory grew by", fmt::format("{:.1f} MB", growth_MB)}}});
  const std::array panels{
      ChartOverTime(episodes, "Resident memory", "memory [MB]", [](const auto& r) { return r.memory_MB; }),
      ChartOverTime(episodes, "Peak rendered force", "force [N]",
                    [](const auto& r) { return r.figures.peak_rendered_N; }),
      ChartOverTime(episodes, "Age of the contact model, most while rendering", "age [ms]",
                    [](const auto& r) { return 1e3 * r.figures.max_model_age_s; }),
      ChartOverTime(episodes, "Age of the force sensor, most while rendering", "age [ms]",
                    [](const auto& r) { return 1e3 * r.figures.max_sensor_age_s; }),
      ChartOverTime(episodes, "Commanded from measured apex at the end", "distance [µm]",
                    [](const auto& r) { return 1e6 * r.figures.rest_error_m; }),
      ChartOverTime(episodes, "Momentum that does not close", "share [%]",
                    [](const auto& r) { return 100.0 * r.figures.momentum_residual; }),
      ChartOverTime(episodes, "Work that the edge still owes for cleared bone", "work [J]",
                    [](const auto& r) { return r.cutting_debt_J; }),
      ChartOverTime(episodes, "Energy of the cut that does not close", "share [%]",
                    [](const auto& r) { return 100.0 * std::abs(r.energy_residual()); })};
  html += report::Figure(report::Svg(panels), "One point for each episode.") + "<h2>Episodes by kind</h2>\n" +
          EpisodesByKind(episodes);
  return html + report::RepeatSection(options.command_line) + report::PageEnd();
}

}  // namespace osteon::studies
