#include "report/run_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace osteon::report {
namespace {

constexpr unsigned kSeed = 20261126;

TEST(DurationCounts, EqualTheSortedListAtEachPlaceToTheNanosecond) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  // negative values (a clock that went back), microseconds, milliseconds, and values beyond the pages
  std::vector<rt::Nanoseconds> list{-5, -5, 0, 1023, 1024, 16'777'215, 16'777'216, 40'000'000, rt::kSecond};
  for (int i = 0; i < 5000; ++i) list.push_back(static_cast<rt::Nanoseconds>(random() % 60'000));
  for (int i = 0; i < 500; ++i) list.push_back(static_cast<rt::Nanoseconds>(random() % 30'000'000));
  std::shuffle(list.begin(), list.end(), random);
  DurationCounts counts;
  for (const rt::Nanoseconds duration : list) counts.Add(duration);
  std::sort(list.begin(), list.end());
  ASSERT_EQ(counts.count(), list.size());
  for (std::size_t i = 0; i < list.size(); i += 7) ASSERT_EQ(counts.At(i), list[i]) << i;
  EXPECT_EQ(counts.At(list.size() - 1), list.back());
  rt::Nanoseconds before = std::numeric_limits<rt::Nanoseconds>::min();
  std::uint64_t total = 0;
  counts.ForEach([&](rt::Nanoseconds duration, std::uint64_t times) {
    EXPECT_GT(duration, before) << "ascending, each once";
    before = duration;
    total += times;
  });
  EXPECT_EQ(total, list.size());
}

TEST(ThinCurve, KeepsEveryPointWhileThereAreFewerThanItsMaximum) {
  ThinCurve curve;
  for (std::size_t i = 0; i + 1 < ThinCurve::kMaxPoints; ++i)
    curve.Add(static_cast<rt::Nanoseconds>(i) * rt::kMillisecond, static_cast<double>(i % 17));
  ASSERT_EQ(curve.points().size(), ThinCurve::kMaxPoints - 1);
  for (std::size_t i = 0; i < curve.points().size(); i += 997) {
    EXPECT_EQ(curve.points()[i].stamp, static_cast<rt::Nanoseconds>(i) * rt::kMillisecond);
    EXPECT_EQ(curve.points()[i].value, static_cast<double>(i % 17));
  }
}

// An hour at 1 kHz with peaks of one sample and one gap: all of them remain, at their own times.
TEST(ThinCurve, KeepsPeaksAndGapsOfASingleSample) {
  constexpr rt::Nanoseconds kTicks = 3'600'000;
  ThinCurve curve;
  for (rt::Nanoseconds i = 0; i < kTicks; ++i) {
    double value = std::sin(1e-3 * static_cast<double>(i));
    if (i % 400'000 == 123'457) value = 50.0 + static_cast<double>(i) * 1e-6;
    if (i % 400'000 == 323'457) value = -50.0 - static_cast<double>(i) * 1e-6;
    if (i == 2'000'001) value = std::numeric_limits<double>::quiet_NaN();
    curve.Add(i * rt::kMillisecond, value);
  }
  EXPECT_LT(curve.points().size(), ThinCurve::kMaxPoints);
  EXPECT_GT(curve.points().size(), ThinCurve::kMaxPoints / 20);
  EXPECT_EQ(curve.points().front().stamp, 0);
  EXPECT_EQ(curve.points().back().stamp, (kTicks - 1) * rt::kMillisecond);
  const auto has = [&](rt::Nanoseconds tick, auto&& is) {
    return std::ranges::any_of(curve.points(), [&](const ThinCurve::Point& point) {
      return point.stamp == tick * rt::kMillisecond && is(point.value);
    });
  };
  for (rt::Nanoseconds i = 0; i < kTicks; i += 400'000) {
    EXPECT_TRUE(has(i + 123'457, [](double value) { return value > 49.0; })) << i;
    EXPECT_TRUE(has(i + 323'457, [](double value) { return value < -49.0; })) << i;
  }
  EXPECT_TRUE(has(2'000'001, [](double value) { return std::isnan(value); }));
  EXPECT_TRUE(std::ranges::is_sorted(curve.points(), {}, &ThinCurve::Point::stamp));
}

// A damaged file may have any stamps.
TEST(ThinCurve, StaysBelowItsMaximumForAnyStamps) {
  std::mt19937_64 random(kSeed);
  ThinCurve curve;
  for (int i = 0; i < 300'000; ++i) curve.Add(static_cast<rt::Nanoseconds>(random()), 1.0);
  EXPECT_LT(curve.points().size(), ThinCurve::kMaxPoints);
}

TEST(RunCurves, PhasesEndWhereTheNextBegins) {
  using control::Phase;
  RunCurves curves;
  rt::Nanoseconds stamp = 5;
  for (const auto& [phase, ticks] :
       {std::pair{Phase::kWaiting, 3}, {Phase::kHaptic, 4}, {Phase::kStopped, 2}})
    for (int i = 0; i < ticks; ++i) {
      control::TickRecord tick;
      tick.stamp = stamp;
      tick.phase = phase;
      curves.Add(tick);
      stamp += 10;
    }
  ASSERT_EQ(curves.phases.size(), 3u);
  EXPECT_EQ(curves.phases[0].begin, 5);
  EXPECT_EQ(curves.phases[0].end, 35);
  EXPECT_EQ(curves.phases[1].begin, 35);
  EXPECT_EQ(curves.phases[1].end, 75);
  EXPECT_EQ(curves.phases[2].end, 85) << "the last tick";
}

}  // namespace
}  // namespace osteon::report
