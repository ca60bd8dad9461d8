// The passivity controller at walls whose force is 5 ms old. One wall is softer and one stiffer than the
// stability limit. The simulation uses the shipped law, arm and stabilisers.

#include <cmath>
#include <deque>
#include <limits>

#include <gtest/gtest.h>

#include "control/coupling/virtual_coupling.h"
#include "control/laws/admittance_law.h"
#include "control/stability/passivity.h"
#include "hil/loops/admittance_loop.h"

namespace osteon::studies {
namespace {

// The loop of a light hand. Its stiffest stable wall is 2.9 kN/m (docs/theory/stabilisers.md). A prototype,
// which computed the hand's acceleration differently, had 3.3 kN/m.
hil::AdmittanceLoopParams OldWall(double stiffness_N_per_m) {
  hil::AdmittanceLoopParams loop;
  loop.hand = {"light", 100.0, 4.0, 0.3};
  loop.mass_kg = 3.0;
  loop.damping_Ns_per_m = 8.0;
  loop.wall = {.stiffness_N_per_m = stiffness_N_per_m, .on = hil::WallOn::kCommanded, .age_ticks = 5};
  return loop;
}

/// Figures of a run at the wall.
struct Ripple {
  double rms_N{0.0};   ///< RMS of the wall's force about its mean, in the run's second half
  double peak_N{0.0};  ///< largest force of the wall, over the whole run
  int acted{0};        ///< ticks in which the controller acted
};

// Presses the tool with 40 N onto the wall for 4 s, from 2 mm above the wall. The wall's force is that of the
// pose 5 ms before. @param acts  whether the passivity controller acts
Ripple Press(const hil::AdmittanceLoopParams& p, bool acts) {
  constexpr double kPress_N = 40.0;
  const double T = p.period_s;
  control::AdmittanceParams law;
  law.mass_kg.setConstant(p.mass_kg);
  law.damping_Ns_per_m.setConstant(p.damping_Ns_per_m);
  control::CouplingParams coupling;
  coupling.max_stiffness_N_per_m = p.wall.stiffness_N_per_m;
  coupling.damping_Ns_per_m = 0.0;
  control::CouplingState coupling_state;
  coupling_state.fade = 1.0;
  simulation::ContactModel wall;
  wall.contact_count = 1;
  wall.contacts[0].n_W = Vector3(0, 0, 1);
  wall.contacts[0].stiffness_N_per_m = p.wall.stiffness_N_per_m;
  control::PassivityController controller({.acts = acts}, control::PortWork::kTrapezoid, T, p.mass_kg / T);

  std::array<kinematics::JointLimits, 7> unlimited;
  for (kinematics::JointLimits& limits : unlimited)
    limits.velocity_rad_per_s = std::numeric_limits<double>::max();
  constexpr double kFrom_m = 2e-3;
  hil::ServoArm arm(p.arm, unlimited, T, kinematics::JointVector::Constant(kFrom_m));
  double before_m_per_s = 0.0;
  std::deque<double> felt(static_cast<std::size_t>(p.sensor_delay) + 1, 0.0);
  control::AdmittanceState tool;
  tool.X_WT.translation().z() = kFrom_m;
  std::deque<control::AdmittanceState> past(static_cast<std::size_t>(p.wall.age_ticks) + 1, tool);

  Ripple ripple;
  double sum = 0.0, squares = 0.0;
  constexpr int kTicks = 4000;
  for (int k = 0; k < kTicks; ++k) {
    const double x = arm.q()[0], v = arm.qd()[0];
    const double a = (v - before_m_per_s) / T;
    before_m_per_s = v;
    felt.push_front(-(p.hand.stiffness_N_per_m * x + p.hand.damping_Ns_per_m * v + p.hand.mass_kg * a));
    felt.pop_back();

    past.push_front(tool);
    past.pop_back();
    const rt::Nanoseconds now = (k + 1000) * rt::kMillisecond;
    wall.frame = static_cast<std::uint64_t>(k + 1);
    wall.pose_stamp = now;
    const control::CouplingOutput out = control::EvaluateCoupling(
        coupling, {.model = wall, .X_WT = past.back().X_WT, .V_WT = past.back().V_WT, .now = now},
        coupling_state);
    const Wrench damping = controller.Step({.F_T_W = out.F_contact_T_W,
                                            .potential_J = out.potential_J,
                                            .contact = out.active_count > 0,
                                            .X_WT = tool.X_WT,
                                            .V_WT = tool.V_WT});
    if (controller.acted()) ++ripple.acted;
    const double wall_N = out.F_T_W.f.z() + damping.f.z();
    const Wrench F{.f = Vector3(0, 0, felt.back() - kPress_N + wall_N), .t = Vector3::Zero()};
    if (!control::StepAdmittance(law, F, T, tool)) break;
    arm.Step(kinematics::JointVector::Constant(tool.X_WT.translation().z()));
    ripple.peak_N = std::max(ripple.peak_N, wall_N);
    if (k >= kTicks / 2) {
      sum += wall_N;
      squares += wall_N * wall_N;
    }
  }
  const double mean = sum / (kTicks / 2);
  ripple.rms_N = std::sqrt(std::max(0.0, squares / (kTicks / 2) - mean * mean));
  return ripple;
}

TEST(PassivityWall, AForce5MillisecondsOldIsStableUpTo2900NewtonsPerMetre) {
  EXPECT_NEAR(hil::MaxWallStiffness(OldWall(1e3)).value, 2880.0, 15.0);
}

TEST(PassivityWall, TheControllerCalmsAWallThatIsTooStiff) {
  const Ripple without = Press(OldWall(5000.0), false), with = Press(OldWall(5000.0), true);
  RecordProperty("ripple_without_N", std::to_string(without.rms_N));
  RecordProperty("ripple_with_N", std::to_string(with.rms_N));
  RecordProperty("first_impact_N", std::to_string(without.peak_N) + " and " + std::to_string(with.peak_N));
  EXPECT_GT(without.rms_N, 20.0);
  EXPECT_LT(with.rms_N, 4.0);
  EXPECT_GT(with.acted, 0);
}

TEST(PassivityWall, TheControllerDoesNoHarmOnStableWallsAndNeverActsOnFreshPlanes) {
  EXPECT_LE(Press(OldWall(1500.0), true).rms_N, Press(OldWall(1500.0), false).rms_N + 0.1)
      << "stable by itself: no worse with it";
  hil::AdmittanceLoopParams fresh = OldWall(20e3);
  fresh.wall.age_ticks = 0;
  EXPECT_EQ(Press(fresh, true).acted, 0) << "planes that are evaluated in the tick";
}

}  // namespace
}  // namespace osteon::studies
