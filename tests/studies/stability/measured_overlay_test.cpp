// Stability under the impedance law by a measured response, compared with the matrix of the true arm's loop.

#include "studies/stability/measured_overlay.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "control/excitation/multisine.h"
#include "kinematics/serial_chain.h"
#include "studies/stability/impedance_arm.h"

namespace osteon::studies {
namespace {

// The impedance cell's loop without a mount. torque: the arm is under joint impedance.
OverlayLoopParams TrueLoop(bool torque) {
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
  loop.arm.mount.reset();
  return loop;
}

// The response from wrench to position along z, measured perfectly or with relative noise.
MeasuredOverlayParams MeasuredOf(const OverlayLoopParams& truth, double sd_share = 0.0) {
  ImpedanceArmParams own{.chain = truth.chain,
                         .arm = truth.arm,
                         .X_FT = truth.X_FT,
                         .q = truth.q,
                         .gravity_B = truth.gravity_B,
                         .torque = truth.torque};
  const ImpedanceArm arm = ImpedanceArmAt(own);
  const kinematics::SerialChain<7> chain(own.chain, own.gravity_B);
  const Vector3 axis_B = (chain.FlangePose(own.q) * own.X_FT).linear().col(2);
  MeasuredOverlayParams measured{.dead_time_s = truth.arm.dead_cycles * truth.period_s};
  const OverlayResponse response(arm, arm.J.topRows<3>().transpose() * axis_B, measured.dead_time_s,
                                 truth.period_s);
  for (const int harmonic : control::Multisine::Harmonics()) {
    const double hz = control::Multisine::Frequency(harmonic);
    measured.lines.push_back({.hz = hz, .value = response(hz), .sd = sd_share * std::abs(response(hz))});
  }
  return measured;
}

// The stiffest wall with which `stable` holds for the loop.
template <typename Stable>
double GreatestWall_N_per_m(OverlayLoopParams loop, const Stable& stable) {
  return hil::FirstCrossing(
             [&](double stiffness) {
               loop.wall.stiffness_N_per_m = stiffness;
               return stable(loop);
             },
             {.from = 500.0, .to = 200e3, .factor = 1.2, .tolerance = 2e-3})
      .value;
}

double TrueWall_N_per_m(const OverlayLoopParams& truth) {
  return GreatestWall_N_per_m(truth, [](const OverlayLoopParams& p) { return OverlayLoop(p).IsStable(); });
}

double MeasuredWall_N_per_m(const MeasuredOverlay& measured, const OverlayLoopParams& loop) {
  return GreatestWall_N_per_m(loop, [&](const OverlayLoopParams& p) { return measured.IsStable(p, 0.0); });
}

TEST(MeasuredOverlay, PredictsTheStiffestWallOfTheTrueArm) {
  for (const bool torque : {false, true}) {
    OverlayLoopParams truth = TrueLoop(torque);
    const MeasuredOverlay measured(truth, MeasuredOf(truth));
    for (const double damping : {30.0, 100.0, 200.0})
      for (const hil::GridHand& hand :
           {hil::GridHand{"firm", 500.0, 20.0, 1.5}, hil::GridHand{"grip", 3e3, 20.0, 1.5},
            hil::GridHand{"light", 1500.0, 2.0, 0.3}}) {
        truth.law.damping_Ns_per_m.setConstant(damping);
        truth.hand = hand;
        const double wall = TrueWall_N_per_m(truth);
        ASSERT_GT(wall, 500.0);
        EXPECT_NEAR(MeasuredWall_N_per_m(measured, truth), wall, 0.05 * wall)
            << (torque ? "torques, " : "a wrench, ") << damping << " N s/m, " << hand.name;
      }
  }
}

// The cell's file has wrong springs and damping: the measured response must decide, not the model.
TEST(MeasuredOverlay, TheMeasurementDecidesNotTheModel) {
  const OverlayLoopParams truth = TrueLoop(false);
  OverlayLoopParams by_file = truth;
  by_file.arm.cartesian_damping_ratio *= 2.0;
  by_file.arm.stiffness_N_per_m *= 1.5;
  const double wall = TrueWall_N_per_m(truth);
  EXPECT_GT(TrueWall_N_per_m(by_file), 1.15 * wall);
  const MeasuredOverlay measured(by_file, MeasuredOf(truth));
  EXPECT_NEAR(MeasuredWall_N_per_m(measured, by_file), wall, 0.05 * wall);
}

// Later commands and older planes must lower the stiffest wall by as much as in the matrix.
TEST(MeasuredOverlay, LateCommandsAndOldPlanesLowerTheWallAsInTheMatrix) {
  OverlayLoopParams truth = TrueLoop(false);
  const MeasuredOverlay measured(truth, MeasuredOf(truth));
  truth.wall.age_ticks = 4;
  const double aged = TrueWall_N_per_m(truth);
  EXPECT_NEAR(MeasuredWall_N_per_m(measured, truth), aged, 0.05 * aged);
  OverlayLoopParams later = truth;
  later.arm.dead_cycles += 3;
  const double late = TrueWall_N_per_m(later);
  EXPECT_LT(late, 0.95 * aged);
  EXPECT_NEAR(
      GreatestWall_N_per_m(truth, [&](const OverlayLoopParams& p) { return measured.IsStable(p, 3e-3); }),
      late, 0.05 * late);
}

TEST(MeasuredOverlay, GainMarginIsAFactorOnWallAndDampingAndNoiseLowersRobustness) {
  OverlayLoopParams truth = TrueLoop(false);
  const MeasuredOverlay measured(truth, MeasuredOf(truth));
  truth.wall.stiffness_N_per_m = 0.5 * TrueWall_N_per_m(truth);
  const LoopMargins margins = measured.Judge(truth, 0.0);
  ASSERT_TRUE(margins.stable);
  EXPECT_TRUE(margins.robust);
  const double factor = hil::FirstCrossing(
                            [&](double gain) {
                              OverlayLoopParams more = truth;
                              // change only the damping along the axis
                              more.law.damping_Ns_per_m.z() *= gain;
                              more.wall.stiffness_N_per_m *= gain;
                              return OverlayLoop(more).IsStable();
                            },
                            {.from = 1.0, .to = 20.0, .factor = 1.1, .tolerance = 1e-3})
                            .value;
  EXPECT_NEAR(margins.gain, factor, 0.05 * factor);
  truth.wall.stiffness_N_per_m *= 1.9;
  const LoopMargins noisy = MeasuredOverlay(truth, MeasuredOf(truth, 0.3)).Judge(truth, 0.0);
  EXPECT_TRUE(noisy.stable);
  EXPECT_FALSE(noisy.robust) << "|1 + L| " << noisy.modulus << " ± " << noisy.modulus_radius;
}

TEST(MeasuredOverlay, RefusesAResponseOfOneLine) {
  EXPECT_THROW(MeasuredOverlay(TrueLoop(false), {.lines = {{.hz = 1.0}}}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::studies
