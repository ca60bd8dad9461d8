#include "studies/regress/regress_item.h"

#include <stdexcept>
#include <utility>

#include "studies/sharding/exact_number.h"

namespace osteon::studies {
namespace {

using nlohmann::json;

json Times(const ScenarioRun& run) {
  return {{"simulated", ExactNumber(run.seconds_simulated)},
          {"wall", ExactNumber(run.seconds_wall)},
          {"cpu", ExactNumber(run.seconds_cpu)},
          {"set_up", ExactNumber(run.seconds_set_up)}};
}

// The samples are for the page, which shows only what is not identical.
json Trace(const ScenarioTrace& trace, bool with_samples) {
  json samples = json::array();
  if (with_samples)
    for (const TraceSample& sample : trace.samples) {
      json values = json::array();
      for (const double value : sample.values) values.push_back(ExactNumber(value));
      samples.push_back({{"tick", sample.tick}, {"values", std::move(values)}});
    }
  return {{"period_s", ExactNumber(trace.period_s)},
          {"ticks", trace.ticks},
          {"hash", trace.hash},
          {"ended", trace.ended},
          {"samples", std::move(samples)}};
}

ScenarioTrace TraceFrom(const json& item) {
  ScenarioTrace trace;
  trace.period_s = ExactNumberFrom(item.at("period_s"));
  item.at("ticks").get_to(trace.ticks);
  item.at("hash").get_to(trace.hash);
  item.at("ended").get_to(trace.ended);
  for (const json& sample : item.at("samples")) {
    TraceSample& restored = trace.samples.emplace_back();
    sample.at("tick").get_to(restored.tick);
    for (const json& value : sample.at("values")) restored.values.push_back(ExactNumberFrom(value));
    if (restored.values.size() != TraceQuantities().size())
      throw std::invalid_argument("found a sample with " + std::to_string(restored.values.size()) +
                                  " values, accepted " + std::to_string(TraceQuantities().size()));
  }
  return trace;
}

json Difference(const TraceDifference& difference) {
  json parts = json::array(), quantities = json::array();
  for (const PartDifference& part : difference.parts)
    parts.push_back({{"part", static_cast<int>(part.part)}, {"tick", part.tick}});
  for (const QuantityDifference& d : difference.quantities)
    quantities.push_back({{"quantity", d.quantity},
                          {"tolerance", ExactNumber(d.tolerance)},
                          {"worst", ExactNumber(d.worst)},
                          {"worst_tick", d.worst_tick},
                          {"between_samples", d.between_samples},
                          {"golden", ExactNumber(d.golden)},
                          {"now", ExactNumber(d.now)},
                          {"left_tick", d.left_tick ? json(*d.left_tick) : json()}});
  return {{"identical", difference.identical}, {"passed", difference.passed},
          {"parts", std::move(parts)},         {"quantities", std::move(quantities)},
          {"others", difference.others},       {"first_tick", difference.first_tick}};
}

TraceDifference DifferenceFrom(const json& item) {
  TraceDifference difference;
  item.at("identical").get_to(difference.identical);
  item.at("passed").get_to(difference.passed);
  item.at("others").get_to(difference.others);
  item.at("first_tick").get_to(difference.first_tick);
  for (const json& part : item.at("parts")) {
    const int number = part.at("part").get<int>();
    if (number < 0 || number >= kTraceParts)
      throw std::invalid_argument("found part " + std::to_string(number) + ", accepted 0 … 6");
    difference.parts.push_back(
        {.part = static_cast<TracePart>(number), .tick = part.at("tick").get<std::uint64_t>()});
  }
  for (const json& d : item.at("quantities")) {
    QuantityDifference& restored = difference.quantities.emplace_back();
    d.at("quantity").get_to(restored.quantity);
    if (restored.quantity >= TraceQuantities().size())
      throw std::invalid_argument("found quantity " + std::to_string(restored.quantity) +
                                  ", accepted below " + std::to_string(TraceQuantities().size()));
    restored.tolerance = ExactNumberFrom(d.at("tolerance"));
    restored.worst = ExactNumberFrom(d.at("worst"));
    d.at("worst_tick").get_to(restored.worst_tick);
    d.at("between_samples").get_to(restored.between_samples);
    restored.golden = ExactNumberFrom(d.at("golden"));
    restored.now = ExactNumberFrom(d.at("now"));
    if (!d.at("left_tick").is_null()) restored.left_tick = d["left_tick"].get<std::uint64_t>();
  }
  return difference;
}

}  // namespace

json RegressItem(const RegressResult& result) {
  json item{{"error", result.error},
            {"explained", result.explained},
            {"has_golden", result.golden.has_value()},
            {"run", nullptr},
            {"difference", Difference(result.difference)}};
  if (result.run)
    item["run"] = {{"engine", result.run->engine},
                   {"seconds", Times(*result.run)},
                   {"trace", Trace(result.run->trace, result.golden && !result.identical())}};
  return item;
}

RegressResult RegressResultFrom(const json& item, const config::ScenarioConfig& scenario) {
  RegressResult result;
  result.scenario = scenario;
  item.at("error").get_to(result.error);
  item.at("explained").get_to(result.explained);
  result.difference = DifferenceFrom(item.at("difference"));
  if (const json& run = item.at("run"); !run.is_null()) {
    ScenarioRun& restored = result.run.emplace();
    run.at("engine").get_to(restored.engine);
    const json& seconds = run.at("seconds");
    restored.seconds_simulated = ExactNumberFrom(seconds.at("simulated"));
    restored.seconds_wall = ExactNumberFrom(seconds.at("wall"));
    restored.seconds_cpu = ExactNumberFrom(seconds.at("cpu"));
    restored.seconds_set_up = ExactNumberFrom(seconds.at("set_up"));
    restored.trace = TraceFrom(run.at("trace"));
  }
  if (!item.at("has_golden").get<bool>()) return result;
  auto golden = ReadGolden(scenario.golden());
  if (!golden) throw std::invalid_argument(golden.error());
  result.golden = std::move(*golden);
  return result;
}

}  // namespace osteon::studies
