#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace osteon::console {

/// Number of bytes of the surface in one message to a page: as many as the page's connection transmits in
/// some milliseconds. The figures are sent between two such messages and must not be late. On a fast
/// connection the number grows until a change of the surface fits into one message.
class SurfaceBudget {
 public:
  static constexpr std::size_t kMin_bytes = 32u << 10, kMax_bytes = 1u << 20;
  /// A write shorter than kFast doubles the number of bytes, one longer than kSlow halves it.
  static constexpr std::chrono::milliseconds kFast{10}, kSlow{30};

  [[nodiscard]] std::size_t bytes() const { return bytes_; }

  /// @param took  time that writing a message took
  void AfterMessage(std::chrono::nanoseconds took) {
    if (took > kSlow) bytes_ = std::max(bytes_ / 2, kMin_bytes);
    if (took < kFast) bytes_ = std::min(2 * bytes_, kMax_bytes);
  }

 private:
  std::size_t bytes_{256u << 10};
};

}  // namespace osteon::console
