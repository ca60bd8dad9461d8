#include <cmath>

#include <gtest/gtest.h>

#include "simulation/engine/frame_solution.h"

// Tests of the cutting edges' own force (ploughing force) in the rate law: below this force the edge only
// rubs, above it the edge cuts.

namespace osteon::simulation {
namespace {

constexpr double kSpindle = 250.0 * 2.0 * M_PI / 60.0;  // 250 rpm in rad/s

// A cut pressed with 40 N (2 mm at the coupling's stiffness of 20 N/mm). The edges' own force F_e is 12 N:
// F_e = z edge_force A / (2 pi mu_c r), with A, r and mu_c as set below.
struct EdgeCut {
  static constexpr double kEdge_N = 12.0;
  CuttingParams params{.edge_force = true};
  std::vector<Material> materials{{.name = "bone", .specific_cutting_energy_J_per_m3 = 50e6}};
  FrameSolution solution;
  EdgeCut() {
    solution.n = Vector3::UnitZ();
    solution.cutting_m = 2e-3;
    solution.engaged_area_m2[0] = 500e-6;
    solution.engaged_moment_m3[0] = 500e-6 * 15e-3;
    materials[0].edge_force_N_per_m = kEdge_N * 2.0 * M_PI * 0.8 * 15e-3 / 500e-6;
  }
  // The same cut pressed with another force.
  [[nodiscard]] EdgeCut Pressed(double force_N) const {
    EdgeCut cut = *this;
    cut.solution.cutting_m = force_N / params.stiffness_N_per_m;
    return cut;
  }
  [[nodiscard]] EdgeCut WithoutEdge() const {
    EdgeCut cut = *this;
    cut.materials[0].edge_force_N_per_m = 0.0;
    return cut;
  }
  [[nodiscard]] FrameAdvance Advance(double dt_s, double spindle = kSpindle,
                                     double energy_lead_J = 0.0) const {
    return ComputeAdvance(params, materials, solution, spindle, dt_s, energy_lead_J);
  }
};

TEST(EdgeForce, BelowTheEdgeForceNothingIsCutAndTheSpindleStillDoesWork) {
  const double dt = 1e-3;
  for (const double force_N : {0.1, 6.0, 11.999}) {
    const FrameAdvance rubs = EdgeCut().Pressed(force_N).Advance(dt);
    EXPECT_EQ(rubs.advance_m, 0.0) << force_N;
    EXPECT_EQ(rubs.edge_work_J, 0.0);
    EXPECT_NEAR(rubs.ploughing_work_J, force_N * 0.8 * 15e-3 * kSpindle * dt, 1e-12);
  }
}

TEST(EdgeForce, AboveTheEdgeForceTheAdvanceIsTheExactSolution) {
  const EdgeCut cut;
  // x' = -c (K x - F_e): the part of the depth x beyond F_e / K decays exponentially
  const double c = 0.8 * 15e-3 * kSpindle / (50e6 * 500e-6), beyond_m = (40.0 - EdgeCut::kEdge_N) / 20e3;
  for (const double dt : {1e-5, 1e-3, 4e-3}) {
    const double expected = beyond_m * (1.0 - std::exp(-c * 20e3 * dt));
    EXPECT_NEAR(cut.Advance(dt).advance_m, expected, 1e-9 * expected) << dt;
  }
}

TEST(EdgeForce, TwoHalfStepsEqualOneStep) {
  for (const double dt : {1e-4, 1e-3, 10e-3}) {
    EdgeCut cut;
    cut.params.max_slide_m = 1.0;
    const double whole = cut.Advance(dt).advance_m, first = cut.Advance(0.5 * dt).advance_m;
    cut.solution.cutting_m -= first;
    EXPECT_NEAR(first + cut.Advance(0.5 * dt).advance_m, whole, 1e-9 * whole) << dt;
  }
}

// As the force grows, the advance must never fall or jump. It must be at most the advance without an edge
// force.
TEST(EdgeForce, TheAdvanceGrowsContinuouslyAndNeverExceedsThatWithoutEdgeForce) {
  EdgeCut edge;
  edge.params.max_slide_m = 1.0;
  for (const double energy_lead_J : {0.0, 1e-3}) {
    double before_m = 0.0;
    for (int i = 1; i <= 2500; ++i) {  // 2500 steps go beyond the force limit of 200 N
      const EdgeCut cut = edge.Pressed(0.1 * i);
      const double advance_m = cut.Advance(1e-3, kSpindle, energy_lead_J).advance_m;
      ASSERT_GE(advance_m, before_m) << i;
      ASSERT_LT(advance_m - before_m, 1e-6) << i;
      ASSERT_LE(advance_m, cut.solution.cutting_m) << i;
      ASSERT_LE(advance_m, cut.WithoutEdge().Advance(1e-3, kSpindle, energy_lead_J).advance_m) << i;
      before_m = advance_m;
    }
    EXPECT_GT(before_m, 1e-6);
  }
}

TEST(EdgeForce, TheSpindlesWorkIsTheSumOfCuttingAndPloughingWork) {
  const double dt = 1e-9;  // so short that the force does not fall
  const FrameAdvance frame = EdgeCut().Advance(dt);
  EXPECT_NEAR((frame.edge_work_J + frame.ploughing_work_J) / (kSpindle * dt), 0.8 * 40.0 * 15e-3, 1e-6);
  EXPECT_NEAR(frame.ploughing_work_J / frame.edge_work_J, 12.0 / 28.0, 1e-6);
  EXPECT_NEAR(frame.edge_work_J, 50e6 * 500e-6 * frame.advance_m, 1e-12);
}

// The force on an edge depends on the chip's thickness alone: F = (u / mu) (h + edge_force / u) b. At equal
// force the advance for each turn is therefore constant: four times the speed gives four times the advance.
TEST(EdgeForce, AtEqualForceTheAdvanceIsProportionalToTheSpindlesSpeed) {
  const EdgeCut cut;
  const double slow = cut.Advance(1e-9, kSpindle).advance_m,
               fast = cut.Advance(1e-9, 4.0 * kSpindle).advance_m;
  EXPECT_NEAR(fast, 4.0 * slow, 1e-6 * fast);
}

TEST(EdgeForce, DoesNoWorkForTheImmediateLawAStillSpindleOrFreeMotion) {
  EdgeCut cut;
  EXPECT_EQ(cut.Advance(1e-3, 0.0).ploughing_work_J, 0.0);
  EXPECT_EQ(cut.Advance(0.0).ploughing_work_J, 0.0);
  EXPECT_EQ(cut.Pressed(0.0).Advance(1e-3).ploughing_work_J, 0.0);
  cut.params.law = RemovalLaw::kImmediate;
  EXPECT_EQ(cut.Advance(1e-3).ploughing_work_J, 0.0);
  EXPECT_EQ(cut.Advance(1e-3).advance_m, cut.solution.cutting_m);
}

// The edge force acts only if it is switched on, the tool's cutting balls state their number of edges, and
// the material has a figure. The shaft's number of edges does not count.
TEST(EdgeForce, NeedsTheSwitchTheToolsEdgesAndTheMaterialsFigure) {
  Bone bone;
  bone.materials = {{.name = "a", .specific_cutting_energy_J_per_m3 = 50e6}, {.name = "b"}};
  bone.materials[0].edge_force_N_per_m = 1e3;
  bone.materials[0].measured_chip_m = 50e-6;
  Tool tool;
  tool.balls = {{.radius_m = 1e-3, .edges = 3}, {.radius_m = 1e-3, .cutting = false, .edges = 9}};
  CuttingParams params;
  const auto off = MaterialsUnderTool(bone, tool, params);
  EXPECT_EQ(off[0].edge_force_N_per_m, 0.0);
  EXPECT_EQ(off[0].specific_cutting_energy_J_per_m3, 50e6);
  params.edge_force = true;
  const auto on = MaterialsUnderTool(bone, tool, params);
  EXPECT_EQ(on[0].edge_force_N_per_m, 3e3);
  EXPECT_DOUBLE_EQ(on[0].specific_cutting_energy_J_per_m3, 50e6 - 1e3 / 50e-6);
  EXPECT_EQ(on[1].edge_force_N_per_m, 0.0);
  EXPECT_EQ(on[1].specific_cutting_energy_J_per_m3, bone.materials[1].specific_cutting_energy_J_per_m3);
  tool.balls[0].edges = 0;
  EXPECT_EQ(MaterialsUnderTool(bone, tool, params)[0].specific_cutting_energy_J_per_m3, 50e6);
}

}  // namespace
}  // namespace osteon::simulation
