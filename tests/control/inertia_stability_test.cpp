// The tool's own inertia, felt by the sensor and made up for: positive feedback through the virtual mass. The
// loop's matrix steps the shipped law, arm and StepMotion.

#include <cmath>

#include <gtest/gtest.h>

#include "hil/hand_grid.h"
#include "hil/stability/admittance_loop.h"

namespace osteon::hil {
namespace {

const GridHand kFree{"nobody", 0.0, 0.0, 0.0}, kFirm{"firm", 500.0, 20.0, 1.5};

AdmittanceLoopParams Loop(const GridHand& hand, double tool_kg, double share, double hz = 15.0) {
  AdmittanceLoopParams params{.hand = hand, .wall = {}, .arm = {}};
  params.tool_mass_kg = tool_kg;
  params.inertia_share = share;
  params.acceleration_hz = hz;
  return params;
}

// The greatest share that is stable.
double GreatestShare(const GridHand& hand, double tool_kg, double hz = 15.0) {
  return FirstCrossing(
             [&](double share) {
               return AdmittanceLoop(Loop(hand, tool_kg, share, hz)).SpectralRadius() < 1.0 + 1e-9;
             },
             {.from = 0.01, .to = 20.0, .factor = 1.02, .tolerance = 1e-4})
      .value;
}

TEST(InertiaStability, WithoutAShareItIsTheLoopOfAHeavierHand) {
  AdmittanceLoopParams heavier = Loop(kFirm, 0.0, 0.0);
  heavier.hand.mass_kg += 1.2;
  EXPECT_NEAR(AdmittanceLoop(Loop(kFirm, 1.2, 0.0)).SpectralRadius(),
              AdmittanceLoop(heavier).SpectralRadius(), 1e-12);
}

TEST(InertiaStability, Print) {
  for (const double hz : {5.0, 10.0, 15.0, 30.0, 60.0})
    for (const double tool : {0.5, 1.2, 2.5})
      std::printf("hz %g tool %g: free %.4f firm %.4f\n", hz, tool, GreatestShare(kFree, tool, hz),
                  GreatestShare(kFirm, tool, hz));
  for (const double share : {0.0, 0.5, 0.7, 0.8, 0.9, 1.0})
    for (double b : {20.0, 30.0, 150.0}) {
      AdmittanceLoopParams p = Loop({"", 3000, 60, 3}, 1.2, share);
      p.damping_Ns_per_m = b;
      double worst = 0, grown = 0;
      for (const GridHand& h : HandGrid()) {
        if (h.stiffness_N_per_m > 3000) continue;
        p.hand = h;
        const double rho = AdmittanceLoop(p).SpectralRadius();
        worst = std::max(worst, rho);
        grown += rho >= 1.0;
      }
      std::printf("share %g b %g worst rho-1 %.3e unstable hands %g\n", share, b, worst - 1, grown);
    }
}

}  // namespace
}  // namespace osteon::hil
