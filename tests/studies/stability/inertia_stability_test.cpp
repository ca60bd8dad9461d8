// Stability of compensating the tool's inertia in the sensor's reading, which is positive feedback through
// the virtual mass. The loop's matrix is made by stepping the shipped law, arm and StepMotion.

#include <cmath>

#include <gtest/gtest.h>

#include "hil/loops/admittance_loop.h"
#include "hil/operator/hand_grid.h"
#include "tests/oracles/loop_growth.h"

namespace osteon::studies {
namespace {

// name, stiffness [N/m], damping [N s/m], mass [kg]
const hil::GridHand kFree{"nobody", 0.0, 0.0, 0.0}, kFirm{"firm", 500.0, 20.0, 1.5};

// A loop that compensates a share of the tool's inertia, with filters of `hz`.
hil::AdmittanceLoopParams Loop(const hil::GridHand& hand, double tool_kg, double share, double hz = 15.0) {
  hil::AdmittanceLoopParams params{.hand = hand, .wall = {}, .arm = {}};
  params.tool_mass_kg = tool_kg;
  params.inertia_share = share;
  params.acceleration_hz = hz;
  return params;
}

// The largest stable share of compensation.
double MaxStableShare(const hil::GridHand& hand, double tool_kg, double hz = 15.0) {
  return hil::FirstCrossing(
             [&](double share) {
               return hil::AdmittanceLoop(Loop(hand, tool_kg, share, hz)).SpectralRadius() < 1.0 + 1e-9;
             },
             {.from = 0.01, .to = 20.0, .factor = 1.02, .tolerance = 1e-4})
      .value;
}

TEST(InertiaStability, WithoutCompensationTheToolActsAsHandMass) {
  hil::AdmittanceLoopParams heavier = Loop(kFirm, 0.0, 0.0);
  heavier.hand.mass_kg += 1.2;
  EXPECT_NEAR(hil::AdmittanceLoop(Loop(kFirm, 1.2, 0.0)).SpectralRadius(),
              hil::AdmittanceLoop(heavier).SpectralRadius(), 1e-12);
}

// If the compensated share exceeds 1 + m_v / m_t, with the virtual mass m_v and the tool's mass m_t, the
// total mass is negative. The arm's lag raises the stability limit a little, a hand's mass lowers it.
TEST(InertiaStability, TheMaxShareIsNearThatOfZeroVirtualMass) {
  for (const double tool_kg : {0.5, 1.2, 2.5}) {
    const double zero_mass_share = 1.0 + 3.0 / tool_kg;
    for (const double hz : {10.0, 15.0, 60.0})
      for (const hil::GridHand& hand : {kFree, kFirm}) {
        const double bound = MaxStableShare(hand, tool_kg, hz);
        EXPECT_GT(bound, (hand.mass_kg > 0.0 ? 0.93 : 1.0) * zero_mass_share)
            << tool_kg << " kg, " << hz << " Hz, " << hand.name;
        EXPECT_LT(bound, 1.3 * zero_mass_share) << tool_kg << " kg, " << hz << " Hz, " << hand.name;
      }
  }
}

TEST(InertiaStability, MotionGrowsAboveTheMaxShareAndDecaysBelow) {
  const double bound = MaxStableShare(kFirm, 2.5);
  const auto growth = [&](double share) {
    const hil::AdmittanceLoop loop(Loop(kFirm, 2.5, share));
    return GrowthPerPeriod([&](const Eigen::VectorXd& s) { return loop.Step(s); }, loop.size(), 2000, 20'000);
  };
  EXPECT_LT(growth(0.95 * bound), -1e-5);
  EXPECT_GT(growth(1.05 * bound), 1e-5);
}

// In a cell, stability with hands limits the share, not the virtual mass. The filters' lag acts as negative
// drag, so the virtual tool's drag must be larger than this. The test tries every hand up to 3 kN/m, with a
// tool of 1.2 kg and a virtual tool of 3 kg.
TEST(InertiaStability, With35NewtonSecondsPerMetreAllHandsAllowSevenTenths) {
  const auto unstable_hands = [](double share, double damping_Ns_per_m) {
    int count = 0;
    for (const hil::GridHand& hand : hil::HandGrid()) {
      if (hand.stiffness_N_per_m > 3000.0) continue;
      hil::AdmittanceLoopParams loop = Loop(hand, 1.2, share);
      loop.damping_Ns_per_m = damping_Ns_per_m;
      if (hil::AdmittanceLoop(loop).SpectralRadius() >= 1.0) ++count;
    }
    return count;
  };
  EXPECT_EQ(unstable_hands(0.0, 22.0), 0);
  EXPECT_GT(unstable_hands(0.7, 22.0), 0) << "it costs drag";
  EXPECT_EQ(unstable_hands(0.7, 32.0), 0);
  EXPECT_EQ(unstable_hands(0.7 * 1.25, 35.0), 0) << "with margin";
  EXPECT_GT(unstable_hands(1.0, 35.0), 0);
  EXPECT_EQ(unstable_hands(1.0, 40.0), 0) << "a cell with more drag stands the whole";
}

}  // namespace
}  // namespace osteon::studies
