#include "hil/injection/impaired_wire.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "injection_bench.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests a wire with injected faults: loss, duplication, corruption, reordering, delay, jitter and silence.
// The wire counts each fault.

namespace osteon::hil {
namespace {

constexpr rt::Nanoseconds kMs = rt::kMillisecond;

// Size of a datagram. Each byte of a datagram holds the datagram's number, so that damage and order can be
// seen on arrival.
constexpr std::size_t kSize = 64;
using Numbered = std::array<std::uint64_t, kSize / 8>;
std::span<const std::uint8_t> Bytes(const Numbered& datagram) {
  return {reinterpret_cast<const std::uint8_t*>(datagram.data()), kSize};
}

struct Arrived {
  std::uint64_t number;
  rt::Nanoseconds pushed, came;  // times of sending and of arrival
  std::size_t size;
  bool intact;
};

// Sends `count` datagrams, one each millisecond. @returns the datagrams that arrive, with their times of
// arrival
std::vector<Arrived> Send(ImpairedWire& wire, int count) {
  std::vector<Arrived> arrived;
  const auto take = [&](rt::Nanoseconds until) {
    while (wire.NextDue() <= until) {
      const rt::Nanoseconds due = wire.NextDue();
      const auto bytes = wire.Next(due);
      Numbered content{};
      std::memcpy(content.data(), bytes.data(), bytes.size());
      const bool same = std::all_of(content.begin(), content.end(), [&](auto n) { return n == content[0]; });
      arrived.push_back({content[0], static_cast<rt::Nanoseconds>(content[0] * std::uint64_t{kMs}), due,
                         bytes.size(), same && bytes.size() == kSize});
    }
  };
  for (int i = 0; i < count; ++i) {
    Numbered datagram;
    datagram.fill(static_cast<std::uint64_t>(i));
    take(i * kMs - 1);
    wire.Push(Bytes(datagram), i * kMs);
    take(i * kMs);
  }
  take(count * kMs + 10 * rt::kSecond);
  EXPECT_TRUE(Balances(wire));
  return arrived;
}

// A wire that has these faults all the time.
ImpairedWire WireWith(const WireFaults& faults, std::uint64_t seed = 1) {
  return {Always(faults, Wire::kArm, Direction::kBoth, seed), Wire::kArm, Direction::kToController};
}

// Expects a count within five standard deviations of a binomial distribution with this share. Only one seed
// in two million exceeds this range.
void ExpectShare(std::uint64_t found, double share, double trials) {
  EXPECT_NEAR(static_cast<double>(found), share * trials, 5.0 * std::sqrt(share * (1.0 - share) * trials));
}

constexpr int kMany = 100'000;  // number of datagrams in a statistical test

TEST(ImpairedWire, WithoutFaultsEverythingPassesAtOnceUnchanged) {
  ImpairedWire wire({}, Wire::kArm, Direction::kToController);
  const auto arrived = Send(wire, 1000);
  ASSERT_EQ(arrived.size(), 1000u);
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    EXPECT_EQ(arrived[i].number, i);
    EXPECT_EQ(arrived[i].came, arrived[i].pushed);
    EXPECT_TRUE(arrived[i].intact);
  }
  EXPECT_EQ(wire.counters(), (WireCounters{.pushed = 1000, .passed = 1000}));
  EXPECT_FALSE(wire.injects());
}

TEST(ImpairedWire, EachFaultHasTheConfiguredFrequency) {
  ImpairedWire lossy = WireWith({.loss = 0.05}), twice = WireWith({.duplicate = 0.02}),
               damaged = WireWith({.corrupt = 0.01}), swapped = WireWith({.reorder = 0.1});
  const std::size_t left = Send(lossy, kMany).size(), more = Send(twice, kMany).size();
  EXPECT_EQ(left, kMany - lossy.counters().lost);
  ExpectShare(lossy.counters().lost, 0.05, kMany);
  EXPECT_EQ(more, kMany + twice.counters().duplicated);
  ExpectShare(twice.counters().duplicated, 0.02, kMany);

  std::uint64_t not_intact = 0, short_ones = 0;
  for (const Arrived& a : Send(damaged, kMany)) {
    not_intact += a.intact ? 0 : 1;
    short_ones += a.size < kSize ? 1 : 0;
  }
  EXPECT_EQ(not_intact, damaged.counters().corrupted);
  ExpectShare(damaged.counters().corrupted, 0.01, kMany);
  ExpectShare(short_ones, 0.25, static_cast<double>(not_intact));

  // A reordered datagram is held until the next datagram has passed, and for the next one nothing is drawn.
  // So n draws at the probability p reorder p n of n + p n datagrams, a share of p / (1 + p).
  std::uint64_t behind = 0, newest = 0;
  for (const Arrived& a : Send(swapped, kMany)) {
    behind += a.number < newest ? 1 : 0;
    newest = std::max(newest, a.number);
  }
  EXPECT_EQ(behind, swapped.counters().reordered);
  ExpectShare(swapped.counters().reordered, 0.1 / 1.1, kMany);
}

TEST(ImpairedWire, BurstsHaveTheirLengthAndKeepTheShareOfLosses) {
  for (const int burst : {5, 20}) {
    ImpairedWire wire = WireWith({.loss = 0.05, .burst = burst});
    std::vector<bool> came(kMany, false);
    for (const Arrived& a : Send(wire, kMany)) came[a.number] = true;
    // adjacent bursts form one run of losses. The last run may be incomplete, so it is not checked
    int run = 0;
    std::uint64_t runs = 0;
    for (const bool c : came) {
      if (!c) {
        ++run;
        continue;
      }
      EXPECT_EQ(run % burst, 0);
      runs += run > 0 ? 1 : 0;
      run = 0;
    }
    EXPECT_GT(runs, 0u);
    // single losses are not independent, but bursts are. So the number of bursts determines the standard
    // deviation
    const double bursts = 0.05 * kMany / burst;
    EXPECT_NEAR(static_cast<double>(wire.counters().lost), 0.05 * kMany, 5.0 * burst * std::sqrt(bursts));
  }
}

TEST(ImpairedWire, TotalLossAndSilencePassNothing) {
  ImpairedWire all = WireWith({.loss = 1.0, .burst = 7}), silent = WireWith({.silence = true});
  EXPECT_TRUE(Send(all, 1000).empty());
  EXPECT_TRUE(Send(silent, 1000).empty());
  EXPECT_EQ(all.counters().lost, 1000u);
  EXPECT_EQ(silent.counters().silenced, 1000u);
}

TEST(ImpairedWire, DelayAndJitterKeepTheOrderAndTheirBounds) {
  constexpr rt::Nanoseconds kDelay = 400'000,
                            kJitter = 3 * kMs;  // the delay is below a period; the jitter is several periods
  ImpairedWire wire = WireWith({.delay = kDelay, .jitter = kJitter});
  const auto arrived = Send(wire, 10'000);
  ASSERT_EQ(arrived.size(), 10'000u);
  double sum_s = 0.0;
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    ASSERT_EQ(arrived[i].number, i) << "the order stays";
    ASSERT_GE(arrived[i].came, i > 0 ? arrived[i - 1].came : 0);
    const rt::Nanoseconds late = arrived[i].came - arrived[i].pushed;
    ASSERT_GE(late, kDelay);
    ASSERT_LE(late, kDelay + kJitter) << "waiting for the one ahead never adds to the greatest delay";
    sum_s += rt::ToSeconds(late);
  }
  EXPECT_EQ(wire.counters().delayed, 10'000u);
  EXPECT_GT(sum_s / 10'000, rt::ToSeconds(kDelay + kJitter / 2)) << "as the order stays";
  ImpairedWire steady = WireWith({.delay = kDelay});
  const auto steadily = Send(steady, 1000);
  ASSERT_EQ(steadily.size(), 1000u);
  for (const Arrived& a : steadily) ASSERT_EQ(a.came - a.pushed, kDelay);
}

TEST(ImpairedWire, DatagramsUnderWayStayDelayedAndInOrderWhenADelayEnds) {
  const InjectionParams params{.injections = {{.from_s = 0.0, .to_s = 0.1, .faults = {.delay = 10 * kMs}}}};
  ImpairedWire wire(params, Wire::kArm, Direction::kToController);
  wire.StartSchedule(0);
  const auto arrived = Send(wire, 200);
  ASSERT_EQ(arrived.size(), 200u);
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    EXPECT_EQ(arrived[i].number, i);
    const auto n = static_cast<rt::Nanoseconds>(i);
    EXPECT_EQ(arrived[i].came, n < 100 ? (n + 10) * kMs : std::max(n, rt::Nanoseconds{109}) * kMs);
  }
}

TEST(ImpairedWire, InjectsOnlyInItsIntervalAfterTheScheduleStarts) {
  const InjectionParams params{
      .injections = {{.from_s = 0.01, .to_s = 0.03, .faults = {.silence = true}},
                     {.wire = Wire::kDrive, .faults = {.loss = 1.0}},
                     {.direction = Direction::kFromController, .faults = {.loss = 1.0}}}};
  ImpairedWire wire(params, Wire::kArm, Direction::kToController);
  std::vector<int> missing;
  for (int i = 0; i < 200; ++i) {
    if (i == 100) wire.StartSchedule(i * kMs);
    if (i == 115)
      wire.StartSchedule(i * kMs);  // commanding begins again, but the time of the schedule continues
    const std::uint8_t byte = 1;
    wire.Push({&byte, 1}, i * kMs);
    if (wire.Next(i * kMs).empty()) missing.push_back(i);
  }
  ASSERT_EQ(missing.size(), 20u);
  EXPECT_EQ(missing.front(), 110);
  EXPECT_EQ(missing.back(), 129);
  ImpairedWire from_the_start = WireWith({.silence = true});
  const std::uint8_t byte = 1;
  from_the_start.Push({&byte, 1}, 0);
  EXPECT_EQ(from_the_start.counters().silenced, 1u) << "before it has begun";
}

TEST(ImpairedWire, OverlappingInjectionsAddUp) {
  const InjectionParams params{
      .injections = {
          {.from_s = -1, .faults = {.loss = 0.6, .burst = 3, .delay = kMs}},
          {.from_s = -1, .faults = {.loss = 0.6, .reorder = 0.25, .delay = 2 * kMs, .jitter = 5}}}};
  EXPECT_EQ(FaultSchedule(params, Wire::kArm, Direction::kToController).At(0),
            (WireFaults{.loss = 1.0, .burst = 3, .reorder = 0.25, .delay = 3 * kMs, .jitter = 5}));
}

TEST(ImpairedWire, EqualSeedsLoseTheSameDatagramsWhateverTheOtherFaults) {
  const auto lost = [](const WireFaults& faults, std::uint64_t seed, Wire wire, Direction direction) {
    ImpairedWire w(Always(faults, wire, direction, seed), wire, direction);
    std::vector<bool> came(5000, false);
    for (const Arrived& a : Send(w, 5000)) came[a.number] = true;
    came.pop_back();  // the last datagram may be held until another one passes
    return came;
  };
  const auto first = lost({.loss = 0.1}, 5, Wire::kArm, Direction::kToController);
  EXPECT_EQ(first, lost({.loss = 0.1}, 5, Wire::kArm, Direction::kToController));
  EXPECT_EQ(first, lost({.loss = 0.1, .duplicate = 0.3, .reorder = 0.2, .delay = 5 * kMs, .jitter = kMs}, 5,
                        Wire::kArm, Direction::kToController));
  EXPECT_NE(first, lost({.loss = 0.1}, 6, Wire::kArm, Direction::kToController));
  EXPECT_NE(first, lost({.loss = 0.1}, 5, Wire::kArm, Direction::kFromController));
  EXPECT_NE(first, lost({.loss = 0.1}, 5, Wire::kDrive, Direction::kToController));
}

TEST(ImpairedWire, CountsDatagramsThatFindNoRoom) {
  ImpairedWire wire(Always({.delay = rt::kSecond}), Wire::kArm, Direction::kToController,
                    {.datagrams = 10, .bytes = 8});
  const std::array<std::uint8_t, 9> bytes{};
  for (int i = 0; i < 12; ++i) wire.Push(std::span(bytes).first(8), i * kMs);
  wire.Push(bytes, 12 * kMs);  // 9 bytes: longer than the wire's largest datagram
  EXPECT_EQ(wire.counters().overflow, 3u);
  EXPECT_EQ(wire.waiting(), 10u);
  EXPECT_TRUE(Balances(wire));
}

TEST(ImpairedWire, NeverDamagesTheBytesThatStayIntact) {
  ImpairedWire wire(Always({.corrupt = 1.0}), Wire::kArm, Direction::kToController, {.intact = 2});
  const std::array<std::uint8_t, 4> bytes{1, 2, 3, 4};
  for (int i = 0; i < 1000; ++i) {
    wire.Push(bytes, i);
    const auto came = wire.Next(i);
    ASSERT_GE(came.size(), 2u);
    ASSERT_TRUE(came[0] == 1 && came[1] == 2);
    ASSERT_FALSE(std::equal(came.begin(), came.end(), bytes.begin(), bytes.end()));
  }
  wire.Push(std::span(bytes).first(2), 1000);
  EXPECT_EQ(wire.Next(1000).size(), 2u);
  EXPECT_EQ(wire.counters().corrupted, 1000u) << "there was nothing to damage";
}

TEST(ImpairedWire, DoesNotAllocate) {
  ImpairedWire wire = WireWith({.loss = 0.1,
                                .burst = 3,
                                .duplicate = 0.1,
                                .reorder = 0.1,
                                .corrupt = 0.1,
                                .delay = kMs,
                                .jitter = 3 * kMs});
  const std::array<std::uint8_t, 1500> bytes{};
  rt::CheckedNoAllocScope no_alloc;
  for (int i = 0; i < 10'000; ++i) {
    wire.Push(bytes, i * kMs);
    while (wire.NextDue() <= i * kMs) static_cast<void>(wire.Next(i * kMs));
  }
}

TEST(ImpairedWire, RefusesBadInjectionsByFieldAndValue) {
  const auto said = [](const Injection& injection) -> std::string {
    try {
      Validate({.injections = {{}, injection}});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said({.faults = {.loss = 1.5}}), "injection 2: loss: found 1.5, accepted 0 … 1");
  EXPECT_EQ(said({.faults = {.corrupt = std::nan("")}}), "injection 2: corrupt: found nan, accepted 0 … 1");
  EXPECT_NE(said({.faults = {.burst = 0}}), "");
  EXPECT_NE(said({.faults = {.delay = -1}}), "");
  EXPECT_NE(said({.from_s = 1.0, .to_s = 1.0}), "");
  EXPECT_EQ(said({}), "");
}

}  // namespace
}  // namespace osteon::hil
