#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/reading/scenario_config.h"
#include "studies/regress/scenario_trace.h"

namespace osteon::studies {

/// The first tick in which a part's digest differs. A 12-bit digest misses a difference in one tick of 4096,
/// and then shows it in the next tick.
struct PartDifference {
  TracePart part{TracePart::kArm};
  std::uint64_t tick{0};
};

/// The difference of one quantity between two traces.
struct QuantityDifference {
  std::size_t quantity{0};  ///< index in TraceQuantities
  double tolerance{0.0};
  double worst{0.0};             ///< greatest |now - golden| of a sample, or of the extremes of all ticks
  std::uint64_t worst_tick{0};   ///< tick of the sample with that difference
  bool between_samples{false};   ///< `worst` is of the extremes; no sample shows it
  double golden{0.0}, now{0.0};  ///< at `worst`
  std::optional<std::uint64_t> left_tick{};  ///< the first sample beyond the tolerance

  [[nodiscard]] bool beyond() const { return worst > tolerance; }
  /// `worst` divided by the tolerance.
  [[nodiscard]] double ratio() const;
};

/// The difference of a run from its golden trace.
struct TraceDifference {
  bool identical{false};  ///< in every bit of every tick
  bool passed{false};     ///< every quantity and event within its tolerance
  /// The parts that differ, the earliest first; at equal ticks in the order of TracePart.
  std::vector<PartDifference> parts;
  std::vector<QuantityDifference> quantities;  ///< all that differ: first those beyond their tolerance by the
                                               ///< time they left it; then by size
  std::vector<std::string> others;             ///< other differences, one line each: events, the end
  std::uint64_t first_tick{0};                 ///< tick of the first golden digest

  /// Number of quantities beyond their tolerance.
  [[nodiscard]] std::size_t Beyond() const;
};

/// Compares a run with its golden trace.
[[nodiscard]] TraceDifference Compare(const ScenarioTrace& golden, const ScenarioTrace& now,
                                      const config::TraceTolerances& tolerances);

/// Returns the first quantity of each family, at most `most`: a difference in one axis mostly appears in the
/// others as well. Only those beyond their tolerance, if there are any.
[[nodiscard]] std::vector<QuantityDifference> Telling(const TraceDifference& difference, std::size_t most);

/// Explains the difference in a few lines: where it began, what left its tolerance first and by how much,
/// events. Empty if the two are identical.
[[nodiscard]] std::vector<std::string> Explain(const TraceDifference& difference, const ScenarioTrace& now);

}  // namespace osteon::studies
