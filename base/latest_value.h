#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

#include "base/marker.h"

namespace osteon::rt {

/// The newest value of a stream, handed from one writer thread to one reader thread without a lock: a triple
/// buffer.
///
///     writer: back ──exchange──▶ middle ◀──exchange── front : reader
///
/// The writer never waits and overwrites a value that was not read; the reader always gets the newest
/// complete value. The threads share one atomic byte beside the slots, middle_: bits 0-1 are the index of
/// the middle slot, bit 2 says "middle is newer than front". The writer alone keeps the index of the back
/// slot, the reader alone that of the front slot. Memory order: the exchange in Store releases the slot that
/// the writer has filled and acquires the slot that it gets in return. The exchange in Load does the same for
/// the reader's slots.
template <class T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>, "a torn-free hand-over is promised for plain data only");
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);

 public:
  explicit LatestValue(const T& initial = T{}) { slots_.fill(Slot{initial}); }
  LatestValue(const LatestValue&) = delete;
  LatestValue& operator=(const LatestValue&) = delete;

  /// Stores the newest value. Writer thread only.
  void Store(const T& value) OSTEON_RT {
    slots_[back_].value = value;
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) & kIndex;
  }

  /// Returns the newest stored value, or the initial value. Reader thread only.
  [[nodiscard]] const T& Load() OSTEON_RT {
    if (middle_.load(std::memory_order_relaxed) & kFresh)
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return slots_[front_].value;
  }

 private:
  static constexpr std::uint8_t kIndex = 3, kFresh = 4;  // middle_: mask of the index; bit for "newer"
  struct alignas(64) Slot {
    T value{};
  };
  std::array<Slot, 3> slots_{};
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t back_{0};   // used by the writer
  alignas(64) std::uint8_t front_{2};  // used by the reader
};

}  // namespace osteon::rt
