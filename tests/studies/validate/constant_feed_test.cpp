#include "studies/validate/constant_feed.h"

#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "config/reading/load.h"

// Drills at a constant feed. The results are compared with the closed form of the rate law.

namespace osteon::studies {
namespace {

const std::filesystem::path kConfig = std::filesystem::path(OSTEON_SOURCE_DIR) / "config";

// A 3.2 mm drill through 4 mm of cortical bone at 2 mm/s.
ConstantFeedParams CorticalDrilling(double rpm) {
  return {.config_root = kConfig,
          .material = config::LoadMaterials(kConfig / "materials" / "bone.yaml")[1],
          .spindle_rad_per_s = rpm * 2.0 * std::numbers::pi / 60.0,
          .steps = {{.feed_m_per_s = 0.002, .depth_m = 0.004}},
          .packing_scale = 1.5};
}

TEST(ConstantFeed, TheWorkOfSpindleAndFeedIsTheMaterialsCuttingEnergy) {
  const ConstantFeedResult drilled = DrillAtConstantFeed(CorticalDrilling(1000));
  EXPECT_NEAR(drilled.removed_share, 1.0, 0.08) << "the drill removes what it sweeps";
  // 1.3e9 J/m³ is the cutting energy; the feed's work per volume, thrust / area, is added to it
  EXPECT_NEAR(drilled.energy_J_per_m3, 1.3e9 + drilled.thrust_N / (std::numbers::pi * 0.0016 * 0.0016),
              0.08e9);
}

// Energy balance of a full cylinder: F = 3 pi u a v / (2 mu w), with cutting energy u, radius a, feed v,
// force ratio mu and spindle speed w.
TEST(ConstantFeed, ThrustFollowsFromTheEnergyBalance) {
  const ConstantFeedResult drilled = DrillAtConstantFeed(CorticalDrilling(1000));
  const double expected_N =
      3.0 * std::numbers::pi * 1.3e9 * 0.0016 * 0.002 / (2.0 * 0.8 * 104.71975511965977);
  EXPECT_NEAR(drilled.thrust_N, expected_N, 0.1 * expected_N);
  EXPECT_NEAR(drilled.torque_Nm, 0.8 * drilled.thrust_N * 2.0 / 3.0 * 0.0016, 0.1 * drilled.torque_Nm);
}

// An edge's force grows linearly with the depth of cut, with an offset. From 2 to 10 um of depth, the force
// in cortical bone must grow by the factor (10 + 24.35) / (2 + 24.35).
TEST(ConstantFeed, ForceGrowsWithTheDepthOfCutByChipAndEdgeShares) {
  const auto thrust_N = [](double chip_m, bool edge_force) {
    ConstantFeedParams params = CorticalDrilling(1000);
    const double feed_m_per_s = chip_m * 2.0 * 1000.0 / 60.0;
    params.steps = {{.feed_m_per_s = 0.002, .depth_m = 0.0022},
                    {.feed_m_per_s = feed_m_per_s, .depth_m = 0.0024}};
    params.packing_scale = 2.0;
    params.edge_force = edge_force;
    return DrillAtConstantFeed(params).thrust_N;
  };
  const simulation::Material cortical = CorticalDrilling(1000).material;
  const double chip_energy =
      cortical.specific_cutting_energy_J_per_m3 - cortical.edge_force_N_per_m / cortical.measured_chip_m;
  const double depth_m =
      cortical.edge_force_N_per_m / chip_energy;  // depth of cut at which chip and edge need equal forces
  EXPECT_NEAR(depth_m, 24.4e-6, 0.1e-6);
  EXPECT_NEAR(thrust_N(10e-6, true) / thrust_N(2e-6, true), (10e-6 + depth_m) / (2e-6 + depth_m), 0.05);
  EXPECT_GT(thrust_N(10e-6, false) / thrust_N(2e-6, false), 4.0);
}

// A drill's axial stiffness is EA / L. At a constant feed its thrust must settle at that of a rigid drill,
// and the drill's point must lag by the thrust over this stiffness.
TEST(ConstantFeed, ACompliantDrillSettlesAtTheSameThrust) {
  const ConstantFeedResult rigid = DrillAtConstantFeed(CorticalDrilling(1000));
  ConstantFeedParams params = CorticalDrilling(1000);
  params.bends = true;
  const ConstantFeedResult bent = DrillAtConstantFeed(params);
  EXPECT_EQ(rigid.bend_m, 0.0);
  EXPECT_NEAR(bent.thrust_N, rigid.thrust_N, 0.02 * rigid.thrust_N);
  const double axial_m_per_N =
      config::LoadTool(kConfig / "tools" / "twist_drill.yaml", 0.0032).bending->compliance.C_T(2, 2);
  EXPECT_GE(bent.bend_m, 0.95 * bent.thrust_N * axial_m_per_N);
  EXPECT_LT(bent.bend_m, 0.05e-3) << "a flat block does not push the point aside";
}

TEST(ConstantFeed, RefusesMissingStepsAndStepsThatLeaveTheBlock) {
  ConstantFeedParams params = CorticalDrilling(1000);
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
}  // namespace osteon::studies
