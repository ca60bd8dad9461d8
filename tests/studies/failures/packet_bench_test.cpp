#include "studies/failures/packet_bench.h"

#include <gtest/gtest.h>

// The bench of scenario 14: its condition D > a_max K separates the cases that grow from the others.

namespace osteon::studies {
namespace {

PacketRideParams Delayed(WallMethod method, rt::Nanoseconds delay) {
  return {.method = method, .after = {.delay = delay}};
}

TEST(PacketBench, AgesAreTheWiresDelaysAndATickAtLeast) {
  for (const int delay_ms : {0, 1, 4}) {
    const PacketRide ride = RidePackets(Delayed(WallMethod::kHeld, delay_ms * rt::kMillisecond));
    EXPECT_DOUBLE_EQ(ride.wall_age_s, delay_ms == 0 ? 1e-3 : 2e-3 * delay_ms) << "there and back";
    EXPECT_EQ(ride.wall_age_s, ride.hand_age_s);
  }
}

// x'' m + x' D + K x(t - a): the first crossing of a pure delay, w^2 m = K cos(w a), w D = K sin(w a).
TEST(PacketBench, HeldForcesGrowFromTheDelayThatTheoryGives) {
  // K 20e3, D 80, m 3: w = 79.5 rad/s, a = 4.07 ms (the hold adds half a tick): at rest with ages of 2 ms,
  // growing with 6
  const PacketRideParams below = Delayed(WallMethod::kHeld, 1 * rt::kMillisecond),
                         above = Delayed(WallMethod::kHeld, 3 * rt::kMillisecond);
  const PacketRide small = RidePackets(below), large = RidePackets(above);
  EXPECT_GT(AgeMargin(below, small), 0.0);
  EXPECT_LT(small.Growth(), 1.0);
  EXPECT_LT(AgeMargin(above, large), 0.0);
  EXPECT_GT(large.Growth(), 10.0);
}

TEST(PacketBench, PlanesDoNotMindAnAgeThatForcesDo) {
  const PacketRideParams params = Delayed(WallMethod::kPlanes, 10 * rt::kMillisecond);
  const PacketRide ride = RidePackets(params);
  EXPECT_GT(ride.wall_age_s, 0.019);
  EXPECT_GT(AgeMargin(params, ride), 0.0);
  EXPECT_LT(ride.Growth(), 1e-3);
}

// Planes that turn under the tool act with an age as well; their stiffness is force over clearance.
TEST(PacketBench, PlanesThatTurnTooFastForTheirAgeGrow) {
  PacketRideParams params = Delayed(WallMethod::kPlanes, 10 * rt::kMillisecond);
  params.clearance_m = 1e-3;  // 30 N: 30 kN/m, 20 ms old
  const PacketRide ride = RidePackets(params);
  EXPECT_LT(AgeMargin(params, ride), 0.0);
  EXPECT_GT(ride.Growth(), 1.0);
  params.after = {};
  EXPECT_LT(RidePackets(params).Growth(), 1e-3) << "of no age they rest";
}

}  // namespace
}  // namespace osteon::studies
