#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "base/clock.h"
#include "base/marker.h"

namespace osteon::rt {

/// Histogram of durations with log-spaced bins, 128 per octave: a value read back is within 0.4 % of the
/// value added. Covers 1 ns to 17 s in a fixed size, without allocation. One thread at a time.
class DurationHistogram {
 public:
  static constexpr int kOctaves = 28;
  static constexpr int kPerOctave = 128;
  static constexpr int kBins = kOctaves * kPerOctave;

  /// Adds a value. A negative value counts as 0, a value beyond the range as the range's end. max() is exact
  /// in any case.
  void Add(Nanoseconds value) OSTEON_RT {
    value = std::max<Nanoseconds>(value, 0);
    ++bins_[static_cast<std::size_t>(BinOf(value))];
    ++count_;
    max_ = std::max(max_, value);
  }

  [[nodiscard]] std::uint64_t count() const OSTEON_RT { return count_; }
  [[nodiscard]] Nanoseconds max() const OSTEON_RT { return max_; }
  [[nodiscard]] const std::array<std::uint64_t, kBins>& bins() const OSTEON_RT { return bins_; }

  /// Returns the value below which the given share of all values lies, to the resolution of the bins: the
  /// middle of the bin, at most max(). 0 if the histogram is empty.
  /// @param share  0 … 1, e.g. 0.999
  [[nodiscard]] Nanoseconds Quantile(double share) const OSTEON_RT {
    const double rank = share * static_cast<double>(count_);
    std::uint64_t below = 0;
    for (int i = 0; i < kBins; ++i) {
      below += bins_[static_cast<std::size_t>(i)];
      if (below > 0 && static_cast<double>(below) >= rank)
        return std::min(max_, (LowerEdge(i) + LowerEdge(i + 1)) / 2);
    }
    return max_;
  }

  /// Smallest value of a bin [ns]; for kBins, the end of the range.
  [[nodiscard]] static constexpr Nanoseconds LowerEdge(int bin) OSTEON_RT {
    if (bin < kPerOctave) return bin;  // a value below kPerOctave has a bin of its own
    const int octave = bin / kPerOctave, part = bin % kPerOctave;
    return static_cast<Nanoseconds>(kPerOctave + part) << (octave - 1);
  }

  /// Number of the bin that counts a value [ns]; the last bin for values beyond the range.
  [[nodiscard]] static constexpr int BinOf(Nanoseconds value) OSTEON_RT {
    if (value < kPerOctave) return static_cast<int>(value);
    // Shift the value so that its highest 8 bits remain: a number from kPerOctave to 2 kPerOctave - 1.
    const int shift = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(value))) - 8;
    const int bin = (shift + 1) * kPerOctave + static_cast<int>((value >> shift) - kPerOctave);
    return std::min(bin, kBins - 1);
  }

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_{0};
  Nanoseconds max_{0};
};

}  // namespace osteon::rt
