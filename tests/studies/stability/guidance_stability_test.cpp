#include <gtest/gtest.h>

#include "hil/loops/admittance_loop.h"
#include "studies/stability/guided_loop.h"

namespace osteon::studies {
namespace {

GuidedLoopParams Loop() {
  GuidedLoopParams params;
  params.guidance.head_m = 0.022;
  return params;
}

// The slope of the shipped field: funnel at the head, cone at the apex.
TEST(GuidanceStability, StiffnessIsThatOfFunnelAndCone) {
  const GuidedLoopParams params = Loop();
  const Eigen::Matrix2d K = GuidedLoop(params).stiffness();
  const double cos_psi = std::cos(params.guidance.widening_rad), head_m = params.guidance.head_m;
  const double lateral = params.guidance.lateral.stiffness * cos_psi * cos_psi;
  EXPECT_NEAR(K(0, 0), lateral, 1e-3 * lateral);
  // at the cone's edge the head is tilted by 9 degrees: it goes aside by the cosine, and along the axis as
  // well
  EXPECT_NEAR(K(0, 1), -lateral * head_m, 0.05 * lateral * head_m);
  EXPECT_NEAR(K(1, 0), K(0, 1), 1e-3 * lateral * head_m) << "a potential's slope is symmetric";
  EXPECT_NEAR(K(1, 1), params.guidance.cone.stiffness + lateral * head_m * head_m,
              0.01 * params.guidance.cone.stiffness);
}

// At lever 0 nothing turns: without guidance the planar loop has
// has the same verdict as the loop of one axis.
TEST(GuidanceStability, AtNoLeverItIsTheLoopOfOneAxis) {
  GuidedLoopParams params = Loop();
  params.lever_m = 0.0;
  params.guidance.lateral.stiffness = params.guidance.cone.stiffness = 0.0;
  int stable = 0, all = 0;
  for (const hil::GridHand& hand : hil::HandGrid()) {
    params.hand = hand;
    const hil::AdmittanceLoopParams axis{.hand = hand,
                                         .mass_kg = params.mass_kg,
                                         .damping_Ns_per_m = params.damping_Ns_per_m,
                                         .arm = params.arm,
                                         .sensor_delay = params.sensor_delay};
    const double radius = hil::AdmittanceLoop(axis).SpectralRadius();
    EXPECT_EQ(GuidedLoop(params).IsStable(), radius < 1.0 + 1e-7) << hand.name;
    stable += radius < 1.0 ? 1 : 0;
    ++all;
  }
  EXPECT_GT(stable, 10);
  EXPECT_LT(stable, all);
}

TEST(GuidanceStability, ShippedGainsMakeNoHandUnstable) {
  const GuidedLoopParams params = Loop();
  const std::vector<HeldHand> hands = HandsStableWithoutGuidance(params);
  EXPECT_EQ(hands.size(), 95u) << "15 Hz, 3 ms, three levers";
  EXPECT_TRUE(HandsThatGuidanceMakesUnstable(params, hands).empty());
  const hil::Boundary boundary = GuidanceBoundary(params, hands, 10.0);
  EXPECT_GT(boundary.value, 2.0) << "the shipped gains are at most half of the boundary";
  EXPECT_TRUE(boundary.crossed) << "and there is one";
}

TEST(GuidanceStability, AStiffFunnelOrAnOldSensorMakesSomeUnstable) {
  GuidedLoopParams params = Loop();
  params.guidance.lateral.stiffness = 40e3;
  EXPECT_FALSE(HandsThatGuidanceMakesUnstable(params, HandsStableWithoutGuidance(params)).empty());
  GuidedLoopParams late = Loop();
  late.sensor_delay = 5;
  EXPECT_FALSE(HandsThatGuidanceMakesUnstable(late, HandsStableWithoutGuidance(late)).empty());
}

// Depth has no lever: the wall of the one-axis loop, evaluated in the tick.
TEST(GuidanceStability, AlongTheAxisTwentyNewtonsPerMillimetreHaveMargin) {
  for (const hil::GridHand& hand : hil::HandGrid()) {
    hil::AdmittanceLoopParams axis{.hand = hand, .mass_kg = 1.7, .damping_Ns_per_m = 30.0};
    if (hil::AdmittanceLoop(axis).SpectralRadius() >= 1.0 || hand.name == "clamp" || hand.name == "fixture")
      continue;
    axis.wall.stiffness_N_per_m = 2.0 * control::kMaxDepthStiffness_N_per_m;
    EXPECT_LT(hil::AdmittanceLoop(axis).SpectralRadius(), 1.0) << hand.name;
  }
}

}  // namespace
}  // namespace osteon::studies
