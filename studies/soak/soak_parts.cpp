#include "studies/soak/soak_parts.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/write_text.h"
#include "report/page.h"
#include "session/summary/chart_files.h"

namespace osteon::studies {

void RequireFigures(const EpisodeFigures& figures, const Require& require) {
  require(figures.peak_rendered_N <= kMaxForce_N,
          fmt::format("{:.1f} N were rendered", figures.peak_rendered_N));
  require(figures.momentum_residual <= kMaxMomentumResidual,
          fmt::format("momentum: {:.2f} % do not close", 100.0 * figures.momentum_residual));
  require(!figures.removed_falls, "the removed volume fell");
}

void AddFigures(nlohmann::ordered_json& json, const EpisodeFigures& figures, double debt_J) {
  json.update(nlohmann::ordered_json{{"ticks", figures.ticks},
                                     {"frames", figures.frames},
                                     {"missing_ticks", figures.missing_ticks},
                                     {"complete", figures.complete},
                                     {"peak_rendered_N", figures.peak_rendered_N},
                                     {"max_model_age_s", figures.max_model_age_s},
                                     {"max_sensor_age_s", figures.max_sensor_age_s},
                                     {"max_tracking_m", figures.max_tracking_m},
                                     {"rest_error_m", figures.rest_error_m},
                                     {"momentum_residual", figures.momentum_residual},
                                     {"energy_residual", figures.EnergyResidual(debt_J)},
                                     {"cutting_debt_J", debt_J},
                                     {"removed_mm3", 1e9 * figures.removed_m3}});
}

double QuarterGrowth(const std::vector<double>& values, double share) {
  const std::size_t n = values.size();
  if (n < 8) return 0.0;
  // quantile of the values with index from … to - 1
  const auto quantile = [&](std::size_t from, std::size_t to) {
    std::vector<double> part(values.begin() + static_cast<std::ptrdiff_t>(from),
                             values.begin() + static_cast<std::ptrdiff_t>(to));
    std::ranges::sort(part);
    return part[static_cast<std::size_t>(share * static_cast<double>(part.size()))];
  };
  return quantile(3 * n / 4, n) - quantile(n / 4, n / 2);
}

report::LineChart SoakChart(const char* title, const char* hours, const char* unit,
                            std::vector<report::Series> series) {
  return {.title = title,
          .x_label = hours,
          .y_label = unit,
          .series = std::move(series),
          .legend = false,
          .plot_height_px = 110.0};
}

report::Series SoakPoints(const char* name) {
  return {.name = name, .width_px = 0.0, .marker = report::Marker::kCircle};
}

std::string KindTable(const char* head, const std::vector<EpisodeCount>& counts) {
  std::string html = fmt::format(
      "<table>\n<tr><th>{}</th><th class=\"n\">episodes</th><th class=\"n\">wrong</th></tr>\n", head);
  for (const EpisodeCount& count : counts)
    html += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n", count.name,
                        count.episodes, count.wrong);
  return html + "</table>\n";
}

std::string ValidateOutputs(const SoakOptions& options) {
  if (!options.out.empty())
    if (std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty()) return wrong;
  return session::ValidateOutputFile("--json", options.json);
}

std::string WriteSoakFiles(const SoakOptions& options, const std::string& json, const std::string& page) {
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, json); !written) return written.error();
  if (options.out.empty()) return "";
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  const auto written = report::WritePage(page, options.out / "soak.html");
  return written ? "" : written.error();
}

}  // namespace osteon::studies
