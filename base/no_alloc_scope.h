#pragma once

namespace osteon::rt {

/// Counts heap calls and mutex locks of the calling thread during its lifetime. For tests and benches: the
/// executable must link osteon::base_guard, which interposes glibc's malloc family and pthread_mutex_lock.
class NoAllocScope {
 public:
  NoAllocScope();
  ~NoAllocScope();
  NoAllocScope(const NoAllocScope&) = delete;
  NoAllocScope& operator=(const NoAllocScope&) = delete;

  /// Whether calls can be counted in this build. Not with a sanitizer, which has its own heap functions.
  [[nodiscard]] static bool Counts();

  [[nodiscard]] int heap_calls() const;
  [[nodiscard]] int locks() const;
};

}  // namespace osteon::rt
