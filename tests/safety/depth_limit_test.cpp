#include "safety/depth_limit.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "safety/workspace.h"

namespace osteon::safety {
namespace {

constexpr double kDt_s = 0.001;

// The apex may go down to z = 0; the resistance begins 4 mm above, the spindle stops 1 mm above.
DepthLimitParams FloorAtZero() {
  return {.acts = true,
          .soft_m = 4e-3,
          .spindle_stop_m = 1e-3,
          .stiffness_N_per_m = 10e3,
          .damping_Ns_per_m = 100.0};
}
const Vector3 kStill = Vector3::Zero();  // velocity of a tool at rest

TEST(DepthLimit, ResistsFromItsSoftZoneOnAndNeverPulls) {
  DepthLimit limit(FloorAtZero());
  EXPECT_TRUE(limit.Step({0, 0, 5e-3}, {0, 0, -0.1}).isZero(0.0));
  EXPECT_NEAR(limit.Step({0, 0, 2e-3}, kStill).z(), 10e3 * 2e-3, 1e-9);
  EXPECT_NEAR(limit.Step({0, 0, 2e-3}, {0, 0, -0.01}).z(), 20.0 + 100.0 * 0.01, 1e-9) << "more on the way in";
  EXPECT_NEAR(limit.Step({0, 0, 2e-3}, {0, 0, 0.2}).z(), 20.0, 1e-9) << "no less on the way out";
  EXPECT_NEAR(limit.Step({0, 0, 2e-3}, {0, 0, -9.0}).z(), 25.0, 1e-9) << "the damper adds a quarter at most";
}

TEST(DepthLimit, StopsTheSpindleUntilTheToolIsRetracted) {
  DepthLimit limit(FloorAtZero());
  const auto stops_at = [&](double z_m) {
    static_cast<void>(limit.Step({0, 0, z_m}, kStill));
    return limit.stops_spindle();
  };
  EXPECT_FALSE(stops_at(2e-3));
  EXPECT_TRUE(stops_at(1e-3));
  EXPECT_TRUE(stops_at(3.9e-3)) << "back, and not yet out of the soft zone";
  EXPECT_FALSE(stops_at(4e-3));
  EXPECT_TRUE(stops_at(std::numeric_limits<double>::quiet_NaN())) << "nobody knows how deep";
}

// Sums the resistance's work over many motions in and out. The resistance must not give more energy than its
// spring has stored.
TEST(DepthLimit, GeneratesNoEnergyOverAnyMotion) {
  DepthLimit limit(FloorAtZero());
  double given_J = 0.0, z = 6e-3;
  for (int i = 0; i < 20'000; ++i) {
    const double v = 0.02 * std::sin(1e-3 * i * 7.0) + 0.01 * std::sin(1e-3 * i * 31.0);
    const double f = limit.Step({0, 0, z}, {0, 0, v}).z(), z_next = z + kDt_s * v;
    // the mean of the forces at both ends of a step gives a spring's exact work
    const double f_next = DepthLimit(FloorAtZero()).Step({0, 0, z_next}, kStill).z();
    given_J += 0.5 * (f + f_next) * (z_next - z);
    z = z_next;
  }
  const double stored_J = 0.5 * 10e3 * std::pow(std::max(0.0, 4e-3 - z), 2);
  EXPECT_LE(given_J, -stored_J + 1e-9);
}

// A hand pushes with 300 N, far more than the resistance. The apex must stop at the bound, z = 0.
TEST(DepthLimit, ItsBoundHoldsAgainstAHandThatIsStrongerThanItsResistance) {
  WorkspaceParams params{.sphere_radius_m = 1.0};
  params.zones.push_back(ZoneOf(FloorAtZero()));
  const Workspace workspace(params);
  DepthLimit limit(FloorAtZero());
  Vector3 p(0, 0, 10e-3), v = Vector3::Zero();
  for (int i = 0; i < 5000; ++i) {
    const Vector3 f = limit.Step(p, v) + Vector3(0, 0, -300.0);
    v += kDt_s * (f - 30.0 * v) / 2.0;
    v = workspace.Limit(p, v, kDt_s).v_WT;
    p += kDt_s * v;
    ASSERT_GE(p.z(), -1e-9);
  }
  EXPECT_LT(p.z(), 1e-4);
  EXPECT_TRUE(limit.stops_spindle());
}

TEST(DepthLimit, DoesNothingIfItIsTurnedOff) {
  DepthLimitParams params = FloorAtZero();
  params.acts = false;
  DepthLimit limit(params);
  EXPECT_TRUE(limit.Step({0, 0, -1.0}, {0, 0, -1.0}).isZero(0.0));
  EXPECT_FALSE(limit.stops_spindle() || limit.resists());
}

TEST(DepthLimit, RefusesDistancesAndGainsOutOfRange) {
  const auto refuses = [](double DepthLimitParams::*field, double value) {
    DepthLimitParams params = FloorAtZero();
    params.*field = value;
    EXPECT_THROW(DepthLimit{params}, std::invalid_argument);
  };
  refuses(&DepthLimitParams::soft_m, 0.0);
  refuses(&DepthLimitParams::spindle_stop_m, 5e-3);
  refuses(&DepthLimitParams::stiffness_N_per_m, -1.0);
  refuses(&DepthLimitParams::damping_Ns_per_m, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace
}  // namespace osteon::safety
