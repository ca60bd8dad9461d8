#pragma once

namespace osteon::rt {

/// Counts heap calls and mutex locks of this thread while alive. For tests and benches: the executable must
/// link osteon::rt_guard, which interposes glibc's malloc family and pthread_mutex_lock.
class NoAllocScope {
 public:
  NoAllocScope();
  ~NoAllocScope();
  NoAllocScope(const NoAllocScope&) = delete;
  NoAllocScope& operator=(const NoAllocScope&) = delete;

  /// Whether calls are counted here at all: a sanitizer has a heap of its own.
  [[nodiscard]] static bool Counts();

  [[nodiscard]] int heap_calls() const;
  [[nodiscard]] int locks() const;
};

}  // namespace osteon::rt
