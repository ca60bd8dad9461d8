#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

// Medians and percentiles. Each reorders the values that it is given.

namespace osteon::base {

/// The value of a rank; rank 0 is the smallest value. @pre rank < values.size()
[[nodiscard]] inline double ValueOfRank(std::span<double> values, std::size_t rank) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

/// The p quantile, p in [0, 1]: the nearest rank, ceil(p n) counted from 1. NaN if empty.
[[nodiscard]] inline double Percentile(std::span<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double rank = std::ceil(std::clamp(p, 0.0, 1.0) * static_cast<double>(values.size()));
  return ValueOfRank(values, static_cast<std::size_t>(std::max(rank, 1.0)) - 1);
}

/// The p quantile, p in [0, 1]: the value of rank p (n - 1), rounded down and counted from 0. 0 if empty.
[[nodiscard]] inline double LowerPercentile(std::span<double> values, double p) {
  if (values.empty()) return 0.0;
  return ValueOfRank(values, static_cast<std::size_t>(p * static_cast<double>(values.size() - 1)));
}

/// The median; for an even number of values, the larger of the two in the middle. 0 if empty.
[[nodiscard]] inline double Median(std::span<double> values) {
  return values.empty() ? 0.0 : ValueOfRank(values, values.size() / 2);
}

}  // namespace osteon::base
