#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "base/no_alloc_scope.h"

namespace osteon::rt {

/// A NoAllocScope that fails the test at its end if this thread has called the heap or locked a mutex
/// meanwhile, so that no test can forget the check. Tests use this class, never NoAllocScope itself
/// (IncludeRules.TestsCountAllocationsInACheckedScopeOnly). The executable links osteon::base_guard; under a
/// sanitizer nothing is counted.
class CheckedNoAllocScope {
 public:
  CheckedNoAllocScope() {
#if !defined(OSTEON_SANITIZED)
    static const bool counts = NoAllocScope::Counts();  // before the scope of this object begins
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
    scope_.reset();  // a failure's message allocates
    EXPECT_EQ(heap_calls, 0) << "heap calls in a scope that allows none";
    EXPECT_EQ(locks, 0) << "mutex locks in a scope that allows none";
  }

 private:
  std::optional<NoAllocScope> scope_;
};

}  // namespace osteon::rt
