#include "control/stability/passivity.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "control/laws/admittance_law.h"
#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::control {
namespace {

constexpr double kT = 1e-3, kK = 20e3;

PortTick At(double z_m, double v_m_per_s, double force_N, double potential_J) {
  PortTick port{.F_T_W = {.f = force_N * Vector3::UnitZ(), .t = Vector3::Zero()},
                .potential_J = potential_J,
                .contact = force_N > 0.0};
  port.X_WT.translation().z() = z_m;
  port.V_WT.v.z() = v_m_per_s;
  return port;
}

// The shipped law swings on a spring at a lever, in all six axes: a spring generates no energy at any time.
TEST(Passivity, OfASpringTheTrapezoidFindsNothingMadeAndHeldForcesFindWhatTheyMake) {
  PassivityParams params{.acts = false, .allowance_J = 0.0};
  PassivityController trapezoid(params, PortWork::kTrapezoid, kT, 1e6),
      held(params, PortWork::kHeld, kT, 1e6);
  AdmittanceParams law;
  law.damping_Ns_per_m.setConstant(1e-9);
  law.damping_Nms_per_rad.setConstant(1e-9);
  AdmittanceState tool;
  tool.X_WT.translation().z() = -2e-3;
  double most_J = 0.0, held_J = 0.0, stored_J = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3 d = tool.X_WT.translation();
    const Vector3 turn = LogRotation(tool.X_WT.linear());
    const Wrench F{.f = -kK * (d + Vector3(0, 0, 3e-3)), .t = -20.0 * turn + Vector3(0.02, 0, 0)};
    // a potential so large that nothing is forgotten
    const PortTick port{
        .F_T_W = F, .potential_J = 1e3, .contact = true, .X_WT = tool.X_WT, .V_WT = tool.V_WT};
    static_cast<void>(trapezoid.Step(port));
    static_cast<void>(held.Step(port));
    stored_J = std::max(stored_J, 0.5 * kK * (d + Vector3(0, 0, 3e-3)).squaredNorm());
    most_J = std::max(most_J, trapezoid.energy_J());
    held_J = std::max(held_J, held.energy_J());
    ASSERT_TRUE(StepAdmittance(law, F, kT, tool));
  }
  // it begins stretched by 1 mm: 10 mJ and the torque's energy, given back only once
  EXPECT_LT(most_J, 0.0101);
  EXPECT_GT(held_J, 0.1) << "K v^2 T^2 / 2 a tick";
}

TEST(Passivity, WhatWasDissipatedLongAgoDoesNotHideWhatIsMadeNow) {
  PassivityController controller({.allowance_J = 0.02}, PortWork::kTrapezoid, kT, 1e6);
  // a minute of cutting: 100 N against a motion of 10 mm/s, 1 W
  double z = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    z -= 10e-3 * kT;
    ASSERT_TRUE(controller.Step(At(z, -0.01, 100.0, 0.25)).f.isZero(0.0));
    ASSERT_GE(controller.energy_J(), -0.27 - 1e-12);
  }
  EXPECT_NEAR(controller.energy_J(), -0.27, 1e-12) << "what the spring holds, and the allowance";
  // 100 N push it out: after 0.27 J, 2.7 mm, it has given more than it ever stored
  double out_m = 0.0;
  while (!controller.acted() && out_m < 0.1) {
    z += 20e-3 * kT;
    out_m += 20e-3 * kT;
    static_cast<void>(controller.Step(At(z, 0.02, 100.0, 0.25 - 50.0 * out_m)));
  }
  EXPECT_LT(out_m, 2.8e-3);
}

TEST(Passivity, TakesBackWhatWasMadeInOneTickWhereBoundsAllow) {
  PassivityController controller({.allowance_J = 0.0}, PortWork::kTrapezoid, kT, 1e6);
  static_cast<void>(controller.Step(At(0.0, 0.1, 10.0, 0.0)));
  const Wrench F = controller.Step(At(0.1e-3, 0.1, 10.0, 0.0));  // 1 mJ made
  EXPECT_NEAR(controller.energy_J(), 1e-3, 1e-12);
  EXPECT_NEAR(-F.f.z() * 0.1 * kT, 1e-3, 1e-12) << "power of the damping, over a tick";
  // the tool keeps its motion: the damping takes the energy
  static_cast<void>(controller.Step(At(0.2e-3, 0.1, 0.1, 0.0)));
  EXPECT_NEAR(controller.energy_J(), 0.5 * 10.1 * 0.1e-3, 1e-12) << "and what was made since";
}

// A tank pays for returning planes: energy that it paid does not count as generated, any excess does.
TEST(Passivity, EnergyThatATankHasPaidForMayComeOut) {
  for (const double paid_J : {0.0, 2e-3}) {
    PassivityController controller({.allowance_J = 0.0}, PortWork::kTrapezoid, kT, 1e6);
    static_cast<void>(controller.Step(At(0.0, 0.1, 10.0, 0.0)));
    PortTick port = At(0.0, 0.1, 10.0, 2e-3);
    port.paid_J = paid_J;
    static_cast<void>(controller.Step(port));
    static_cast<void>(controller.Step(At(0.1e-3, 0.1, 10.0, 1e-3)));  // 1 mJ comes out
    EXPECT_EQ(controller.acted(), paid_J == 0.0);
    static_cast<void>(controller.Step(At(0.35e-3, 0.1, 10.0, 0.0)));  // 3.5 mJ
    EXPECT_TRUE(controller.acted());
  }
}

TEST(Passivity, DoesNotActNearRestAndKeepsTheEnergyForLater) {
  PassivityController controller({.allowance_J = 0.0, .min_speed_m_per_s = 0.005}, PortWork::kTrapezoid, kT,
                                 1e6);
  static_cast<void>(controller.Step(At(0.0, 0.004, 100.0, 0.0)));
  EXPECT_TRUE(controller.Step(At(4e-6, 0.004, 100.0, 0.0)).f.isZero(0.0));
  EXPECT_NEAR(controller.energy_J(), 4e-4, 1e-12);
  static_cast<void>(controller.Step(At(8e-6, 0.006, 100.0, 0.0)));
  EXPECT_TRUE(controller.acted());
  // contact ends: E starts again at 0
  static_cast<void>(controller.Step(At(1e-3, 0.1, 0.0, 0.0)));
  EXPECT_EQ(controller.energy_J(), 0.0);
  EXPECT_FALSE(controller.acted());
}

TEST(Passivity, DampingNeverTurnsTheMotionRoundWithinATick) {
  const AdmittanceParams law;
  PassivityController controller({.allowance_J = 0.0, .max_damping_Ns_per_m = 1e5}, PortWork::kTrapezoid, kT,
                                 law.mass_kg.x() / kT);
  AdmittanceState tool;
  tool.V_WT.v << 0.1, -0.05, 0.02;
  tool.V_WT.w << 0.3, 0.2, 0.0;
  const Twist before = tool.V_WT;
  PortTick port{.F_T_W = {.f = 1e6 * Vector3(1, 1, 1), .t = {}}, .contact = true};
  static_cast<void>(controller.Step(port));
  port.X_WT.translation().setConstant(1e-3);
  port.V_WT = tool.V_WT;
  const Wrench F = controller.Step(port);  // kilojoules
  ASSERT_TRUE(StepAdmittance(law, F, kT, tool));
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(tool.V_WT.v[i] * before.v[i], -1e-12);
    EXPECT_GE(tool.V_WT.w[i] * before.w[i], -1e-12);
  }
}

TEST(Passivity, OtherGainsKeepTheUsersBound) {
  PassivityController controller({.allowance_J = 0.0, .max_damping_Ns_per_m = 50.0}, PortWork::kTrapezoid, kT,
                                 1e4);
  controller.SetMaxDamping(1e4);
  static_cast<void>(controller.Step(At(0.0, 0.1, 1000.0, 0.0)));
  static_cast<void>(controller.Step(At(1e-3, 0.1, 1000.0, 0.0)));  // 1 J made: 100 kN s/m would take it back
  EXPECT_EQ(controller.damping_Ns_per_m(), 50.0);
  controller.SetMaxDamping(20.0);
  static_cast<void>(controller.Step(At(2e-3, 0.1, 1000.0, 0.0)));
  EXPECT_EQ(controller.damping_Ns_per_m(), 20.0);
}

TEST(Passivity, CountsWhatALaterLimitLetThrough) {
  PassivityController half({.acts = false, .allowance_J = 10.0}, PortWork::kTrapezoid, kT, 1e4);
  PassivityController port_of_half({.acts = false, .allowance_J = 10.0}, PortWork::kTrapezoid, kT, 1e4);
  for (int i = 0; i < 20; ++i) {
    static_cast<void>(half.Step(At(1e-3 * i, 0.1, 80.0, 0.0)));
    half.ScaleRendered(0.5);
    static_cast<void>(port_of_half.Step(At(1e-3 * i, 0.1, 40.0, 0.0)));
    EXPECT_NEAR(half.energy_J(), port_of_half.energy_J(), 1e-12) << i;
  }
  EXPECT_GT(half.energy_J(), 0.5);
}

TEST(Passivity, DoesNotAllocate) {
  PassivityController controller({}, PortWork::kTrapezoid, kT, 1e3);
  rt::CheckedNoAllocScope no_alloc;
  for (int i = 0; i < 10; ++i) static_cast<void>(controller.Step(At(1e-4 * i, 0.1, 100.0, 0.0)));
}

TEST(Passivity, RefusesParametersOutOfRange) {
  EXPECT_THROW(PassivityController({.allowance_J = -1.0}, PortWork::kHeld, kT, 1.0), std::invalid_argument);
  EXPECT_THROW(PassivityController({.min_speed_m_per_s = 0.0}, PortWork::kHeld, kT, 1.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
