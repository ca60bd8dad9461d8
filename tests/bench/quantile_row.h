#pragma once

#include <algorithm>
#include <cstdio>
#include <vector>

#include "base/clock.h"

namespace osteon {

/// Sorts the times and prints a CSV row: the name `what`, then median, 99th percentile and maximum in ns.
inline void PrintQuantiles(const char* what, std::vector<rt::Nanoseconds>& ns) {
  std::sort(ns.begin(), ns.end());
  const auto at = [&](double share) {
    return static_cast<long>(ns[static_cast<std::size_t>(share * static_cast<double>(ns.size() - 1))]);
  };
  std::printf("%s,%ld,%ld,%ld\n", what, at(0.5), at(0.99), at(1.0));
}

}  // namespace osteon
