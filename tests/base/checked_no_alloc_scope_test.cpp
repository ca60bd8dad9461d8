#include "tests/base/checked_no_alloc_scope.h"

#include <mutex>
#include <new>

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

namespace osteon::rt {
namespace {

// Calls operator new and delete directly: the compiler may remove a new-expression, but not these calls.
void CallTheHeap() { ::operator delete(::operator new(8)); }

TEST(CheckedNoAllocScope, FailsTheTestIfTheHeapWasCalled) {
  if (!NoAllocScope::Counts()) GTEST_SKIP() << "skipped, under a sanitizer: it has a heap of its own";
  EXPECT_NONFATAL_FAILURE(
      {
        CheckedNoAllocScope no_alloc;
        CallTheHeap();
      },
      "heap calls in a scope that allows none");
}

TEST(CheckedNoAllocScope, FailsTheTestIfAMutexWasLocked) {
  if (!NoAllocScope::Counts()) GTEST_SKIP() << "skipped, under a sanitizer: nothing is counted";
  std::mutex mutex;
  EXPECT_NONFATAL_FAILURE(
      {
        CheckedNoAllocScope no_alloc;
        const std::lock_guard lock(mutex);
      },
      "mutex locks in a scope that allows none");
}

TEST(CheckedNoAllocScope, CountsNothingAfterEnd) {
  CheckedNoAllocScope no_alloc;
  no_alloc.End();
  CallTheHeap();
}

}  // namespace
}  // namespace osteon::rt
