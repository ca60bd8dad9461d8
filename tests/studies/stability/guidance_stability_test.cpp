#include <gtest/gtest.h>

#include "hil/loops/admittance_loop.h"
#include "studies/stability/guided_loop.h"

namespace osteon::studies {
namespace {

// The shipped loop and guidance, with the head's centre 22 mm behind the apex.
GuidedLoopParams ShippedLoop() {
  GuidedLoopParams params;
  params.guidance.head_m = 0.022;
  return params;
}

// The loop's stiffness matrix K must equal the slope of the shipped guidance field: the funnel acts at the
// head, the cone at the apex.
TEST(GuidanceStability, StiffnessEqualsThatOfFunnelAndCone) {
  const GuidedLoopParams params = ShippedLoop();
  const Eigen::Matrix2d K = GuidedLoop(params).stiffness();
  const double cos_psi = std::cos(params.guidance.widening_rad), head_m = params.guidance.head_m;
  const double lateral = params.guidance.lateral.stiffness * cos_psi * cos_psi;
  EXPECT_NEAR(K(0, 0), lateral, 1e-3 * lateral);
  // at the cone's edge the tool is tilted by 9 degrees: turning moves the head sideways by the cosine, and
  // along the axis
  EXPECT_NEAR(K(0, 1), -lateral * head_m, 0.05 * lateral * head_m);
  EXPECT_NEAR(K(1, 0), K(0, 1), 1e-3 * lateral * head_m) << "a potential's slope is symmetric";
  EXPECT_NEAR(K(1, 1), params.guidance.cone.stiffness + lateral * head_m * head_m,
              0.01 * params.guidance.cone.stiffness);
}

// Without a lever, nothing turns. Without guidance too, the planar loop must be stable for the same hands as
// the loop of one axis.
TEST(GuidanceStability, WithoutALeverEqualsTheLoopOfOneAxis) {
  GuidedLoopParams params = ShippedLoop();
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
  const GuidedLoopParams params = ShippedLoop();
  const std::vector<HeldHand> hands = HandsStableWithoutGuidance(params);
  EXPECT_EQ(hands.size(), 95u) << "15 Hz, 3 ms, three levers";
  EXPECT_TRUE(HandsThatGuidanceMakesUnstable(params, hands).empty());
  const hil::Boundary boundary = GuidanceBoundary(params, hands, 10.0);
  EXPECT_GT(boundary.value, 2.0) << "the shipped gains are at most half of the boundary";
  EXPECT_TRUE(boundary.crossed) << "and there is one";
}

TEST(GuidanceStability, AStiffFunnelOrALateSensorMakesSomeHandsUnstable) {
  GuidedLoopParams params = ShippedLoop();
  params.guidance.lateral.stiffness = 40e3;
  EXPECT_FALSE(HandsThatGuidanceMakesUnstable(params, HandsStableWithoutGuidance(params)).empty());
  GuidedLoopParams late = ShippedLoop();
  late.sensor_delay = 5;
  EXPECT_FALSE(HandsThatGuidanceMakesUnstable(late, HandsStableWithoutGuidance(late)).empty());
}

// The depth limit pushes along the axis, without a lever: it acts as the wall of the one-axis loop.
TEST(GuidanceStability, TheMaxDepthStiffnessIsStableWithAFactorOfTwo) {
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
