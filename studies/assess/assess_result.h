#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "procedure/assessment/score.h"
#include "studies/assess/norms.h"
#include "studies/assess/session_reading.h"
#include "studies/assess/trend.h"
#include "studies/assess/unfinished.h"

namespace osteon::studies {

struct AssessOptions {
  std::filesystem::path session;               ///< folder
  std::filesystem::path rubric;                ///< empty: the shipped one for the plan's kind
  std::filesystem::path rubrics{};             ///< folder of the shipped ones
  std::optional<double> pass_at{};             ///< score below which the exit code is 1
  std::vector<std::filesystem::path> norms{};  ///< sessions of a site's own experts, as guided as this one
  std::vector<std::filesystem::path> trend{};  ///< assessed sessions, beside those that are found
  std::filesystem::path against{};             ///< another session of the plan; empty: none
  std::filesystem::path json{};                ///< a copy of the result; empty: none
  std::string command_line{};
};

/// All that the page and the JSON say.
struct AssessResult {
  AssessedSession session;
  procedure::Rubric rubric;
  procedure::MetricValues values;
  procedure::Score score;
  Norms norms;
  Trend trend;  ///< with this session
  bool guided{false};
  std::optional<double> pass_at{};  ///< as asked
  Unfinished unfinished{};
};

/// Where the cup of `tell cup` stands in the plan's cup_cone: "free", "within stop", "beyond stop"; empty: no
/// cup was kept, or the plan has no such cone.
[[nodiscard]] const char* CupConePlace(const procedure::SurgicalPlan& plan,
                                       const procedure::Assessment& found);

/// JSON of `osteon assess`, schema osteon.assess/1.
[[nodiscard]] nlohmann::ordered_json AssessJson(const AssessResult& result);

/// Runs `osteon assess`: writes assess.html, assess.json and trend.csv into the session's folder, and prints
/// the score; with another session compare.html and compare.png as well, where each score says whether it was
/// guided.
/// @returns the process's exit code: 0; 1 the score is below `pass_at` or the plan not finished with it, or a
/// file cannot be written; 2 wrong input.
[[nodiscard]] int RunAssess(const AssessOptions& options);

}  // namespace osteon::studies
