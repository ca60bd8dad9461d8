#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/simulation/engine/engine_bench.h"

// Tests of the edges' own force on every engine: below this force nothing is cut, and energy balance,
// independence of the frame rate and limits are as without an edge force.

namespace osteon::simulation {
namespace {

using EngineEdge = Engine;
OSTEON_ON_EVERY_ENGINE(EngineEdge);

/// A slab in which, at a chip of 0.05 mm, the edge force takes `share` of the cutting energy.
Bone EdgeSlab(double width_m, double thickness_m, double share) {
  Bone bone = Slab(width_m, thickness_m);
  bone.materials[0].measured_chip_m = 50e-6;
  bone.materials[0].edge_force_N_per_m = share * kSpongy * 50e-6;
  return bone;
}
/// A cutting ball with two edges.
Tool TwoEdges(double radius_m) {
  Tool tool = BallTool(radius_m);
  tool.balls[0].edges = 2;
  return tool;
}

// The tool is pressed with 10 N, 0.5 mm deep. Its edges need z edge_force A / (2 pi mu_c r), where r is 2/3
// of the radius of the engaged disc: more than 10 N for a share of 0.9, less for 0.1.
TEST_P(EngineEdge, AnEdgeRubsBelowItsForceAndCutsAboveIt) {
  const double R = 8e-3;
  const auto rubs = Make(EdgeSlab(18e-3, 4e-3, 0.9), TwoEdges(R), {.edge_force = true}),
             cuts = Make(EdgeSlab(18e-3, 4e-3, 0.1), TwoEdges(R), {.edge_force = true});
  ContactModel rubbing, cutting;
  for (CuttingEngine* engine : {rubs.get(), cuts.get()})
    engine->Step(At(Down({0, 0, 0.1e-3}), kSpindle_rad_per_s));
  for (int i = 0; i < 300; ++i) {
    rubbing = rubs->Step(At(Down({0, 0, -0.5e-3}), kSpindle_rad_per_s));
    cutting = cuts->Step(At(Down({0, 0, -0.5e-3}), kSpindle_rad_per_s));
  }
  EXPECT_EQ(rubbing.removed_volume_m3, 0.0);
  EXPECT_EQ(rubbing.advance_m_per_s, 0.0);
  EXPECT_NEAR(rubbing.F_T_W.f.z, 10.0, 0.8) << "what presses is felt";
  // the spindle's torque is mu_c F at the mean distance of a disc's points from its centre
  const double arm = 2.0 / 3.0 * std::sqrt(rubbing.engaged_area_m2 / M_PI);
  EXPECT_NEAR(rubbing.spindle_torque_Nm, 0.8 * rubbing.F_T_W.f.z * arm, 0.15 * 0.8 * 10.0 * arm);
  EXPECT_NEAR(rubbing.cutting_work_J, rubbing.spindle_torque_Nm * kSpindle_rad_per_s * 0.3,
              0.15 * rubbing.cutting_work_J);
  EXPECT_GT(cutting.removed_volume_m3, 0.0);
  EXPECT_LT(cutting.F_T_W.f.z, 9.0);
}

// Bit for bit, the edge force has no effect if it is switched off or the tool's number of edges is not given.
TEST_P(EngineEdge, WithoutTheSwitchOrTheToolsEdgesItHasNoEffect) {
  const double R = 8e-3;
  const auto plain = Make(Slab(18e-3, 4e-3), BallTool(R)),
             off = Make(EdgeSlab(18e-3, 4e-3, 0.5), TwoEdges(R)),
             uncounted = Make(EdgeSlab(18e-3, 4e-3, 0.5), BallTool(R), {.edge_force = true});
  for (int i = 0; i < 200; ++i) {
    const FrameInput input = At(Down({2e-6 * i, 0, 0.1e-3 - 8e-6 * i}), kSpindle_rad_per_s);
    const ContactModel a = plain->Step(input), b = off->Step(input), c = uncounted->Step(input);
    ASSERT_EQ(a.removed_volume_m3, b.removed_volume_m3) << i;
    ASSERT_EQ(a.spindle_torque_Nm, b.spindle_torque_Nm) << i;
    ASSERT_EQ(a.F_T_W.f.z, b.F_T_W.f.z) << i;
    ASSERT_EQ(a.removed_volume_m3, c.removed_volume_m3) << i;
    ASSERT_EQ(a.F_T_W.f.z, c.F_T_W.f.z) << i;
  }
  EXPECT_EQ(HashState(plain->Snapshot()), HashState(off->Snapshot()));
  EXPECT_EQ(HashState(plain->Snapshot()), HashState(uncounted->Snapshot()));
}

TEST_P(EngineEdge, TheDrivesWorkIsTheSumOfCuttingAndPloughing) {
  const auto engine = Make(EdgeSlab(24e-3, 6e-3, 0.3), TwoEdges(8e-3), {.edge_force = true});
  const double dt = 4e-3;
  double drive_J = 0.0;
  ContactModel model = engine->Step(At(Down({-3e-3, 0, 0.2e-3}), kSpindle_rad_per_s, dt));
  for (int i = 0; i < 1000; ++i) {
    const double t = i * dt;
    const Vector3 p(-3e-3 + 2e-3 * std::max(0.0, t - 1.0), 0, 0.2e-3 - 3e-3 * std::min(t, 1.5));
    model = engine->Step(At(Down(p), kSpindle_rad_per_s, dt));
    drive_J += model.spindle_torque_Nm * kSpindle_rad_per_s * dt;
  }
  const double chips_J = 0.7 * kSpongy * model.removed_volume_m3;
  std::printf("drive %.3f J, chips %.3f J, ploughing %.3f J\n", drive_J, chips_J,
              model.cutting_work_J - chips_J);
  EXPECT_GT(chips_J, 1.0);
  EXPECT_GT(model.cutting_work_J, 1.1 * chips_J);
  EXPECT_NEAR(drive_J, model.cutting_work_J, 0.05 * model.cutting_work_J);
}

TEST_P(EngineEdge, ForceAndVolumeDoNotDependOnTheFrameRate) {
  // down at 2.5 mm/s and along at 1.5 mm/s; force: mean over the second half
  const auto plunge = [](double dt_s) {
    const auto engine = Make(EdgeSlab(22e-3, 5e-3, 0.3), TwoEdges(8e-3), {.edge_force = true});
    const int frames = static_cast<int>(std::lround(1.2 / dt_s));
    double impulse_Ns = 0.0;
    ContactModel model = engine->Step(At(Down({-1e-3, 0, 0.2e-3}), kSpindle_rad_per_s, dt_s));
    for (int i = 1; i <= frames; ++i) {
      const double t = i * dt_s;
      model = engine->Step(At(Down({-1e-3 + 1.5e-3 * t, 0, 0.2e-3 - 2.5e-3 * t}), kSpindle_rad_per_s, dt_s));
      if (2 * i > frames) impulse_Ns += Vector3(model.F_T_W.f).norm() * dt_s;
    }
    return std::pair(impulse_Ns / 0.6, model.removed_volume_m3);
  };
  const auto [force_N, volume_m3] = plunge(1e-3);
  const auto [slow_N, slow_m3] = plunge(4e-3);
  std::printf("1 kHz: %.3f N, %.2f mm^3; 250 Hz: %.3f N, %.2f mm^3\n", force_N, 1e9 * volume_m3, slow_N,
              1e9 * slow_m3);
  EXPECT_GT(volume_m3, 10e-9);
  EXPECT_NEAR(slow_N, force_N, 0.02 * force_N);
  EXPECT_NEAR(slow_m3, volume_m3, 0.02 * volume_m3);
}

TEST_P(EngineEdge, ClosedCyclesNeverReturnEnergyAndTheForceStaysBelowItsLimit) {
  const CuttingParams params{.max_force_N = 15.0, .edge_force = true};
  const auto engine = Make(EdgeSlab(16e-3, 4e-3, 0.1), TwoEdges(6e-3), params);
  Vector3 p(0, 0, 0.5e-3), f = Vector3::Zero();
  engine->Step(At(Down(p), kSpindle_rad_per_s));
  double work_J = 0.0, max_N = 0.0;
  for (int cycle = 0; cycle < 10; ++cycle) {
    for (int i = 1; i <= 60; ++i) {
      const double phase = 2.0 * M_PI * i / 60.0;
      const Vector3 next(0.5e-3 * std::sin(phase), 0.3e-3 * std::sin(2 * phase),
                         -0.5e-3 + 1.0e-3 * std::cos(phase));
      const ContactModel model = engine->Step(At(Down(next), cycle % 2 == 0 ? kSpindle_rad_per_s : 0.0));
      work_J -= 0.5 * (f + Vector3(model.F_T_W.f)).dot(next - p);
      f = model.F_T_W.f;
      p = next;
      max_N = std::max(max_N, f.norm());
    }
    EXPECT_GE(work_J, -1e-4) << cycle;  // tolerance for the trapezoidal rule
  }
  EXPECT_GT(max_N, 10.0);
  EXPECT_LE(max_N, 15.0 + 1e-9);
}

}  // namespace
}  // namespace osteon::simulation
