#include "studies/assess/trend.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <nlohmann/json.hpp>

#include "base/json_value.h"
#include "studies/assess/assess_result.h"

namespace osteon::studies {

std::vector<TrendPoint> ReadTrend(const AssessResult& result) {
  const std::filesystem::path own = std::filesystem::weakly_canonical(result.session.folder);
  std::vector<TrendPoint> trend{
      {.session = own.filename().string(), .score = result.score.total, .guided = result.guided}};
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(own.parent_path(), error)) {
    if (entry.path() == own) continue;
    std::ifstream stream(entry.path() / kResultName);
    if (!stream) continue;
    const auto json = nlohmann::ordered_json::parse(stream, nullptr, false);
    const auto &plan = base::ValueAt(json, "plan"), &score = base::ValueAt(json, "score");
    if (base::TextAt(json, "schema") != kAssessSchema ||
        base::TextAt(plan, "checksum") != result.session.file.plan_checksum ||
        base::TextAt(score, "rubric") != result.rubric.name || !base::ValueAt(score, "total").is_number())
      continue;
    trend.push_back({.session = entry.path().filename().string(),
                     .score = base::NumberAt(score, "total"),
                     .guided = base::FlagAt(json, "guided")});
  }
  std::ranges::sort(trend, {}, &TrendPoint::session);
  return trend;
}

}  // namespace osteon::studies
