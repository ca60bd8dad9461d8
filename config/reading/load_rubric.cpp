#include "config/reading/load_rubric.h"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "config/reading/strict/reader.h"

namespace osteon::config {

namespace {

// Refuses an item that would give more points for a larger error. Refuses items that together give more than
// 100 points.
// @param sections  each item's section, with the key of the value at which the item gives no points
void CheckNorms(const procedure::Rubric& rubric,
                const std::vector<std::pair<Reader, std::string>>& sections) {
  constexpr double kAllPoints = 100.0, kRounding = 1e-9;
  double points = 0.0;
  for (std::size_t i = 0; i < rubric.items.size(); ++i) {
    const procedure::RubricItem& item = rubric.items[i];
    const procedure::Metric& metric = procedure::MetricNamed(item.metric);
    if (metric.more_is_better ? item.zero >= item.full : item.zero <= item.full)
      sections[i].first.Refuse(
          sections[i].second,
          fmt::format("found {:g}, accepted {} than full ({:g})", item.zero * metric.to_unit,
                      metric.more_is_better ? "less" : "more", item.full * metric.to_unit));
    points += item.weight;
    if (points > kAllPoints + kRounding)
      sections[i].first.Refuse(
          "weight_points",
          fmt::format("found {:g} points with those of the items before, accepted at most {:g}", points,
                      kAllPoints));
  }
}

}  // namespace

procedure::Rubric LoadRubric(const std::filesystem::path& path) {
  constexpr double kMaxNorm = 1e6;  // largest accepted value, in the metric's unit
  Reader reader = Reader::Load(path);
  procedure::Rubric rubric{.name = path.stem().string(), .items = {}, .breach_source = {}};
  // with the key of the value at which the item gives no points
  std::vector<std::pair<Reader, std::string>> sections;
  for (const procedure::Metric& metric : procedure::Metrics()) {
    if (!reader.Has(metric.name)) continue;
    Reader section = reader.Section(metric.name);
    const std::string full = fmt::format("full_{}", metric.unit), zero = fmt::format("zero_{}", metric.unit);
    rubric.items.push_back({.metric = metric.name,
                            .weight = section.Number("weight_points", 0, 100),
                            .full = section.Number(full, 0, kMaxNorm),
                            .zero = section.Number(zero, 0, kMaxNorm),
                            .source = section.Text("source")});
    sections.emplace_back(section, zero);
  }
  if (reader.Has("deductions")) {
    Reader deductions = reader.Section("deductions");
    rubric.breach_points = deductions.Number("breach_points", 0, procedure::kMaxDeduction);
    rubric.breach_source = deductions.Text("breach_source");
  }
  reader.Finish();
  CheckNorms(rubric, sections);
  return rubric;
}

}  // namespace osteon::config
