#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/reading/scenario_config.h"
#include "studies/regress/scenario_trace.h"

namespace osteon::studies {

/// A part of a tick, and the first tick in which its digest differs. A 12-bit digest misses a difference with
/// a probability of 1 / 4096; the next tick then shows the difference.
struct PartDifference {
  TracePart part{TracePart::kArm};
  std::uint64_t tick{0};
};

/// The difference of one quantity between two traces.
struct QuantityDifference {
  std::size_t quantity{0};  ///< index in TraceQuantities
  double tolerance{0.0};
  /// Largest |now - golden| over the samples and over the extremes of all ticks.
  double worst{0.0};
  std::uint64_t worst_tick{0};               ///< tick of the sample with the difference `worst`
  bool between_samples{false};               ///< `worst` is a difference of extremes, which no sample shows
  double golden{0.0}, now{0.0};              ///< the two values whose difference is `worst`
  std::optional<std::uint64_t> left_tick{};  ///< tick of the first sample beyond the tolerance

  [[nodiscard]] bool beyond() const { return worst > tolerance; }
  /// `worst` divided by the tolerance.
  [[nodiscard]] double ratio() const;
};

/// The difference of a run from its golden trace.
struct TraceDifference {
  bool identical{false};  ///< every bit of every tick is the same
  bool passed{false};     ///< every quantity and event is within its tolerance
  /// The parts that differ, sorted by the first differing tick, then in the order of TracePart.
  std::vector<PartDifference> parts;
  /// All that differ: first those beyond their tolerance, by the time they left it; then by size.
  std::vector<QuantityDifference> quantities;
  std::vector<std::string> others;  ///< other differences, one line each: events, the end
  std::uint64_t first_tick{0};      ///< tick of the first golden digest

  /// Number of quantities beyond their tolerance.
  [[nodiscard]] std::size_t Beyond() const;
};

/// Compares a run with its golden trace.
[[nodiscard]] TraceDifference Compare(const ScenarioTrace& golden, const ScenarioTrace& now,
                                      const config::TraceTolerances& tolerances);

/// Returns at most `most` quantities, the first of each family: a difference in one axis mostly appears in
/// the other axes as well. If quantities are beyond their tolerance, only these are returned.
[[nodiscard]] std::vector<QuantityDifference> Telling(const TraceDifference& difference, std::size_t most);

/// Explains the difference in a few lines: where it began, which quantity left its tolerance first and by how
/// much, and events. Empty if the two traces are identical.
[[nodiscard]] std::vector<std::string> Explain(const TraceDifference& difference, const ScenarioTrace& now);

}  // namespace osteon::studies
