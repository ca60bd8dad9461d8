#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "base/no_alloc_scope.h"

namespace osteon::rt {

/// A NoAllocScope with a built-in check: at its end it fails the test if this thread has called the heap or
/// locked a mutex since its construction. So no test can forget the check. Tests must use this class instead
/// of NoAllocScope (IncludeRules.TestsCountAllocationsInACheckedScopeOnly). The executable must link
/// osteon::base_guard. Under a sanitizer nothing is counted.
class CheckedNoAllocScope {
 public:
  CheckedNoAllocScope() {
#if !defined(OSTEON_SANITIZED)
    // determined before this object's scope begins to count
    static const bool counts = NoAllocScope::Counts();
    EXPECT_TRUE(counts) << "nothing is counted here: is osteon::base_guard linked?";
#endif
    scope_.emplace();
  }
  ~CheckedNoAllocScope() { End(); }
  CheckedNoAllocScope(const CheckedNoAllocScope&) = delete;
  CheckedNoAllocScope& operator=(const CheckedNoAllocScope&) = delete;

  /// Ends the scope early. Later calls are not counted.
  void End() {
    if (!scope_) return;
    const int heap_calls = scope_->heap_calls(), locks = scope_->locks();
    scope_.reset();  // end the scope first, because a failure's message allocates
    EXPECT_EQ(heap_calls, 0) << "heap calls in a scope that allows none";
    EXPECT_EQ(locks, 0) << "mutex locks in a scope that allows none";
  }

 private:
  std::optional<NoAllocScope> scope_;
};

}  // namespace osteon::rt
