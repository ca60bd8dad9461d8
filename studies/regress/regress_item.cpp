#include "studies/regress/regress_item.h"

#include <stdexcept>
#include <utility>

#include "studies/sharding/exact_number.h"

namespace osteon::studies {
namespace {

using nlohmann::json;

// JSON of the times of a run [s].
json TimesJson(const ScenarioRun& run) {
  return {{"simulated", ExactNumber(run.seconds_simulated)},
          {"wall", ExactNumber(run.seconds_wall)},
          {"cpu", ExactNumber(run.seconds_cpu)},
          {"set_up", ExactNumber(run.seconds_set_up)}};
}

// JSON of a trace. @param with_samples  the samples are needed only for the page, which shows traces that
// differ
json TraceJson(const ScenarioTrace& trace, bool with_samples) {
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

// Reads a trace from JSON. @throws std::invalid_argument if a sample has a wrong number of values
ScenarioTrace TraceFrom(const json& item) {
  ScenarioTrace trace;
  ReadAt(item, "period_s", trace.period_s);
  ReadAt(item, "ticks", trace.ticks);
  ReadAt(item, "hash", trace.hash);
  ReadAt(item, "ended", trace.ended);
  for (const json& sample : item.at("samples")) {
    TraceSample& restored = trace.samples.emplace_back();
    ReadAt(sample, "tick", restored.tick);
    for (const json& value : sample.at("values")) restored.values.push_back(ExactNumberFrom(value));
    if (restored.values.size() != TraceQuantities().size())
      throw std::invalid_argument("found a sample with " + std::to_string(restored.values.size()) +
                                  " values, accepted " + std::to_string(TraceQuantities().size()));
  }
  return trace;
}

json DifferenceJson(const TraceDifference& difference) {
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

// Reads a difference from JSON. @throws std::invalid_argument if it names a part or a quantity that does not
// exist
TraceDifference DifferenceFrom(const json& item) {
  TraceDifference difference;
  ReadAt(item, "identical", difference.identical);
  ReadAt(item, "passed", difference.passed);
  ReadAt(item, "others", difference.others);
  ReadAt(item, "first_tick", difference.first_tick);
  for (const json& part : item.at("parts")) {
    const int number = part.at("part").get<int>();
    if (number < 0 || number >= kTraceParts)
      throw std::invalid_argument("found part " + std::to_string(number) + ", accepted 0 … 6");
    difference.parts.push_back(
        {.part = static_cast<TracePart>(number), .tick = part.at("tick").get<std::uint64_t>()});
  }
  for (const json& d : item.at("quantities")) {
    QuantityDifference& restored = difference.quantities.emplace_back();
    ReadAt(d, "quantity", restored.quantity);
    if (restored.quantity >= TraceQuantities().size())
      throw std::invalid_argument("found quantity " + std::to_string(restored.quantity) +
                                  ", accepted below " + std::to_string(TraceQuantities().size()));
    ReadAt(d, "tolerance", restored.tolerance);
    ReadAt(d, "worst", restored.worst);
    ReadAt(d, "worst_tick", restored.worst_tick);
    ReadAt(d, "between_samples", restored.between_samples);
    ReadAt(d, "golden", restored.golden);
    ReadAt(d, "now", restored.now);
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
            {"difference", DifferenceJson(result.difference)}};
  if (result.run)
    item["run"] = {{"engine", result.run->engine},
                   {"seconds", TimesJson(*result.run)},
                   {"trace", TraceJson(result.run->trace, result.golden && !result.identical())}};
  return item;
}

RegressResult RegressResultFrom(const json& item, const config::ScenarioConfig& scenario) {
  RegressResult result;
  result.scenario = scenario;
  ReadAt(item, "error", result.error);
  ReadAt(item, "explained", result.explained);
  result.difference = DifferenceFrom(item.at("difference"));
  if (const json& run = item.at("run"); !run.is_null()) {
    ScenarioRun& restored = result.run.emplace();
    ReadAt(run, "engine", restored.engine);
    const json& seconds = run.at("seconds");
    ReadAt(seconds, "simulated", restored.seconds_simulated);
    ReadAt(seconds, "wall", restored.seconds_wall);
    ReadAt(seconds, "cpu", restored.seconds_cpu);
    ReadAt(seconds, "set_up", restored.seconds_set_up);
    restored.trace = TraceFrom(run.at("trace"));
  }
  if (!item.at("has_golden").get<bool>()) return result;
  auto golden = ReadGolden(scenario.golden());
  if (!golden) throw std::invalid_argument(golden.error());
  result.golden = std::move(*golden);
  return result;
}

}  // namespace osteon::studies
