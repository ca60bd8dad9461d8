// The energy limits, expressed as forces and speeds; the spindle's trip; and the counts of how often limits
// acted.

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "safety/acting_limits.h"
#include "safety/energy_limits.h"
#include "safety/spindle_trip.h"

namespace osteon::safety {
namespace {

TEST(EnergyLimits, GiveTheForceAndSpeedOfThatEnergy) {
  const double force_N = ForceOfEnergy(0.5, 10e3), speed_m_per_s = SpeedOfEnergy(0.4, 20.0);
  EXPECT_NEAR(0.5 * force_N * force_N / 10e3, 0.5, 1e-12);
  EXPECT_NEAR(0.5 * 20.0 * speed_m_per_s * speed_m_per_s, 0.4, 1e-12);
  EXPECT_TRUE(std::isinf(ForceOfEnergy(std::numeric_limits<double>::infinity(), 1.0)));
}

TEST(EnergyLimits, OnlyAWrenchThatGivesPowerIsScaled) {
  // 100 N × 0.2 m/s + 2 N·m × 1 rad/s = 22 W, into the hand or out of it
  const Wrench F{.f = {100.0, 0, 0}, .t = {0, 0, 2.0}};
  const Twist gives{.v = {0.2, 0, 0}, .w = {0, 0, 1.0}}, takes{.v = {-0.2, 0, 0}, .w = {0, 0, -1.0}};
  EXPECT_EQ(PowerScale(F, gives, 50.0), 1.0);
  EXPECT_NEAR(PowerScale(F, gives, 11.0) * (100.0 * 0.2 + 2.0 * 1.0), 11.0, 1e-12);
  EXPECT_EQ(PowerScale(F, takes, 1.0), 1.0);
}

TEST(EnergyLimits, RefuseValuesThatAreNotPositive) {
  EXPECT_NO_THROW(Validate(EnergyLimitParams{}));
  EXPECT_THROW(Validate({.max_stored_J = 0.0}), std::invalid_argument);
  EXPECT_THROW(Validate({.max_power_W = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(Validate({.moving_mass_kg = -1.0}), std::invalid_argument);
}

TEST(SpindleTrip, TripsAfterItsTimeBeyondALimitWithoutAPause) {
  SpindleTrip trip({.max_torque_Nm = 5.0, .max_speed_rad_per_s = 30.0, .trip_s = 0.01});
  const auto after = [&](double torque_Nm, double speed, int ticks) {
    bool tripped = false;
    for (int i = 0; i < ticks; ++i) tripped = trip.Check(torque_Nm, speed, 0.001);
    return tripped;
  };
  EXPECT_FALSE(after(4.9, 29.0, 100));
  EXPECT_FALSE(after(5.1, 0.0, 9));
  EXPECT_FALSE(after(1.0, 0.0, 1)) << "a pause";
  EXPECT_FALSE(after(-5.1, 0.0, 9));
  EXPECT_TRUE(after(-5.1, 0.0, 2)) << "either sign";
  trip.Reset();
  EXPECT_TRUE(after(0.0, -31.0, 11));
  trip.Reset();
  EXPECT_TRUE(after(std::nan(""), 0.0, 11)) << "what is not known is beyond";
  EXPECT_THROW(SpindleTrip({.max_torque_Nm = 0.0}), std::invalid_argument);
}

TEST(LimitCounts, CountTicksRunsAndTheLongestRun) {
  LimitCounts counts;
  const auto acts = [&](int ticks) {
    LimitSet acting;
    acting.Add(Limit::kPower);
    acting.Add(Limit::kTank, ticks == 3);
    for (int i = 0; i < ticks; ++i) counts.Count(acting);
    counts.Count({});
  };
  acts(3);
  acts(5);
  acts(2);
  EXPECT_EQ(counts.Of(Limit::kPower).ticks, 10u);
  EXPECT_EQ(counts.Of(Limit::kPower).events, 3u);
  EXPECT_EQ(counts.Of(Limit::kPower).longest, 5u);
  EXPECT_EQ(counts.Of(Limit::kTank).events, 1u);
  EXPECT_EQ(counts.Of(Limit::kWrench).ticks, 0u);
}

}  // namespace
}  // namespace osteon::safety
