#include "base/spsc_ring.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::rt {
namespace {

TEST(SpscRing, KeepsTheOrderAcrossManyWrapArounds) {
  SpscRing<int> ring(3);
  int out = 0;
  EXPECT_FALSE(ring.Pop(out)) << "empty";
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(ring.Push(2 * i));
    ASSERT_TRUE(ring.Push(2 * i + 1));
    ASSERT_TRUE(ring.Pop(out));
    ASSERT_EQ(out, 2 * i);
    ASSERT_TRUE(ring.Pop(out));
    ASSERT_EQ(out, 2 * i + 1);
  }
  EXPECT_EQ(ring.dropped(), 0u);
}

TEST(SpscRing, AFullRingRefusesValuesCountsThemAndKeepsItsOwn) {
  SpscRing<int> ring(3);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(ring.Push(i)) << "holds its capacity";
  EXPECT_FALSE(ring.Push(3));
  EXPECT_FALSE(ring.Push(4));
  EXPECT_EQ(ring.dropped(), 2u);
  int out = -1;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(ring.Pop(out));
    EXPECT_EQ(out, i);
  }
  EXPECT_FALSE(ring.Pop(out));
  EXPECT_TRUE(ring.Push(5)) << "and goes on";
}

TEST(SpscRing, AcrossThreadsValuesAreWholeInOrderAndLossesAreCounted) {
  struct Item {
    std::uint64_t number{0};
    std::array<std::uint64_t, 31> copies{};
  };
  constexpr std::uint64_t kItems = 200'000;
  SpscRing<Item> ring(64);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    Item item;
    for (std::uint64_t i = 1; i <= kItems; ++i) {
      item.number = i;
      item.copies.fill(i);
      ring.Push(item);
    }
    done.store(true, std::memory_order_release);
  });
  std::uint64_t before = 0, received = 0, torn = 0, disordered = 0;
  Item item;
  for (bool last = false;;) {
    if (!ring.Pop(item)) {
      if (last) break;
      last = done.load(std::memory_order_acquire);
      continue;
    }
    ++received;
    for (const std::uint64_t copy : item.copies) torn += copy != item.number;
    disordered += item.number <= before;
    before = item.number;
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(disordered, 0u);
  EXPECT_EQ(received + ring.dropped(), kItems);
  EXPECT_GT(received, 0u);
}

TEST(SpscRing, NeitherWriterNorReaderAllocatesOrLocks) {
  SpscRing<int> ring(4);
  int out = 0;
  CheckedNoAllocScope no_alloc;
  const bool ok = ring.Push(1) && ring.Pop(out);
  no_alloc.End();
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace osteon::rt
