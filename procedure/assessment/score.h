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
  kWithLastTool,    ///< once the last tool has cut; before that, the value shows only what remains to be cut
  kWithAnyCut,      ///< after any cut, because the value depends on removed bone, which no later cut restores
  kWithRecordings,  ///< after the session, because the value needs the ticks of all recordings
};

/// A figure that a rubric may score.
struct Metric {
  const char* name;  ///< as in the rubric: "axis_error"
  const char* unit;  ///< unit in the rubric, with which its keys end: "deg"
  double to_unit;    ///< factor from SI to `unit`
  const char* text;  ///< for people: "axis error"
  bool more_is_better{false};
  MetricKnown known{MetricKnown::kWithLastTool};
};
/// All metrics, in the order of the report.
[[nodiscard]] std::span<const Metric> Metrics();
/// Returns the metric of this name. @param name  one of those in Metrics()
[[nodiscard]] const Metric& MetricNamed(std::string_view name);

/// The rule of a rubric for one metric, with `full` and `zero` in SI: full points at `full` or better, none
/// at `zero` or worse, linear between them. If full > zero, a larger value is better.
struct RubricItem {
  std::string metric;
  double weight{0.0}, full{0.0}, zero{0.0};
  std::string source;  ///< publication from which `full` and `zero` come
};

/// The rules by which a session is scored.
struct Rubric {
  std::string name;
  std::vector<RubricItem> items;
  double breach_points{0.0};  ///< deduction if a wall was cut through; 0: this is not judged
  std::string breach_source;
};

/// Values by the metric's name, in SI. A metric that could not be measured is absent.
using MetricValues = std::map<std::string, double>;

/// A rule with the measured value. An absent value could not be measured and has no points.
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

/// score = sum of weight clamp((zero - x) / (zero - full), 0, 1), minus deductions of at most kMaxDeduction,
/// but never below 0. x is the measured value; an absent value has no points.
/// @param min_wall_m  thickness of the thinnest wall; 0 or less: a wall was cut through; nothing: not known
[[nodiscard]] Score ScoreOf(const Rubric& rubric, const MetricValues& values,
                            std::optional<double> min_wall_m);

}  // namespace osteon::procedure
