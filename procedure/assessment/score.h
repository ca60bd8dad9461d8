#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace osteon::procedure {

/// When the value of a metric is known in a running session.
enum class MetricKnown : std::uint8_t {
  kWithLastTool,    ///< once the last tool has cut: earlier, the value tells what is still to be cut
  kWithAnyCut,      ///< after any cut: the value is about removed bone, which no later cut brings back
  kWithRecordings,  ///< after the session: the value needs the ticks of all its recordings
};

/// A figure that a rubric may score.
struct Metric {
  const char* name;  ///< as in the rubric: "axis_error"
  const char* unit;  ///< unit in the rubric, with which its keys end: "deg"
  double to_unit;    ///< factor from SI
  const char* text;  ///< for people: "axis error"
  bool more_is_better{false};
  MetricKnown known{MetricKnown::kWithLastTool};
};
/// All metrics, in the order of the report.
[[nodiscard]] std::span<const Metric> Metrics();
/// @param name  of one of Metrics()
[[nodiscard]] const Metric& MetricNamed(std::string_view name);

/// The rule of a rubric for one metric, with `full` and `zero` in SI: full points at `full` or better, none
/// at `zero` or worse, linear between them. If full > zero, a larger value is better.
struct RubricItem {
  std::string metric;
  double weight{0.0}, full{0.0}, zero{0.0};
  std::string source;  ///< source of the norm
};

/// The rules by which a session is scored.
struct Rubric {
  std::string name;
  std::vector<RubricItem> items;
  double breach_points{0.0};  ///< deduction if no wall is left; 0: a breach is not judged
  std::string breach_source;
};

/// Values by the metric's name, in SI. A metric that could not be measured is absent.
using MetricValues = std::map<std::string, double>;

/// A rule with the measured value; nothing: it could not be measured, and has no points.
struct ScoredItem {
  RubricItem item;
  std::optional<double> value;
  double points{0.0};  ///< 0 … weight
};
struct Deduction {
  std::string name, source;
  double points{0.0};
};
struct Score {
  double total{0.0};  ///< 0 … the sum of the weights
  std::vector<ScoredItem> items;
  std::vector<Deduction> deductions;
};

/// Largest sum of deductions [points].
inline constexpr double kMaxDeduction = 50.0;

/// score = sum of weight clamp((zero - x) / (zero - full), 0, 1), less deductions of at most kMaxDeduction;
/// never below 0. A value that is absent has no points.
/// @param min_wall_m  thickness of the thinnest wall; 0 or less is a breach; nothing: it is not known
[[nodiscard]] Score ScoreOf(const Rubric& rubric, const MetricValues& values,
                            std::optional<double> min_wall_m);

}  // namespace osteon::procedure
