#pragma once

#include <string>
#include <vector>

namespace osteon::studies {

struct AssessResult;

/// File of a result within a session's folder, and its schema.
inline constexpr const char* kResultName = "assess.json";
inline constexpr const char* kAssessSchema = "osteon.assess/1";

/// The result of a session of the plan: another folder's assess.json, or this session's own.
struct TrendPoint {
  std::string session;
  double score{0.0};
  bool guided{false};
};

/// The results of other sessions of the same plan and rubric, in folders beside this one, and this one's, by
/// the folders' names.
[[nodiscard]] std::vector<TrendPoint> ReadTrend(const AssessResult& result);

}  // namespace osteon::studies
