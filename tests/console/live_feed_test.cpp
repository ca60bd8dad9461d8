#include "console/stream/live_feed.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "safety/acting_limits.h"
#include "safety/cell_state.h"
#include "safety/watchdog.h"

// Tests the live feed, which collects a cell's ticks in windows of 33 ms for the console's pages.

namespace osteon::console {
namespace {

// A tick of a cell with a period of 1 ms. The tick's number equals its time in ms.

control::TickRecord Tick(std::uint64_t number, double force_N,
                         safety::CellState state = safety::CellState::kCutting) {
  control::TickRecord tick;
  tick.tick = number;
  tick.stamp = static_cast<rt::Nanoseconds>(number) * 1'000'000;
  tick.cell_state = static_cast<std::uint8_t>(state);
  tick.F_coupling_T_W.f = {0.0, 0.0, force_N};
  tick.input.period_s = 0.001;
  return tick;
}

TEST(LiveFeed, APeakOfOneTickIsNotHidden) {
  LiveFeed feed;
  for (std::uint64_t i = 1; i <= 100; ++i) feed.TakeTick(Tick(i, i == 20 ? 150.0 : i == 40 ? 1.0 : 10.0));
  std::uint64_t seen = 0;
  const auto windows = feed.Since(seen);
  ASSERT_GE(windows.size(), 2u);
  double max_N = 0.0, min_N = 1e9;
  std::uint64_t number = 0;
  for (const LiveWindow& w : windows) {
    EXPECT_EQ(w.number, ++number) << "without gaps";
    max_N = std::max(max_N, w.force_N.most);
    min_N = std::min(min_N, w.force_N.least);
  }
  EXPECT_EQ(max_N, 150.0);
  EXPECT_EQ(min_N, 1.0);
  EXPECT_EQ(seen, feed.Newest().number);
  EXPECT_TRUE(feed.Since(seen).empty());
}

TEST(LiveFeed, RenderedAndPausedTimeAreCountedSeparately) {
  LiveFeed feed;
  std::uint64_t tick = 0;
  for (int i = 0; i < 500; ++i) feed.TakeTick(Tick(++tick, 1.0));
  for (int i = 0; i < 300; ++i) feed.TakeTick(Tick(++tick, 0.0, safety::CellState::kPaused));
  feed.TakeEvent({.stamp = 0, .text = "the window in the making is published with an event"});
  EXPECT_NEAR(feed.Newest().rendered_s, 0.5, 1e-9);
  EXPECT_NEAR(feed.Newest().paused_s, 0.3, 1e-9);
}

// One of 1000 ticks takes 900 µs, twenty take 60 µs, and the others take 30 µs. So the largest time is 900
// µs, and the 99th percentile is 60 µs.
TEST(LiveFeed, KeepsTheLargestAndTheNinetyNinthPercentileOfTickTimes) {
  LiveFeed feed;
  for (std::uint64_t i = 1; i <= 1000; ++i) {
    control::TickRecord tick = Tick(i, 1.0);
    tick.compute_ns = i == 970 ? 900'000 : i > 980 ? 60'000 : 30'000;
    tick.wakeup_ns = 5'000;
    feed.TakeTick(tick);
  }
  feed.Flush();
  std::uint64_t seen = 0;
  double worst_us = 0.0;
  for (const LiveWindow& w : feed.Since(seen)) worst_us = std::max(worst_us, w.compute_us.most);
  EXPECT_EQ(worst_us, 900.0);
  EXPECT_NEAR(feed.Newest().compute_p99_us, 60.0, 0.5);
  EXPECT_NEAR(feed.Newest().wakeup_p99_us, 5.0, 0.05);
  LiveFeed other;
  feed.ShowInstead(other);
  feed.TakeTick(Tick(1, 1.0));
  feed.Flush();
  EXPECT_EQ(feed.Newest().compute_p99_us, 0.0) << "a playback at another time";
}

TEST(LiveFeed, ALimitActsFromItsFirstTickUntilAWholeWindowIsWithoutIt) {
  constexpr auto kSpeed = static_cast<std::size_t>(safety::Limit::kToolSpeed);
  LiveFeed feed;
  std::uint64_t at = 0;
  const auto take = [&](int ticks, bool acts) {
    for (int i = 0; i < ticks; ++i) {
      control::TickRecord tick = Tick(++at, 1.0);
      if (acts) tick.limits = 1u << kSpeed;
      feed.TakeTick(tick);
    }
  };
  take(100, false);
  take(200, true);
  take(5, false);  // an interruption shorter than a window is ignored
  take(200, true);
  feed.Flush();
  EXPECT_EQ(feed.Newest().limit_since[kSpeed], 101 * rt::kMillisecond);
  take(200, false);
  take(100, true);
  feed.Flush();
  EXPECT_EQ(feed.Newest().limit_since[kSpeed], 706 * rt::kMillisecond);
}

TEST(LiveFeed, TheLargestAgeInAWindowIsKept) {
  LiveFeed feed;
  for (std::uint64_t i = 1; i <= 30; ++i) {
    control::TickRecord tick = Tick(i, 1.0);
    tick.input.now = tick.stamp + 2 * rt::kSecond;
    tick.input.arm_stamp = tick.input.now - (i == 7 ? 9 : 1) * rt::kMillisecond;
    feed.TakeTick(tick);
  }
  feed.Flush();
  EXPECT_NEAR(feed.Newest().arm_age_s.most, 0.009, 1e-12);
  EXPECT_EQ(feed.Newest().interlock_age_s.most, safety::kNoAge_s) << "no PLC";
}

TEST(LiveFeed, ALateReaderGetsTheLastWindowsAndEvents) {
  LiveFeed feed;
  for (std::uint64_t i = 1; i <= 20'000; ++i) feed.TakeTick(Tick(i, 1.0));
  std::uint64_t seen = 0;
  const auto windows = feed.Since(seen);
  EXPECT_EQ(windows.size(), LiveFeed::kKept);
  EXPECT_EQ(windows.back().number, seen);
  for (int i = 0; i < 500; ++i) feed.TakeEvent({.stamp = i, .text = std::to_string(i)});
  std::uint64_t seen_events = 0;
  const auto events = feed.EventsSince(seen_events);
  ASSERT_EQ(events.size(), LiveFeed::kKeptEvents);
  EXPECT_EQ(events.back().text, "499");
  EXPECT_EQ(seen_events, 500u);
  EXPECT_TRUE(feed.EventsSince(seen_events).empty());
}

// Each page asks thirty times per second. A copy must not allocate memory for windows that the page already
// has.
TEST(LiveFeed, AReaderAllocatesOnlyForNewWindows) {
  LiveFeed feed;
  std::uint64_t tick = 0, seen = 0;
  EXPECT_EQ(feed.Since(seen).capacity(), 0u);
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 34; ++j) feed.TakeTick(Tick(++tick, 1.0));
    const auto windows = feed.Since(seen);
    EXPECT_EQ(windows.capacity(), windows.size());
    EXPECT_EQ(seen, feed.Newest().number);
  }
  EXPECT_GE(seen, 9u);
  EXPECT_EQ(feed.Since(seen).capacity(), 0u);
}

TEST(LiveFeed, KeepsTheRequestedNumberOfWindows) {
  LiveFeed feed(300);
  for (std::uint64_t i = 1; i <= 20'000; ++i) feed.TakeTick(Tick(i, 1.0));
  std::uint64_t seen = 0;
  const auto windows = feed.Since(seen);
  ASSERT_EQ(windows.size(), 300u);
  EXPECT_EQ(windows.front().number + 299, windows.back().number);
}

// When a playback jumps, it first collects half a minute of ticks in another feed. Then it shows the other
// feed's content in one step. Here the jump leads to ticks 5001 … 7000, of which the first window of 33 ms
// ends with tick 5034.
TEST(LiveFeed, ShowsAnotherFeedsContentInOneStepAndContinuesFromIt) {
  LiveFeed feed;
  for (std::uint64_t i = 1; i <= 100; ++i) feed.TakeTick(Tick(i, 1.0));
  LiveFeed made(feed.kept());
  for (std::uint64_t i = 5001; i <= 7000; ++i) made.TakeTick(Tick(i, 2.0));
  made.TakeEvent({.stamp = 6, .text = "there"});
  made.Flush();
  const std::uint64_t newest = made.Newest().number;
  feed.ShowInstead(made);
  for (std::uint64_t i = 7001; i <= 7100; ++i) feed.TakeTick(Tick(i, 3.0));
  feed.Flush();
  std::uint64_t seen = 0, seen_events = 0;
  const auto windows = feed.Since(seen);
  EXPECT_GT(seen, newest);
  EXPECT_EQ(windows.front().tick.tick, 5034u);
  EXPECT_EQ(windows.back().tick.tick, 7100u);
  EXPECT_NEAR(windows.back().rendered_s, 2.1, 1e-9);
  const auto events = feed.EventsSince(seen_events);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].text, "there");
}

TEST(LiveFeed, AReaderThatHasNotNoticedAJumpGetsNothing) {
  LiveFeed feed;
  for (int i = 0; i < 5; ++i) feed.TakeEvent({.stamp = i, .text = "x"});
  std::uint64_t seen_events = 0, seen = 3;  // the reader's counts are from before the jump
  EXPECT_EQ(feed.EventsSince(seen_events).size(), 5u);
  const std::uint64_t epoch = feed.epoch();
  LiveFeed empty;
  feed.ShowInstead(empty);
  EXPECT_NE(feed.epoch(), epoch);
  EXPECT_TRUE(feed.EventsSince(seen_events).empty());
  EXPECT_TRUE(feed.Since(seen).empty());
  EXPECT_EQ(feed.Newest().number, 0u);
}

// Two readers copy all the time while the writer continues. Each window must be from one moment: its force
// equals its tick's number.
TEST(LiveFeed, ReadersNeverTearAWindow) {
  LiveFeed feed;
  std::atomic<bool> done{false};
  std::atomic<int> torn{0};
  const auto read = [&] {
    std::uint64_t seen = 0, number = 0;
    while (!done.load())
      for (const LiveWindow& w : feed.Since(seen)) {
        if (w.number <= number || w.force_N.most != static_cast<double>(w.tick.tick)) ++torn;
        number = w.number;
      }
  };
  std::thread a(read), b(read);
  for (std::uint64_t i = 1; i <= 200'000; ++i) feed.TakeTick(Tick(i, static_cast<double>(i)));
  done.store(true);
  a.join();
  b.join();
  EXPECT_EQ(torn.load(), 0);
  EXPECT_GT(feed.Newest().number, 0u);
}

}  // namespace
}  // namespace osteon::console
