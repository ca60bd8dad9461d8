// Stability under the impedance law: the loop's matrix against the shipped arm, coupling and law simulated in
// time.

#include "studies/stability/overlay_loop.h"

#include <gtest/gtest.h>

#include "config/reading/load.h"

namespace osteon::studies {
namespace {

// The loop of the impedance cell. torque: the arm is under joint impedance.
OverlayLoopParams ImpedanceCellLoop(bool torque) {
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

// The stiffest stable wall, by the matrix.
double MaxWall_N_per_m(OverlayLoopParams loop) {
  return hil::FirstCrossing(
             [&](double stiffness) {
               loop.wall.stiffness_N_per_m = stiffness;
               return OverlayLoop(loop).IsStable();
             },
             {.from = 500.0, .to = 200e3, .factor = 1.2, .tolerance = 2e-3})
      .value;
}

TEST(OverlayLoop, SimulatedArmTurnsUnstableAtTheMatrixsStiffestWall) {
  for (const bool torque : {false, true}) {
    OverlayLoopParams loop = ImpedanceCellLoop(torque);
    const double most = MaxWall_N_per_m(loop);
    ASSERT_GT(most, 500.0) << torque;
    ASSERT_LT(most, 200e3) << torque;
    for (const double share : {0.93, 1.07}) {
      loop.wall.stiffness_N_per_m = share * most;
      EXPECT_EQ(OverlayGrows(loop), share > 1.0) << torque << ", " << share << " of " << most;
    }
  }
}

// The arm's controller doesn't know the hand's mass, so its joint damping must not include it. Otherwise
// walls that are 7 % too stiff would seem stable with a heavy hand.
TEST(OverlayLoop, AHeavyHandAddsNothingToTheArmsOwnDamping) {
  OverlayLoopParams loop = ImpedanceCellLoop(true);
  loop.law.damping_Ns_per_m.setConstant(200.0);
  loop.hand = {"heavy", 500.0, 20.0, 3.0};
  const double most = MaxWall_N_per_m(loop);
  for (const double share : {0.97, 1.03}) {
    loop.wall.stiffness_N_per_m = share * most;
    EXPECT_EQ(OverlayGrows(loop, 4.0), share > 1.0) << share << " of " << most;
  }
}

TEST(OverlayLoop, DeadTimeAndAgeEachLowerTheStiffestWall) {
  const OverlayLoopParams loop = ImpedanceCellLoop(false);
  const double most = MaxWall_N_per_m(loop);
  OverlayLoopParams later = loop;
  later.arm.dead_cycles += 3;
  EXPECT_LT(MaxWall_N_per_m(later), 0.95 * most);
  OverlayLoopParams older = loop;
  older.wall.age_ticks = 4;
  EXPECT_LT(MaxWall_N_per_m(older), 0.95 * most);
}

// Without a wall every hand up to 3 kN/m must be stable.
TEST(OverlayLoop, AHandIsStableWithoutAWall) {
  for (const hil::GridHand& hand : hil::HandGrid()) {
    if (hand.stiffness_N_per_m > 3e3) continue;
    OverlayLoopParams loop = ImpedanceCellLoop(true);
    loop.hand = hand;
    EXPECT_TRUE(OverlayLoop(loop).IsStable()) << hand.name;
  }
}

}  // namespace
}  // namespace osteon::studies
