#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "base/clock.h"

namespace osteon::report {

/// Counts how often each duration occurred, to the nanosecond. This gives exact percentiles of a run of any
/// length without a list of all durations.
///
/// Memory depends on how much the durations differ, not on their number: 4 KiB for each interval of 1024 ns
/// below 16.8 ms that contains a duration (at most 64 MiB), and 48 bytes for each different longer duration.
class DurationCounts {
 public:
  void Add(rt::Nanoseconds duration);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Returns the duration at a position of the sorted list. @param rank  the position, below count()
  [[nodiscard]] rt::Nanoseconds At(std::uint64_t rank) const;

  /// Calls visit(duration, how often), from the shortest to the longest.
  template <class Visit>
  void ForEach(Visit&& visit) const {
    auto other = others_.begin();
    for (; other != others_.end() && other->first < 0; ++other) visit(other->first, other->second);
    for (std::size_t page = 0; page < pages_.size(); ++page)
      for (std::size_t i = 0; pages_[page] && i < kPage; ++i)
        if ((*pages_[page])[i] > 0)
          visit(static_cast<rt::Nanoseconds>(page * kPage + i), std::uint64_t{(*pages_[page])[i]});
    for (; other != others_.end(); ++other) visit(other->first, other->second);
  }

 private:
  static constexpr std::size_t kPage = 1024, kMaxPages = 16384;  // durations in a page [ns]; number of pages
  using Page = std::array<std::uint32_t, kPage>;                 // how often each duration occurred

  std::uint64_t count_{0};
  // page i counts the durations from 1024 i ns on; null: none occurred
  std::vector<std::unique_ptr<Page>> pages_;
  std::map<rt::Nanoseconds, std::uint64_t> others_;  // durations below zero, or beyond the last page
};

}  // namespace osteon::report
