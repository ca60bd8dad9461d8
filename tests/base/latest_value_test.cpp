#include "base/latest_value.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::rt {
namespace {

// A value so large that a copy takes many instructions. Thus a torn copy would be noticed.
struct Large {
  std::array<std::uint64_t, 200> words{};
};

Large Filled(std::uint64_t value) {
  Large large;
  large.words.fill(value);
  return large;
}

TEST(LatestValue, ReturnsTheInitialValueThenTheNewest) {
  LatestValue<int> value(7);
  EXPECT_EQ(value.Load(), 7);
  value.Store(1);
  value.Store(2);
  value.Store(3);
  EXPECT_EQ(value.Load(), 3) << "what was not read is overwritten";
  EXPECT_EQ(value.Load(), 3) << "and a value may be read again";
  value.Store(4);
  EXPECT_EQ(value.Load(), 4);
}

TEST(LatestValue, ReadsAreNeverTornNeverGoBackAndEndWithTheLastValue) {
  constexpr std::uint64_t kLast = 100'000;
  LatestValue<Large> value;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) value.Store(Filled(i));
    done.store(true, std::memory_order_release);
  });
  std::uint64_t before = 0, torn = 0, backwards = 0;
  for (bool last = false; !last;) {
    last = done.load(std::memory_order_acquire);
    const Large& now = value.Load();
    for (const std::uint64_t word : now.words) torn += word != now.words[0];
    backwards += now.words[0] < before;
    before = now.words[0];
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(backwards, 0u);
  EXPECT_EQ(before, kLast) << "what was stored before the reader last looked is seen";
}

// The value is small, so that the two threads collide while they hand it over, and not while they copy.
TEST(LatestValue, TenMillionSmallReadsAreNeverTornAndNeverGoBack) {
#if defined(OSTEON_SANITIZED)
  constexpr std::uint64_t kLast = 500'000;  // under a sanitizer each access takes ten times as long
#else
  constexpr std::uint64_t kLast = 10'000'000;
#endif
  struct Small {
    std::array<std::uint64_t, 4> words{};
  };
  LatestValue<Small> value;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) value.Store({{i, ~i, 3 * i, i ^ kLast}});
    done.store(true, std::memory_order_release);
  });
  std::uint64_t before = 0, torn = 0, backwards = 0, fresh = 0;
  for (bool last = false; !last;) {
    last = done.load(std::memory_order_acquire);
    const auto [a, b, c, d] = value.Load().words;
    torn += a != 0 && (b != ~a || c != 3 * a || d != (a ^ kLast));
    backwards += a < before;
    fresh += a != before;
    before = a;
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(backwards, 0u);
  EXPECT_EQ(before, kLast);
  EXPECT_GT(fresh, 0u);
}

TEST(LatestValue, NeitherWriterNorReaderAllocatesOrLocks) {
  LatestValue<Large> value;
  const Large large = Filled(3);
  CheckedNoAllocScope no_alloc;
  value.Store(large);
  const std::uint64_t word = value.Load().words[5];
  no_alloc.End();
  EXPECT_EQ(word, 3u);
}

}  // namespace
}  // namespace osteon::rt
