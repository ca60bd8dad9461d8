#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

#include "control/rt/marker.h"

namespace osteon::rt {

/// The newest value of a stream, handed from one writer thread to one reader thread without a lock: a triple
/// buffer.
///
///     writer: back ──exchange──▶ middle ◀──exchange── front : reader
///
/// The writer never waits and overwrites what was not read; the reader always gets the newest complete value.
/// The three slots' roles live in one atomic byte: bits 0-1 the middle slot, bit 2 "middle is newer than
/// front". Memory order: Store's exchange releases the slot it wrote and acquires the one it gets back;
/// Load's the same.
template <class T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>, "a torn-free hand-over is promised for plain data only");
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);

 public:
  explicit LatestValue(const T& initial = T{}) { slots_.fill(Slot{initial}); }
  LatestValue(const LatestValue&) = delete;
  LatestValue& operator=(const LatestValue&) = delete;

  /// Writer thread only.
  void Store(const T& value) OSTEON_RT {
    slots_[back_].value = value;
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) & kIndex;
  }

  /// Reader thread only. The newest stored value, or the initial one.
  [[nodiscard]] const T& Load() OSTEON_RT {
    if (middle_.load(std::memory_order_relaxed) & kFresh)
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return slots_[front_].value;
  }

 private:
  static constexpr std::uint8_t kIndex = 3, kFresh = 4;
  struct alignas(64) Slot {
    T value{};
  };
  std::array<Slot, 3> slots_{};
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t back_{0};   // writer's
  alignas(64) std::uint8_t front_{2};  // reader's
};

}  // namespace osteon::rt
