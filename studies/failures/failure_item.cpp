#include "studies/failures/failure_item.h"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "studies/sharding/exact_number.h"

namespace osteon::studies {
namespace {

using nlohmann::json;

// A JSON array that reads back to the bit.
json Numbers(const std::vector<double>& values) {
  json list = json::array();
  for (const double value : values) list.push_back(ExactNumber(value));
  return list;
}

json PlotItem(const FailurePlot& plot) {
  json series = json::array();
  for (const FailureSeries& line : plot.series)
    series.push_back(
        {{"name", line.name}, {"x", Numbers(line.x)}, {"y", Numbers(line.y)}, {"ours", line.ours}});
  return {{"x_label", plot.x_label}, {"y_label", plot.y_label}, {"log_x", plot.log_x},
          {"log_y", plot.log_y},     {"series", series},        {"bound_is_on_y", plot.bound_is_on_y}};
}

FailurePlot PlotFrom(const json& item) {
  FailurePlot plot;
  ReadAt(item, "x_label", plot.x_label);
  ReadAt(item, "y_label", plot.y_label);
  ReadAt(item, "log_x", plot.log_x);
  ReadAt(item, "log_y", plot.log_y);
  ReadAt(item, "bound_is_on_y", plot.bound_is_on_y);
  for (const json& line : item.at("series")) {
    FailureSeries& series = plot.series.emplace_back();
    ReadAt(line, "name", series.name);
    ReadAt(line, "x", series.x);
    ReadAt(line, "y", series.y);
    ReadAt(line, "ours", series.ours);
    if (series.x.size() != series.y.size())
      throw std::invalid_argument(
          fmt::format("y: found {} numbers, accepted {}, as x has", series.y.size(), series.x.size()));
  }
  return plot;
}

}  // namespace

json FailureItem(const FailureRun& run) {
  const FailureResult& r = run.result;
  return {{"id", r.id},
          {"name", r.name},
          {"metric", r.metric},
          {"unit", r.unit},
          {"baseline_name", r.baseline_name},
          {"bound", ExactNumber(r.bound)},
          {"baseline", ExactNumber(r.baseline)},
          {"ours", ExactNumber(r.ours)},
          {"baseline_fails", r.baseline_fails},
          {"ours_passes", r.ours_passes},
          {"note", r.note},
          {"plot", PlotItem(r.plot)},
          {"seconds", ExactNumber(run.seconds)},
          {"error", run.error}};
}

FailureRun FailureRunFrom(const json& item) {
  FailureRun run;
  FailureResult& r = run.result;
  ReadAt(item, "id", r.id);
  ReadAt(item, "name", r.name);
  ReadAt(item, "metric", r.metric);
  ReadAt(item, "unit", r.unit);
  ReadAt(item, "baseline_name", r.baseline_name);
  ReadAt(item, "bound", r.bound);
  ReadAt(item, "baseline", r.baseline);
  ReadAt(item, "ours", r.ours);
  ReadAt(item, "baseline_fails", r.baseline_fails);
  ReadAt(item, "ours_passes", r.ours_passes);
  if (r.ours_passes && std::isnan(r.ours))
    throw std::invalid_argument("ours_passes: found true with ours nan, accepted true with a number alone");
  ReadAt(item, "note", r.note);
  r.plot = PlotFrom(item.at("plot"));
  ReadAt(item, "seconds", run.seconds);
  ReadAt(item, "error", run.error);
  return run;
}

}  // namespace osteon::studies
