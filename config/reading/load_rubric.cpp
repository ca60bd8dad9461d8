#include "config/reading/load_rubric.h"

#include <fmt/format.h>

#include "config/reading/strict/reader.h"

namespace osteon::config {

procedure::Rubric LoadRubric(const std::filesystem::path& path) {
  constexpr double kMaxNorm = 1e6;
  Reader reader = Reader::Load(path);
  procedure::Rubric rubric{.name = path.stem().string(), .items = {}, .breach_source = {}};
  std::vector<std::pair<Reader, std::string>> sections;  // with the key of the norm for no points
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
  for (std::size_t i = 0; i < rubric.items.size(); ++i)
    if (rubric.items[i].full == rubric.items[i].zero)
      sections[i].first.Refuse(sections[i].second, "found the same as full, accepted another value");
  return rubric;
}

}  // namespace osteon::config
