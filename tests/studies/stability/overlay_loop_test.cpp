// The loop of the impedance law: predicted by its matrix, and seen with the shipped arm, coupling and law in
// time.

#include "studies/stability/overlay_loop.h"

#include <gtest/gtest.h>

#include "config/reading/load.h"

namespace osteon::studies {
namespace {

OverlayLoopParams Loop(bool torque) {
  const config::CellConfig cell =
      config::LoadCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate_impedance.yaml");
  OverlayLoopParams loop{.chain = cell.robot.lbr()->chain,
                         .arm = cell.simulated.dynamic,
                         .X_FT = cell.tool.X_FT,
                         .q = cell.start.q,
                         .torque = torque,
                         .law = cell.servo.impedance};
  loop.gravity_B = cell.X_WB.linear().transpose() * kinematics::kGravity_W_m_per_s2;
  loop.law.damping_Ns_per_m.setConstant(100.0);
  return loop;
}

double Boundary_N_per_m(OverlayLoopParams loop) {
  return hil::FirstCrossing(
             [&](double stiffness) {
               loop.wall.stiffness_N_per_m = stiffness;
               return OverlayLoop(loop).IsStable();
             },
             {.from = 500.0, .to = 200e3, .factor = 1.2, .tolerance = 2e-3})
      .value;
}

TEST(OverlayLoop, TheArmInTimeGrowsWhereTheMatrixSays) {
  for (const bool torque : {false, true}) {
    OverlayLoopParams loop = Loop(torque);
    const double most = Boundary_N_per_m(loop);
    ASSERT_GT(most, 500.0) << torque;
    ASSERT_LT(most, 200e3) << torque;
    for (const double share : {0.93, 1.07}) {
      loop.wall.stiffness_N_per_m = share * most;
      EXPECT_EQ(OverlayGrows(loop), share > 1.0) << torque << ", " << share << " of " << most;
    }
  }
}

// The arm's controller does not know the hand: with torques its damping is that of the joints without it.
// Counted in, a heavy hand and much damping of the law would seem to stand walls that are 7 % stiffer.
TEST(OverlayLoop, AHeavyHandAddsNothingToTheArmsOwnDamping) {
  OverlayLoopParams loop = Loop(true);
  loop.law.damping_Ns_per_m.setConstant(200.0);
  loop.hand = {"heavy", 500.0, 20.0, 3.0};
  const double most = Boundary_N_per_m(loop);
  for (const double share : {0.97, 1.03}) {
    loop.wall.stiffness_N_per_m = share * most;
    EXPECT_EQ(OverlayGrows(loop, 4.0), share > 1.0) << share << " of " << most;
  }
}

TEST(OverlayLoop, DeadTimeAndAgeEachCostStiffness) {
  const OverlayLoopParams loop = Loop(false);
  const double most = Boundary_N_per_m(loop);
  OverlayLoopParams later = loop;
  later.arm.dead_cycles += 3;
  EXPECT_LT(Boundary_N_per_m(later), 0.95 * most);
  OverlayLoopParams older = loop;
  older.wall.age_ticks = 4;
  EXPECT_LT(Boundary_N_per_m(older), 0.95 * most);
}

// The oscillation of a heavy hand on the wall is that of a mass on a spring: no wall is needed to be free of
// it.
TEST(OverlayLoop, AHandIsStableWithoutAWall) {
  for (const hil::GridHand& hand : hil::HandGrid()) {
    if (hand.stiffness_N_per_m > 3e3) continue;
    OverlayLoopParams loop = Loop(true);
    loop.hand = hand;
    EXPECT_TRUE(OverlayLoop(loop).IsStable()) << hand.name;
  }
}

}  // namespace
}  // namespace osteon::studies
