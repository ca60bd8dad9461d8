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

/// Options of `osteon assess`.
struct AssessOptions {
  std::filesystem::path session;    ///< folder of the session
  std::filesystem::path rubric;     ///< file of the rubric; empty: the shipped one for the plan's kind
  std::filesystem::path rubrics{};  ///< folder of the shipped ones
  std::optional<double> pass_at{};  ///< lowest score that passes; below it, the exit code is 1
  /// Sessions of a site's own experts; they must be guided if and only if this session is
  std::vector<std::filesystem::path> norms{};
  /// Assessed sessions for the trend, in addition to those that are found
  std::vector<std::filesystem::path> trend{};
  std::filesystem::path against{};  ///< session of the same plan to compare with; empty: none
  std::filesystem::path json{};     ///< file for a copy of the result; empty: none
  std::string command_line{};
};

/// All results that the page and the JSON contain.
struct AssessResult {
  AssessedSession session;
  procedure::Rubric rubric;
  procedure::MetricValues values;
  procedure::Score score;
  Norms norms;
  Trend trend;  ///< includes this session
  bool guided{false};
  std::optional<double> pass_at{};  ///< AssessOptions::pass_at
  Unfinished unfinished{};
};

/// Says where the cup that `tell cup` recorded stands relative to the plan's cup_cone: "free", "within stop",
/// "beyond stop". Empty if no cup was recorded, or the plan has no cup_cone.
[[nodiscard]] const char* CupConePlace(const procedure::SurgicalPlan& plan,
                                       const procedure::Assessment& found);

/// JSON of `osteon assess`, schema osteon.assess/1.
[[nodiscard]] nlohmann::ordered_json AssessJson(const AssessResult& result);

/// Runs `osteon assess`: writes assess.html, assess.json and trend.csv into the session's folder, and prints
/// the score. If another session is given, it also writes compare.html and compare.png, where each score says
/// whether its session was guided.
/// @returns the process's exit code: 0; 1 if a file cannot be written, or if `pass_at` is given and the score
///   is below it, the plan is not finished or a recording is incomplete; 2 for wrong input.
[[nodiscard]] int RunAssess(const AssessOptions& options);

}  // namespace osteon::studies
