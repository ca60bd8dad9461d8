#include "safety/watchdog.h"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace osteon::safety {
namespace {

using rt::kMillisecond;

TEST(AgeSeconds, IsFromZeroToItsMaximumForAnyPairOfStamps) {
  constexpr auto kLow = std::numeric_limits<rt::Nanoseconds>::min(),
                 kHigh = std::numeric_limits<rt::Nanoseconds>::max();
  EXPECT_NEAR(AgeSeconds(30 * kMillisecond, 10 * kMillisecond), 0.020, 1e-15);
  EXPECT_EQ(AgeSeconds(10 * kMillisecond, 10 * kMillisecond + 500'000), 0.0)
      << "clocks may differ by a little";
  EXPECT_EQ(AgeSeconds(10 * kMillisecond, 12 * kMillisecond), kNoAge_s) << "from the future";
  for (const auto now : {kLow, rt::Nanoseconds{-1}, rt::Nanoseconds{0}, kMillisecond, kHigh})
    for (const auto stamp : {kLow, rt::Nanoseconds{-1}, rt::Nanoseconds{0}, kMillisecond, kHigh}) {
      const double age_s = AgeSeconds(now, stamp);
      EXPECT_TRUE(age_s >= 0.0 && age_s <= kNoAge_s) << now << " " << stamp;
    }
  EXPECT_EQ(AgeSeconds(kMillisecond, -1), kNoAge_s);
  EXPECT_EQ(AgeSeconds(kMillisecond, kLow), kNoAge_s);
}

TEST(AgeFade, FallsLinearlyFromOneToZero) {
  EXPECT_EQ(AgeFade(0.020, 0.020, 0.060), 1.0);
  EXPECT_NEAR(AgeFade(0.040, 0.020, 0.060), 0.5, 1e-12);
  EXPECT_EQ(AgeFade(0.060, 0.020, 0.060), 0.0);
  EXPECT_EQ(AgeFade(std::numeric_limits<double>::quiet_NaN(), 0.020, 0.060), 0.0);
}

TEST(Watchdog, GivesEachSourceItsFullTimeAfterTheStart) {
  Watchdog watchdog({});
  const rt::Nanoseconds start = rt::kSecond;
  watchdog.Start(start);
  EXPECT_FALSE(watchdog.Check(start + 90 * kMillisecond, {kNoAge_s, kNoAge_s}).Any());
  EXPECT_TRUE(watchdog.Check(start + 110 * kMillisecond, {kNoAge_s, kNoAge_s}).Has(Fault::kSensorStale));
  EXPECT_FALSE(watchdog.Check(start + 240 * kMillisecond, {kNoAge_s, 0.0}).Has(Fault::kModelStale));
  EXPECT_TRUE(watchdog.Check(start + 260 * kMillisecond, {kNoAge_s, 0.0}).Has(Fault::kModelStale));
  EXPECT_FALSE(watchdog.Check(start + rt::kSecond, {0.010, 0.010}).Any());
}

TEST(Watchdog, RefusesTimesInTheWrongOrder) {
  EXPECT_THROW(Watchdog({.sensor_full_s = 0.2, .sensor_stop_s = 0.1}), std::invalid_argument);
  EXPECT_THROW(Watchdog({.model_stop_s = 0.0}), std::invalid_argument);
  EXPECT_THROW(Watchdog({.arm_misses = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::safety
