#include "control/stability/passivity.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "control/laws/admittance_law.h"
#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::control {
namespace {

constexpr double kT = 1e-3;  // period of a tick [s]
constexpr double kK = 20e3;  // stiffness of the spring [N/m]

// The values at the coupling's port in one tick of a motion along z. A force above 0 counts as contact.
PortTick PortAt(double z_m, double v_m_per_s, double force_N, double potential_J) {
  PortTick port{.F_T_W = {.f = force_N * Vector3::UnitZ(), .t = Vector3::Zero()},
                .potential_J = potential_J,
                .contact = force_N > 0.0};
  port.X_WT.translation().z() = z_m;
  port.V_WT.v.z() = v_m_per_s;
  return port;
}

// A tool swings on a spring, moved by the shipped law in all six axes. A spring generates no energy, and the
// sum by the trapezoidal rule must find none. Forces that are held constant for a tick do generate energy,
// and the sum for held forces must find it.
TEST(Passivity, ASpringMakesNoEnergyByTheTrapezoidAndSomeByHeldForces) {
  PassivityParams params{.acts = false, .allowance_J = 0.0};
  PassivityController trapezoid(params, PortWork::kTrapezoid, kT, 1e6),
      held(params, PortWork::kHeld, kT, 1e6);
  AdmittanceParams law;
  law.damping_Ns_per_m.setConstant(1e-9);
  law.damping_Nms_per_rad.setConstant(1e-9);
  AdmittanceState tool;
  tool.X_WT.translation().z() = -2e-3;
  double max_J = 0.0, held_J = 0.0, stored_J = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3 d = tool.X_WT.translation();
    const Vector3 turn = LogRotation(tool.X_WT.linear());
    const Wrench F{.f = -kK * (d + Vector3(0, 0, 3e-3)), .t = -20.0 * turn + Vector3(0.02, 0, 0)};
    // the stored energy is so large that the controller forgets no dissipated energy
    const PortTick port{
        .F_T_W = F, .potential_J = 1e3, .contact = true, .X_WT = tool.X_WT, .V_WT = tool.V_WT};
    static_cast<void>(trapezoid.Step(port));
    static_cast<void>(held.Step(port));
    stored_J = std::max(stored_J, 0.5 * kK * (d + Vector3(0, 0, 3e-3)).squaredNorm());
    max_J = std::max(max_J, trapezoid.energy_J());
    held_J = std::max(held_J, held.energy_J());
    ASSERT_TRUE(StepAdmittance(law, F, kT, tool));
  }
  // at most the energy of the spring's initial stretch of 1 mm (10 mJ) plus the energy of the torque
  EXPECT_LT(max_J, 0.0101);
  EXPECT_GT(held_J, 0.1) << "K v^2 T^2 / 2 a tick";
}

TEST(Passivity, EnergyDissipatedLongAgoDoesNotHideEnergyMadeNow) {
  PassivityController controller({.allowance_J = 0.02}, PortWork::kTrapezoid, kT, 1e6);
  // a minute of cutting: 100 N act against a motion of 10 mm/s, which dissipates 1 W
  double z = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    z -= 10e-3 * kT;
    ASSERT_TRUE(controller.Step(PortAt(z, -0.01, 100.0, 0.25)).f.isZero(0.0));
    ASSERT_GE(controller.energy_J(), -0.27 - 1e-12);
  }
  EXPECT_NEAR(controller.energy_J(), -0.27, 1e-12) << "what the spring holds, and the allowance";
  // then 100 N push the tool out. After 2.7 mm the coupling has given 0.27 J, the most that may come back
  double out_m = 0.0;
  while (!controller.acted() && out_m < 0.1) {
    z += 20e-3 * kT;
    out_m += 20e-3 * kT;
    static_cast<void>(controller.Step(PortAt(z, 0.02, 100.0, 0.25 - 50.0 * out_m)));
  }
  EXPECT_LT(out_m, 2.8e-3);
}

TEST(Passivity, DissipatesGeneratedEnergyWithinOneTick) {
  PassivityController controller({.allowance_J = 0.0}, PortWork::kTrapezoid, kT, 1e6);
  static_cast<void>(controller.Step(PortAt(0.0, 0.1, 10.0, 0.0)));
  const Wrench F = controller.Step(PortAt(0.1e-3, 0.1, 10.0, 0.0));  // 1 mJ generated
  EXPECT_NEAR(controller.energy_J(), 1e-3, 1e-12);
  EXPECT_NEAR(-F.f.z() * 0.1 * kT, 1e-3, 1e-12) << "power of the damping, over a tick";
  // the tool keeps its speed, so the damping has taken out the energy
  static_cast<void>(controller.Step(PortAt(0.2e-3, 0.1, 0.1, 0.0)));
  EXPECT_NEAR(controller.energy_J(), 0.5 * 10.1 * 0.1e-3, 1e-12) << "and what was made since";
}

// A tank has paid energy into the planes. When this energy comes out, it must not count as generated. Any
// energy beyond it must count.
TEST(Passivity, EnergyThatATankHasPaidForMayComeOut) {
  for (const double paid_J : {0.0, 2e-3}) {
    PassivityController controller({.allowance_J = 0.0}, PortWork::kTrapezoid, kT, 1e6);
    static_cast<void>(controller.Step(PortAt(0.0, 0.1, 10.0, 0.0)));
    PortTick port = PortAt(0.0, 0.1, 10.0, 2e-3);
    port.paid_J = paid_J;
    static_cast<void>(controller.Step(port));
    static_cast<void>(controller.Step(PortAt(0.1e-3, 0.1, 10.0, 1e-3)));  // 1 mJ comes out in all
    EXPECT_EQ(controller.acted(), paid_J == 0.0);
    static_cast<void>(controller.Step(PortAt(0.35e-3, 0.1, 10.0, 0.0)));  // 3.5 mJ come out in all
    EXPECT_TRUE(controller.acted());
  }
}

TEST(Passivity, DoesNotActNearRestAndKeepsTheEnergyForLater) {
  PassivityController controller({.allowance_J = 0.0, .min_speed_m_per_s = 0.005}, PortWork::kTrapezoid, kT,
                                 1e6);
  static_cast<void>(controller.Step(PortAt(0.0, 0.004, 100.0, 0.0)));
  EXPECT_TRUE(controller.Step(PortAt(4e-6, 0.004, 100.0, 0.0)).f.isZero(0.0));
  EXPECT_NEAR(controller.energy_J(), 4e-4, 1e-12);
  static_cast<void>(controller.Step(PortAt(8e-6, 0.006, 100.0, 0.0)));
  EXPECT_TRUE(controller.acted());
  // the contact ends, so the energy sum starts again at 0
  static_cast<void>(controller.Step(PortAt(1e-3, 0.1, 0.0, 0.0)));
  EXPECT_EQ(controller.energy_J(), 0.0);
  EXPECT_FALSE(controller.acted());
}

TEST(Passivity, DampingNeverReversesTheMotionWithinATick) {
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
  const Wrench F = controller.Step(port);  // 3 kJ generated, so the damping is at its bound
  ASSERT_TRUE(StepAdmittance(law, F, kT, tool));
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(tool.V_WT.v[i] * before.v[i], -1e-12);
    EXPECT_GE(tool.V_WT.w[i] * before.w[i], -1e-12);
  }
}

TEST(Passivity, TheSmallerOfLawsAndUsersDampingBoundHolds) {
  PassivityController controller({.allowance_J = 0.0, .max_damping_Ns_per_m = 50.0}, PortWork::kTrapezoid, kT,
                                 1e4);
  controller.SetMaxDamping(1e4);
  static_cast<void>(controller.Step(PortAt(0.0, 0.1, 1000.0, 0.0)));
  static_cast<void>(controller.Step(PortAt(
      1e-3, 0.1, 1000.0, 0.0)));  // 1 J generated: a damping of 100 kN s/m would be needed to take it out
  EXPECT_EQ(controller.damping_Ns_per_m(), 50.0);
  controller.SetMaxDamping(20.0);
  static_cast<void>(controller.Step(PortAt(2e-3, 0.1, 1000.0, 0.0)));
  EXPECT_EQ(controller.damping_Ns_per_m(), 20.0);
}

TEST(Passivity, CountsOnlyTheForceThatALaterLimitPasses) {
  PassivityController scaled({.acts = false, .allowance_J = 10.0}, PortWork::kTrapezoid, kT, 1e4);
  PassivityController of_half_force({.acts = false, .allowance_J = 10.0}, PortWork::kTrapezoid, kT, 1e4);
  for (int i = 0; i < 20; ++i) {
    static_cast<void>(scaled.Step(PortAt(1e-3 * i, 0.1, 80.0, 0.0)));
    scaled.ScaleRendered(0.5);
    static_cast<void>(of_half_force.Step(PortAt(1e-3 * i, 0.1, 40.0, 0.0)));
    EXPECT_NEAR(scaled.energy_J(), of_half_force.energy_J(), 1e-12) << i;
  }
  EXPECT_GT(scaled.energy_J(), 0.5);
}

TEST(Passivity, DoesNotAllocate) {
  PassivityController controller({}, PortWork::kTrapezoid, kT, 1e3);
  rt::CheckedNoAllocScope no_alloc;
  for (int i = 0; i < 10; ++i) static_cast<void>(controller.Step(PortAt(1e-4 * i, 0.1, 100.0, 0.0)));
}

TEST(Passivity, RefusesParametersOutOfRange) {
  EXPECT_THROW(PassivityController({.allowance_J = -1.0}, PortWork::kHeld, kT, 1.0), std::invalid_argument);
  EXPECT_THROW(PassivityController({.min_speed_m_per_s = 0.0}, PortWork::kHeld, kT, 1.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
