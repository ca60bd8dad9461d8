#include "control/compliance/compliance.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/compliance/random_motion.h"

// Tests tool, surface layer and bone mount together, all compliant: frames, wrench, limits and energy. For
// the energy, the tool moves 1000 times at random against elastic planes (RandomMotion).

namespace osteon::control {
namespace {

constexpr double kT_s = 1e-3, kSeconds = 1.0;

// A drill of 3.2 mm diameter, with a lateral stiffness of 8.72 N/mm at its apex.
ToolLinkParams Drill() {
  ToolLinkParams tool;
  tool.compliance_T(0, 0) = tool.compliance_T(1, 1) = 1.1468e-4;
  tool.compliance_T(0, 4) = tool.compliance_T(4, 0) = 3.065e-3;
  tool.compliance_T(1, 3) = tool.compliance_T(3, 1) = -3.065e-3;
  tool.compliance_T(3, 3) = tool.compliance_T(4, 4) = 0.1023;
  tool.compliance_T(2, 2) = 6.0e-8;
  tool.compliance_T(5, 5) = 0.15;
  tool.tau_s = 0.02;
  return tool;
}

// Soft tissue of 20 mm on the bone.
SurfaceLayerParams SoftLayer() {
  SurfaceLayerParams layer;
  layer.kappa_N_per_m3.fill(0.06e9);
  layer.thickness_m = 0.02;
  return layer;
}

// The default mount, whose pivot lies 8 cm below the touched surface.
BoneMountParams Pelvis() {
  BoneMountParams mount;
  mount.p_WMo_m = {0.02, -0.01, -0.08};
  return mount;
}

// A frame of the simulation with one contact in the layer's material.
simulation::ContactModel LayerFrame() {
  simulation::ContactModel model;
  model.frame = 1;
  model.contact_count = 1;
  model.contacts[0].weight = 1.0;
  model.engaged_area_m2 = 39e-6;
  return model;
}

// The compliant elements that a test case uses.
struct CompliantParts {
  const char* name;
  bool layer, tool, mount;
};
void PrintTo(const CompliantParts& parts, std::ostream* os) { *os << parts.name; }

ComplianceParams ParamsOf(const CompliantParts& parts) {
  ComplianceParams params;
  if (parts.layer) params.layer = SoftLayer();
  if (parts.tool) params.tool = Drill();
  if (parts.mount) params.mount = Pelvis();
  return params;
}

// Energy [J] of the mount's moving mass, its springs and its pads.
double MountEnergy(const BoneMountParams& mount, const BoneMountState& state) {
  Vector6 mass, stiffness;
  mass << Vector3::Constant(mount.mass_kg), mount.inertia_kg_m2;
  stiffness << mount.stiffness_N_per_m, mount.stiffness_Nm_per_rad;
  return 0.5 * (mass.dot(state.v.cwiseAbs2()) + stiffness.dot(state.d.cwiseAbs2()) +
                mount.creep_N_per_m * state.creep_m.squaredNorm());
}

// Energy [J] that tool and mount store. The layer's stored energy is left out, so the energy test is less
// strict for the layer.
double StoredIn(const Compliance& c) {
  double stored_J = 0.0;
  if (c.params().tool) stored_J += 0.5 * c.bend().dot(c.params().tool->compliance_T.ldlt().solve(c.bend()));
  if (c.params().mount) stored_J += MountEnergy(*c.params().mount, c.mount());
  return stored_J;
}

class ComplianceEnergy : public testing::TestWithParam<CompliantParts> {};

// 1000 random motions with each element alone, and 1000 with all three. worst_J is the smallest
// energy balance: below zero, the motion took out more energy than it had put in.
TEST_P(ComplianceEnergy, NoMotionTakesOutMoreThanItPutIn) {
  std::mt19937_64 bits(41);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  double worst_J = 0.0, max_work_J = 0.0;
  for (int i = 0; i < 1000; ++i) {
    Compliance compliance(ParamsOf(GetParam()), kT_s);
    const Vector3 n = Vector3(any(bits), any(bits), 1.2).normalized(), p_TP_m(1e-3, -0.5e-3, -2e-3);
    const std::vector<SpringPlane> planes{{.n = Vector3::UnitZ(), .offset_m = -0.2e-3},
                                          {.n = n, .offset_m = n.dot(p_TP_m) - 0.3e-3, .p_TP_m = p_TP_m}};
    const RandomMotion motion(bits, kSeconds, 3e-3, 0.05);
    const MotionEnergy energy = RunMotion(compliance, planes, motion, LayerFrame(), kSeconds, kT_s, StoredIn);
    worst_J = std::min(worst_J, energy.min_balance_J);
    max_work_J = std::max(max_work_J, energy.work_J);
  }
  EXPECT_GT(max_work_J, 1e-4) << "the motions did press";
  EXPECT_GT(worst_J, -2e-5) << "of some tens of mJ that pass: the sampled work of a contact that opens";
}

INSTANTIATE_TEST_SUITE_P(Each, ComplianceEnergy,
                         testing::Values(CompliantParts{"layer", true, false, false},
                                         CompliantParts{"tool", false, true, false},
                                         CompliantParts{"mount", false, false, true},
                                         CompliantParts{"all", true, true, true}),
                         [](const auto& test) { return test.param.name; });

// Counter-example to the test above: if the time constant is below min_tau_s, the smallest passive one,
// random motions do take energy out of the tool.
TEST(Compliance, AToolWithATooShortTimeConstantGivesEnergy) {
  ComplianceParams params;
  params.tool = Drill();
  const double min_tau_s = 0.5 * kT_s * (80e3 * params.tool->compliance_T(0, 0) - 1.0);
  const std::vector<SpringPlane> side{
      {.n = Vector3::UnitX(), .offset_m = -0.1e-3, .stiffness_N_per_m = 80e3}};
  const auto min_balance_J = [&](double factor) {
    params.tool->tau_s = factor * min_tau_s;
    std::mt19937_64 bits(3);
    double smallest_J = 0.0;
    for (int i = 0; i < 40; ++i) {
      Compliance compliance(params, kT_s);
      const RandomMotion motion(bits, kSeconds, 3e-3, 0.0);
      smallest_J =
          std::min(smallest_J,
                   RunMotion(compliance, side, motion, LayerFrame(), kSeconds, kT_s, StoredIn).min_balance_J);
    }
    return smallest_J;
  };
  EXPECT_LT(min_balance_J(0.9), -2e-4);
  EXPECT_GT(min_balance_J(1.05), -1e-6);
}

// The tool is rigid, and mount and layer are at rest. Then pose, velocity and wrench of the head must equal
// those of the tool.
TEST(Compliance, ARigidToolAtRestKeepsPoseVelocityAndWrench) {
  ComplianceParams params = ParamsOf({"all", true, true, true});
  params.tool->compliance_T.setZero();
  Compliance compliance(params, kT_s);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = ExpRotation({0.3, 2.0, -0.4});
  X_WT.translation() = Vector3(0.6, 0.1, 0.3);
  const Twist V_WT{.v = {0.02, -0.01, 0.03}, .w = {0.1, 0.2, -0.3}};
  const Wrench F{.f = {10.0, -20.0, 30.0}, .t = {0.1, 0.2, 0.3}};
  EXPECT_TRUE(compliance.X_ME(X_WT).isApprox(X_WT, 1e-12));
  EXPECT_LT((compliance.V_ME(X_WT, V_WT).v - V_WT.v).norm(), 1e-12);
  EXPECT_LT((compliance.OnTool(F, X_WT).t - F.t).norm(), 1e-12);
}

// Principle of virtual work: the given wrench acts on the head, and OnTool computes the equivalent wrench on
// T. In a small motion both must do the same work.
TEST(Compliance, WrenchesOnToolAndHeadDoTheSameWork) {
  Compliance compliance(ParamsOf({"all", true, true, true}), kT_s);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = ExpRotation({0.3, 2.0, -0.4});
  X_WT.translation() = Vector3(0.05, 0.02, -0.03);
  const Wrench F{.f = {25.0, -20.0, 30.0}, .t = {0.1, 0.05, 0.2}};
  for (int i = 0; i < 80; ++i) compliance.Step(F, LayerFrame(), X_WT);
  EXPECT_GT(compliance.bend().head<3>().norm(), 1e-3);
  constexpr double kStep = 1e-7;
  const Wrench F_T_W = compliance.OnTool(F, X_WT);
  const Pose X_ME = compliance.X_ME(X_WT);
  for (int axis = 0; axis < 6; ++axis) {
    Twist d;
    (axis < 3 ? d.v : d.w)[axis % 3] = kStep;
    Pose X_moved = X_WT;
    X_moved.linear() = ExpRotation(d.w) * X_WT.linear();
    X_moved.translation() += d.v;
    const Twist seen = SmallStep(X_ME, compliance.X_ME(X_moved));
    EXPECT_NEAR(Power(F, seen), Power(F_T_W, d), 1e-6 * kStep * 60.0) << axis;
  }
}

// While tool, layer and mount all move, the head's velocity must equal the difference of its poses over the
// period.
TEST(Compliance, TheHeadsVelocityIsTheDerivativeOfItsPose) {
  Compliance compliance(ParamsOf({"all", true, true, true}), kT_s);
  Pose X_WT = Pose::Identity();
  X_WT.translation() = Vector3(0.05, 0.02, -0.03);
  const Twist V_WT{.v = {0.02, -0.01, 0.03}, .w = {0.05, 0.1, -0.1}};
  const Wrench F{.f = {25.0, -20.0, 30.0}, .t = {0.1, 0.05, 0.2}};
  Pose X_before = compliance.X_ME(X_WT);
  for (int i = 0; i < 40; ++i) {
    X_before = compliance.X_ME(X_WT);
    compliance.Step(F, LayerFrame(), X_WT);
    X_WT.translation() += kT_s * V_WT.v;
    X_WT.linear() = ExpRotation(kT_s * V_WT.w) * X_WT.linear();
  }
  const Twist step = SmallStep(X_before, compliance.X_ME(X_WT));
  const Twist V_ME = compliance.V_ME(X_WT, V_WT);
  EXPECT_LT((step.v / kT_s - V_ME.v).norm(), 0.02 * V_ME.v.norm());
  EXPECT_LT((step.w / kT_s - V_ME.w).norm(), 0.03 * V_ME.w.norm());
}

TEST(Compliance, ReportsBendThrustAndMountMotionBeyondTheirLimits) {
  ComplianceParams params;
  params.tool = Drill();
  params.tool->max_bend_m = 6.5e-3;
  params.tool->max_thrust_N = 211.0;
  Compliance compliance(params, kT_s);
  const Pose X_WT = Pose::Identity();
  for (int i = 0; i < 200; ++i)
    compliance.Step({.f = {50.0, 0.0, 0.0}, .t = Vector3::Zero()}, LayerFrame(), X_WT);
  EXPECT_FALSE(compliance.beyond_limit());
  EXPECT_TRUE(compliance.noticed());
  for (int i = 0; i < 200; ++i)
    compliance.Step({.f = {70.0, 0.0, 0.0}, .t = Vector3::Zero()}, LayerFrame(), X_WT);
  EXPECT_TRUE(compliance.beyond_limit());
  compliance.Reset();
  EXPECT_FALSE(compliance.noticed());
  compliance.Step({.f = {0.0, 0.0, -220.0}, .t = Vector3::Zero()}, LayerFrame(), X_WT);
  EXPECT_TRUE(compliance.beyond_limit()) << "thrust";
  Compliance mount(ParamsOf({"mount", false, false, true}), kT_s);
  for (int i = 0; i < 2000; ++i)
    mount.Step({.f = {0.0, 0.0, 600.0}, .t = Vector3::Zero()}, LayerFrame(), X_WT);
  EXPECT_TRUE(mount.beyond_limit()) << "12.7 mm";
  Compliance broken(params, kT_s);
  broken.Step({.f = {std::nan(""), 0.0, 0.0}, .t = Vector3::Zero()}, LayerFrame(), X_WT);
  EXPECT_TRUE(broken.beyond_limit()) << "what is not finite must not go on";
}

TEST(Compliance, DoesNotAllocate) {
  Compliance compliance(ParamsOf({"all", true, true, true}), kT_s);
  const Pose X_WT = Pose::Identity();
  const simulation::ContactModel model = LayerFrame();
  ComplianceRecord record;
  const rt::CheckedNoAllocScope scope;
  for (int i = 0; i < 10; ++i) {
    const Twist V = compliance.V_ME(X_WT, {});
    compliance.Step({.f = {1.0 + V.v.x(), 2.0, 3.0}, .t = Vector3::Zero()}, model, X_WT);
    compliance.FillRecord(X_WT, record);
  }
}

}  // namespace
}  // namespace osteon::control
