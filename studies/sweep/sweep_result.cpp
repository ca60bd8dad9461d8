#include "studies/sweep/sweep_result.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json_text.h"
#include "base/percentile.h"
#include "session/setup/build_name.h"
#include "studies/sharding/exact_number.h"

namespace osteon::studies {
namespace {

using config::SweepDraw;
using Json = nlohmann::ordered_json;

// JSON of the quantiles of each figure over these outcomes.
Json QuantilesJson(std::span<const SweepOutcome> outcomes) {
  Json json = Json::object();
  for (const SweepFigure& figure : kSweepFigures) {
    const Quantiles q = QuantilesOf(ValuesOf(outcomes, figure));
    json[std::string(figure.name)] = {
        {"min", q.min}, {"p05", q.p05}, {"median", q.median}, {"p95", q.p95}, {"max", q.max}};
  }
  return json;
}

// JSON of the number of runs that had each fault.
Json FaultsJson(std::span<const SweepOutcome> outcomes) {
  std::map<std::string, std::size_t> counts;
  for (const SweepOutcome& outcome : outcomes)
    for (const std::string& fault : outcome.faults) ++counts[fault];
  Json json = Json::object();
  for (const auto& [fault, count] : counts) json[fault] = count;
  return json;
}

// Number of runs that could not be made.
std::size_t CountFailed(std::span<const SweepOutcome> outcomes) {
  return static_cast<std::size_t>(
      std::ranges::count_if(outcomes, [](const SweepOutcome& o) { return !o.error.empty(); }));
}

// Number of runs in which a fault occurred.
std::size_t CountFaulted(std::span<const SweepOutcome> outcomes) {
  return static_cast<std::size_t>(
      std::ranges::count_if(outcomes, [](const SweepOutcome& o) { return !o.faults.empty(); }));
}

// Says how a parameter gets its values, for example "uniform 1 to 3".
std::string TakesText(const config::SweepParameter& p) {
  switch (p.draw) {
    case SweepDraw::kListed:
      return fmt::format("{}", fmt::join(p.values, ", "));
    case SweepDraw::kUniform:
      return fmt::format("uniform {:g} to {:g}", p.low, p.high);
    case SweepDraw::kNormal:
      return fmt::format("normal {:g} sd {:g}", p.mean, p.sd);
    case SweepDraw::kSeed:
      return "seed";
  }
  return "";
}

// JSON of a run's value of each listed parameter; with drawn_too also of each drawn parameter.
Json ValuesJson(const SweepResult& result, const SweepRun& run, bool drawn_too) {
  Json json = Json::object();
  for (std::size_t i = 0; i < run.values.size(); ++i)
    if (drawn_too || result.config.parameters[i].draw == SweepDraw::kListed)
      json[result.config.parameters[i].key] = run.values[i];
  return json;
}

}  // namespace

Quantiles QuantilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  const auto at = [&](double share) { return base::Percentile(values, share); };
  return {.min = at(0.0), .p05 = at(0.05), .median = at(0.5), .p95 = at(0.95), .max = at(1.0)};
}

std::vector<double> ValuesOf(std::span<const SweepOutcome> outcomes, const SweepFigure& figure) {
  std::vector<double> values;
  for (const SweepOutcome& outcome : outcomes)
    if (outcome.error.empty()) values.push_back(outcome.figures.*figure.value);
  return values;
}

nlohmann::json SweepItem(const SweepOutcome& outcome) {
  nlohmann::json figures = nlohmann::json::object();
  for (const SweepFigure& figure : kSweepFigures)
    figures[std::string(figure.name)] = ExactNumber(outcome.figures.*figure.value);
  return {{"error", outcome.error},
          {"ended", outcome.ended},
          {"faults", outcome.faults},
          {"hash", outcome.hash},
          {"figures", std::move(figures)}};
}

SweepOutcome SweepOutcomeFrom(const nlohmann::json& item, const config::SweepConfig& sweep,
                              std::size_t index) {
  SweepOutcome outcome{.run = SweepRunAt(sweep, index)};
  ReadAt(item, "error", outcome.error);
  ReadAt(item, "ended", outcome.ended);
  ReadAt(item, "faults", outcome.faults);
  ReadAt(item, "hash", outcome.hash);
  for (const SweepFigure& figure : kSweepFigures)
    ReadAt(item.at("figures"), std::string(figure.name).c_str(), outcome.figures.*figure.value);
  return outcome;
}

std::vector<std::span<const SweepOutcome>> ByCombination(const SweepResult& result) {
  std::vector<std::span<const SweepOutcome>> groups;
  const std::span<const SweepOutcome> all = result.outcomes;
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = begin;
    while (end < all.size() && all[end].run.combination == all[begin].run.combination) ++end;
    groups.push_back(all.subspan(begin, end - begin));
    begin = end;
  }
  return groups;
}

std::string NameOfCombination(const SweepResult& result, const SweepOutcome& outcome) {
  std::string name;
  for (std::size_t i = 0; i < outcome.run.values.size(); ++i) {
    const config::SweepParameter& parameter = result.config.parameters[i];
    if (parameter.draw != SweepDraw::kListed || parameter.values.size() < 2) continue;
    name += fmt::format("{}{} {}", name.empty() ? "" : ", ",
                        parameter.key.substr(parameter.key.rfind('.') + 1), outcome.run.values[i]);
  }
  return name.empty() ? "all" : name;
}

std::string SweepTable(const SweepResult& result) {
  std::size_t width = 11;
  const auto groups = ByCombination(result);
  for (const auto& group : groups) width = std::max(width, NameOfCombination(result, group.front()).size());
  std::string text =
      fmt::format("{:<{}} {:>5} {:>6}  {}\n", "combination", width, "runs", "faults",
                  "median and 95th percentile of peak force [N], tool in bone [mm], removed [mm3]");
  for (const auto& group : groups) {
    text += fmt::format("{:<{}} {:>5} {:>6} ", NameOfCombination(result, group.front()), width, group.size(),
                        CountFaulted(group));
    // indices in kSweepFigures of the three figures that the heading names
    for (const std::size_t figure : {0u, 2u, 4u}) {
      const Quantiles q = QuantilesOf(ValuesOf(group, kSweepFigures[figure]));
      text += fmt::format("{:>9.2f} {:>8.2f}", q.median, q.p95);
    }
    text += "\n";
  }
  for (const SweepOutcome& outcome : result.outcomes)
    if (!outcome.error.empty()) text += fmt::format("run {}: {}\n", outcome.run.index, outcome.error);
  return text + fmt::format("{} runs, {} with a fault, {} could not be made\n", result.outcomes.size(),
                            CountFaulted(result.outcomes), CountFailed(result.outcomes));
}

std::string SweepJson(const SweepResult& result) {
  const config::SweepConfig& config = result.config;
  Json json{{"schema", "osteon.sweep/1"},
            {"name", config.name},
            {"shows", config.shows},
            {"scenario", result.scenario},
            {"build", session::BuildName()},
            {"passed", CountFailed(result.outcomes) == 0},
            {"seeds", config.seeds},
            {"runs", result.outcomes.size()},
            {"runs_with_faults", CountFaulted(result.outcomes)},
            {"runs_not_made", CountFailed(result.outcomes)},
            {"faults", FaultsJson(result.outcomes)},
            {"parameters", Json::array()},
            {"figures", QuantilesJson(result.outcomes)},
            {"combinations", Json::array()},
            {"results", Json::array()}};
  for (const config::SweepParameter& parameter : config.parameters)
    json["parameters"].push_back({{"key", parameter.key}, {"takes", TakesText(parameter)}});
  for (const auto& group : ByCombination(result))
    json["combinations"].push_back({{"values", ValuesJson(result, group.front().run, false)},
                                    {"runs", group.size()},
                                    {"faults", FaultsJson(group)},
                                    {"figures", QuantilesJson(group)}});
  for (const SweepOutcome& outcome : result.outcomes) {
    Json entry{{"run", outcome.run.index},
               {"seed", outcome.run.seed},
               {"values", ValuesJson(result, outcome.run, true)},
               {"error", outcome.error.empty() ? Json() : Json(outcome.error)},
               {"ended", outcome.ended},
               {"faults", outcome.faults},
               {"hash", outcome.hash}};
    for (const SweepFigure& figure : kSweepFigures)
      entry[std::string(figure.name)] = outcome.figures.*figure.value;
    json["results"].push_back(std::move(entry));
  }
  return base::JsonText(json);
}

std::string SweepCsv(const SweepResult& result) {
  std::string csv = "run,seed";
  for (const config::SweepParameter& parameter : result.config.parameters) csv += "," + parameter.key;
  for (const SweepFigure& figure : kSweepFigures) csv += fmt::format(",{}", figure.name);
  csv += ",faults\n";
  for (const SweepOutcome& outcome : result.outcomes) {
    csv += fmt::format("{},{},{}", outcome.run.index, outcome.run.seed, fmt::join(outcome.run.values, ","));
    for (const SweepFigure& figure : kSweepFigures)
      csv += outcome.error.empty() ? fmt::format(",{:.6g}", outcome.figures.*figure.value) : ",";
    csv += fmt::format(",{}\n", fmt::join(outcome.faults, " "));
  }
  return csv;
}

}  // namespace osteon::studies
