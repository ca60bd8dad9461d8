#include "studies/validate/constant_feed.h"

#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "config/reading/load.h"

// A drill at constant feed against the closed form of the rate law.

namespace osteon::app {
namespace {

const std::filesystem::path kConfig = std::filesystem::path(OSTEON_SOURCE_DIR) / "config";

ConstantFeedParams Cortical(double rpm) {
  return {.config_root = kConfig,
          .material = config::LoadMaterials(kConfig / "materials" / "bone.yaml")[1],
          .spindle_rad_per_s = rpm * 2.0 * std::numbers::pi / 60.0,
          .steps = {{.feed_m_per_s = 0.002, .depth_m = 0.004}},
          .packing_scale = 1.5};
}

TEST(ConstantFeed, TheWorkOfSpindleAndFeedIsTheMaterialsCuttingEnergy) {
  const ConstantFeedResult drilled = DrillAtConstantFeed(Cortical(1000));
  EXPECT_NEAR(drilled.removed_share, 1.0, 0.08) << "the drill removes what it sweeps";
  // the feed's work, thrust × feed, comes on top of the edge's
  EXPECT_NEAR(drilled.energy_J_per_m3, 1.3e9 + drilled.thrust_N / (std::numbers::pi * 0.0016 * 0.0016),
              0.08e9);
}

// Energy balance of a full cylinder: F = 3 pi u a v / (2 mu w).
TEST(ConstantFeed, ThrustFollowsFromTheEnergyBalance) {
  const ConstantFeedResult drilled = DrillAtConstantFeed(Cortical(1000));
  const double expected_N =
      3.0 * std::numbers::pi * 1.3e9 * 0.0016 * 0.002 / (2.0 * 0.8 * 104.71975511965977);
  EXPECT_NEAR(drilled.thrust_N, expected_N, 0.1 * expected_N);
  EXPECT_NEAR(drilled.torque_Nm, 0.8 * drilled.thrust_N * 2.0 / 3.0 * 0.0016, 0.1 * drilled.torque_Nm);
}

TEST(ConstantFeed, RefusesStepsThatAreNoneOrLeaveTheBlock) {
  ConstantFeedParams params = Cortical(1000);
  params.steps = {};
  EXPECT_THROW(static_cast<void>(DrillAtConstantFeed(params)), std::invalid_argument);
  params.steps = {{.feed_m_per_s = 0.002, .depth_m = 0.004}, {.feed_m_per_s = 0.002, .depth_m = 0.003}};
  EXPECT_THROW(static_cast<void>(DrillAtConstantFeed(params)), std::invalid_argument);
  params.steps = {{.feed_m_per_s = 0.0, .depth_m = 0.004}};
  EXPECT_THROW(static_cast<void>(DrillAtConstantFeed(params)), std::invalid_argument);
  params.steps = {{.feed_m_per_s = 0.002, .depth_m = kFeedBlock_m}};
  EXPECT_THROW(static_cast<void>(DrillAtConstantFeed(params)), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::app
