#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/scenario_trace.h"
#include "config/scenario_config.h"

namespace osteon::app {

/// The first tick in which a part's digest differs. A digest of 12 bits misses a difference once in 4096
/// ticks, and then has it in the next.
struct PartDifference {
  TracePart part{TracePart::kArm};
  std::uint64_t tick{0};
};

/// A quantity of two traces.
struct QuantityDifference {
  std::size_t quantity{0};  ///< of TraceQuantities
  double tolerance{0.0};
  double worst{0.0};             ///< greatest |now - golden| of a sample, or of the extremes over all ticks
  std::uint64_t worst_tick{0};   ///< of the sample
  bool between_samples{false};   ///< `worst` is of the extremes: no sample is at it
  double golden{0.0}, now{0.0};  ///< at `worst`
  std::optional<std::uint64_t> left_tick{};  ///< the first sample beyond the tolerance

  [[nodiscard]] bool beyond() const { return worst > tolerance; }
  /// In tolerances.
  [[nodiscard]] double ratio() const;
};

struct TraceDifference {
  bool identical{false};  ///< every bit of every tick
  bool passed{false};     ///< every quantity and event within its tolerance
  std::vector<PartDifference>
      parts;  ///< those that differ, the earliest first; of equal ticks in their order
  std::vector<QuantityDifference>
      quantities;                   ///< those that differ at all: beyond, by when they left; then by how much
  std::vector<std::string> others;  ///< what else is not as it was, a line each: events, the end
  std::uint64_t first_tick{0};      ///< of the golden digests

  /// How many are beyond their tolerance.
  [[nodiscard]] std::size_t Beyond() const;
};

/// Holds a run against its golden trace.
[[nodiscard]] TraceDifference Compare(const ScenarioTrace& golden, const ScenarioTrace& now,
                                      const config::TraceTolerances& tolerances);

/// The first quantity of each family, at most so many: what differs in one axis mostly does in the others.
/// Only those beyond their tolerance, where any is.
[[nodiscard]] std::vector<QuantityDifference> Telling(const TraceDifference& difference, std::size_t most);

/// What to say of it, a few lines: where it began, what left its tolerance first and by how much, events.
/// Empty where the two are identical.
[[nodiscard]] std::vector<std::string> Explain(const TraceDifference& difference, const ScenarioTrace& now);

}  // namespace osteon::app
