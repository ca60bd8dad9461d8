#include "studies/failures/failure_item.h"

#include <utility>
#include <vector>

#include "studies/sharding/exact_number.h"

namespace osteon::studies {
namespace {

using nlohmann::json;

json Numbers(const std::vector<double>& values) {
  json list = json::array();
  for (const double value : values) list.push_back(ExactNumber(value));
  return list;
}

std::vector<double> NumbersFrom(const json& list) {
  std::vector<double> values;
  for (const json& value : list) values.push_back(ExactNumberFrom(value));
  return values;
}

json Plot(const FailurePlot& plot) {
  json series = json::array();
  for (const FailureSeries& line : plot.series)
    series.push_back(
        {{"name", line.name}, {"x", Numbers(line.x)}, {"y", Numbers(line.y)}, {"ours", line.ours}});
  return {{"x_label", plot.x_label}, {"y_label", plot.y_label}, {"log_x", plot.log_x},
          {"log_y", plot.log_y},     {"series", series},        {"bound_is_on_y", plot.bound_is_on_y}};
}

FailurePlot PlotFrom(const json& item) {
  FailurePlot plot;
  item.at("x_label").get_to(plot.x_label);
  item.at("y_label").get_to(plot.y_label);
  item.at("log_x").get_to(plot.log_x);
  item.at("log_y").get_to(plot.log_y);
  item.at("bound_is_on_y").get_to(plot.bound_is_on_y);
  for (const json& line : item.at("series"))
    plot.series.push_back({.name = line.at("name").get<std::string>(),
                           .x = NumbersFrom(line.at("x")),
                           .y = NumbersFrom(line.at("y")),
                           .ours = line.at("ours").get<bool>()});
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
          {"plot", Plot(r.plot)},
          {"seconds", ExactNumber(run.seconds)},
          {"error", run.error}};
}

FailureRun FailureRunFrom(const json& item) {
  FailureRun run;
  FailureResult& r = run.result;
  item.at("id").get_to(r.id);
  item.at("name").get_to(r.name);
  item.at("metric").get_to(r.metric);
  item.at("unit").get_to(r.unit);
  item.at("baseline_name").get_to(r.baseline_name);
  r.bound = ExactNumberFrom(item.at("bound"));
  r.baseline = ExactNumberFrom(item.at("baseline"));
  r.ours = ExactNumberFrom(item.at("ours"));
  item.at("baseline_fails").get_to(r.baseline_fails);
  item.at("ours_passes").get_to(r.ours_passes);
  item.at("note").get_to(r.note);
  r.plot = PlotFrom(item.at("plot"));
  run.seconds = ExactNumberFrom(item.at("seconds"));
  item.at("error").get_to(run.error);
  return run;
}

}  // namespace osteon::studies
