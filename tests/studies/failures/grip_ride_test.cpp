#include "studies/failures/loop/grip_ride.h"

#include <algorithm>

#include <gtest/gtest.h>

// A hand with tremor, and one that stiffens, with the servo loop and an arm that lags.

namespace osteon::studies {
namespace {

const hil::GridHand kLoose{"loose", 300.0, 13.0, 1.1};
const hil::GridHand kClamp{"clamp", 50000.0, 50.0, 0.0};

TEST(GripRide, ATremorThatBeginsIsTestedOnceAndLeavesTheToolLight) {
  for (const double tremor_N : {1.0, 3.0}) {
    const GripRide ride = RideGrip(
        {.after = kLoose, .step_s = 0.1, .seconds = 8.0, .tremor_N = tremor_N, .tremor_from_s = 2.0});
    EXPECT_FALSE(ride.fault);
    EXPECT_GT(ride.references_N.back(), 0.6 * tremor_N) << "three axes";
    EXPECT_LT(ride.references_N.back(), 1.8 * tremor_N);
    EXPECT_LT(ride.heavy_s, 3.0) << tremor_N;
    const auto from = ride.damping_factors.begin() + 5000;
    EXPECT_LT(*std::max_element(from, ride.damping_factors.end()), 2.0) << tremor_N;
  }
}

TEST(GripRide, AStiffGripIsCalmedWithinHalfASecond) {
  for (const hil::GridHand& hand :
       {hil::GridHand{"6", 6000.0, 13.0, 1.1}, hil::GridHand{"10", 10000.0, 13.0, 1.1}, kClamp}) {
    const GripRide ride = RideGrip({.after = hand, .clamp = hand.name == "clamp"});
    EXPECT_FALSE(ride.fault);
    EXPECT_LT(ride.calm_N, 0.5) << hand.name;
  }
}

// Close to its stability limit, the loop amplifies a tremor: twofold in a hand, more in a clamp.
TEST(GripRide, AStiffGripIsCalmedInATremor) {
  for (const double tremor_N : {0.5, 1.0, 2.0})
    for (const hil::GridHand& hand :
         {hil::GridHand{"6", 6000.0, 13.0, 1.1}, hil::GridHand{"10", 10000.0, 13.0, 1.1}, kClamp}) {
      const GripRide ride =
          RideGrip({.after = hand, .clamp = hand.name == "clamp", .seconds = 6.0, .tremor_N = tremor_N});
      EXPECT_FALSE(ride.fault);
      EXPECT_LT(ride.calm_N, (hand.name == "clamp" ? 3.5 : 2.0) * ride.tremor_N + 0.5)
          << hand.name << ", " << tremor_N << " N";
      EXPECT_LT(ride.references_N.back(), 1.8 * tremor_N) << hand.name << ", " << tremor_N << " N";
    }
}

}  // namespace
}  // namespace osteon::studies
