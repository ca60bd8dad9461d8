#pragma once

#include <atomic>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "base/marker.h"

namespace osteon::rt {

/// Queue of plain values from one writer thread to one reader thread: bounded, allocated once, without a
/// lock. A full ring refuses the value and counts it, so that the tick never waits for a disk. Memory order:
/// the writer releases head_ after it has stored a value, the reader releases tail_ after it has copied one.
template <class T>
class SpscRing {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Makes a ring for `capacity` values (at least one).
  explicit SpscRing(std::size_t capacity) : slots_(capacity + 1) {}
  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  /// Appends a value. Writer thread only. If the ring is full, counts the loss and returns false.
  bool Push(const T& value) OSTEON_RT {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    const std::size_t next = Next(head);
    if (next == tail_.load(std::memory_order_acquire)) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    slots_[head] = value;
    head_.store(next, std::memory_order_release);
    return true;
  }

  /// Takes the oldest value. Reader thread only. False if the ring is empty.
  bool Pop(T& value) OSTEON_RT {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = slots_[tail];
    tail_.store(Next(tail), std::memory_order_release);
    return true;
  }

  /// Number of values that wait to be read. Writer thread only; values read meanwhile may still be counted.
  [[nodiscard]] std::size_t waiting() const OSTEON_RT {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    return head >= tail ? head - tail : head + slots_.size() - tail;
  }

  /// Values refused so far; any thread.
  [[nodiscard]] std::size_t dropped() const OSTEON_RT { return dropped_.load(std::memory_order_relaxed); }

 private:
  [[nodiscard]] std::size_t Next(std::size_t i) const OSTEON_RT { return i + 1 == slots_.size() ? 0 : i + 1; }

  std::vector<T> slots_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
  std::atomic<std::size_t> dropped_{0};
};

}  // namespace osteon::rt
