#include "control/setup/pausable_clock.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::control {
namespace {

constexpr double kDt_s = 0.001;
constexpr double kPause_s = 0.5;  // longest time from the end of the permission to rest

// From rest, the clock's rate rises to 1 along two parabolas, each of which lasts 1/3 of the pause time. The
// mean rate meanwhile is 1/2, so the clock loses half of 2/3 of the pause time. The way to rest is the mirror
// image.
TEST(PausableClock, StartsAndStopsInTwoThirdsOfThePause) {
  PausableClock clock(kPause_s);
  double own_s = 0.0;
  for (int i = 0; i < 1000; ++i) {
    own_s += clock.Step(kDt_s, true);
    const double x = (i + 1) * kDt_s / kPause_s;  // up to x = 1/3, the rate is 9 x^2 / 2
    if (x < 1.0 / 3.0) {
      ASSERT_NEAR(clock.rate(), 4.5 * x * x, 1e-12);
    }
    if (x > 2.0 / 3.0 + 1e-9) {
      ASSERT_EQ(clock.rate(), 1.0);
    }
  }
  EXPECT_NEAR(own_s, 1.0 - kPause_s / 3.0, 1e-12);
  own_s = 0.0;
  for (int i = 0; i < 334; ++i) own_s += clock.Step(kDt_s, false);
  EXPECT_EQ(clock.rate(), 0.0);
  EXPECT_NEAR(own_s, kPause_s / 3.0, 1e-12);
}

// Steps are integrated exactly. So 20 steps of 1 ms must give the same result as one step of 20 ms.
TEST(PausableClock, ManyShortStepsEqualOneLongStep) {
  PausableClock fine(kPause_s), coarse(kPause_s);
  std::mt19937_64 random(11);
  std::uniform_int_distribution<int> steps(1, 12);
  double fine_s = 0.0, coarse_s = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const bool permitted = random() % 3 != 0;
    for (int run = steps(random); run > 0; --run) {
      coarse_s += coarse.Step(0.02, permitted);
      for (int k = 0; k < 20; ++k) fine_s += fine.Step(kDt_s, permitted);
      ASSERT_NEAR(coarse.rate(), fine.rate(),
                  1e-9);  // tolerance for 20 roundings and for a root of a number near zero
      ASSERT_NEAR(coarse_s, fine_s, 1e-9 * (1.0 + fine_s));
    }
  }
}

TEST(PausableClock, RestsWithinThePauseWheneverPermissionEnds) {
  const double max_rate_acceleration =
      9.0 / (kPause_s * kPause_s);  // bound on r'', the second derivative of the rate r [1/s^2]
  std::mt19937_64 random(12);
  PausableClock clock(kPause_s);
  double rate_before = 0.0, speed_before = 0.0;
  int released = 0;
  bool permitted = true;
  for (int i = 0; i < 300'000; ++i) {
    if (random() % 150 == 0) permitted = !permitted;
    const double own_s = clock.Step(kDt_s, permitted);
    ASSERT_TRUE(own_s >= 0.0 && own_s <= kDt_s);
    ASSERT_TRUE(clock.rate() >= 0.0 && clock.rate() <= 1.0);
    // mean of r', the derivative of the rate r, over one tick. Between the means of two successive ticks, r'
    // changes for at most one period
    const double speed = (clock.rate() - rate_before) / kDt_s;
    ASSERT_LE(std::abs(speed), PausableClock::MaxRateSpeed(kPause_s) * (1.0 + 1e-9));
    ASSERT_LE(std::abs(speed - speed_before), max_rate_acceleration * kDt_s * (1.0 + 1e-9) + 1e-12);
    rate_before = clock.rate();
    speed_before = speed;
    released = permitted ? 0 : released + 1;
    if (released * kDt_s >= kPause_s) {
      ASSERT_EQ(clock.rate(), 0.0) << "tick " << i;
    }
  }
}

TEST(PausableClock, NoTimePassesInAStepThatIsNotPositiveAndFinite) {
  PausableClock clock(kPause_s);
  static_cast<void>(clock.Step(0.2, true));
  const double rate = clock.rate();
  for (const double dt_s :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_EQ(clock.Step(dt_s, true), 0.0);
  EXPECT_EQ(clock.rate(), rate);
}

TEST(PausableClock, DoesNotAllocate) {
  PausableClock clock(kPause_s);
  rt::CheckedNoAllocScope no_alloc;
  const double own_s = clock.Step(kDt_s, true);
  no_alloc.End();
  EXPECT_GT(own_s, 0.0);
}

}  // namespace
}  // namespace osteon::control
