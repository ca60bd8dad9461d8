#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "config/reading/sections/compliance_params.h"
#include "control/compliance/compliance.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/plugin/plugin_objects.h"

// Compliance of bone mount and tool through the C interface, in lockstep: no test depends on wall time.

namespace osteon::plugin {
namespace {

static_assert(sizeof(OsteonComplianceParams) == 168 && sizeof(OsteonDeflection) == 296);

// Everything rigid.
OsteonComplianceParams Rigid() {
  OsteonComplianceParams params;
  EXPECT_OK(osteon_compliance_params_init(OSTEON_ABI, &params));
  return params;
}

// A bone on a mount, whose point of support is 20 mm below G's origin.
OsteonComplianceParams OnAMount() {
  OsteonComplianceParams params = Rigid();
  params.mount = 1;
  params.mount_point_m[2] = -0.02;
  return params;
}

OsteonDeflection DeflectionIn(OsteonSession* session) {
  OsteonDeflection deflection{};
  EXPECT_OK(osteon_session_deflection(session, &deflection));
  return deflection;
}

Owned<OsteonTool> Drill(double diameter_m) {
  OsteonToolParams params;
  osteon_tool_params_default(&params);
  params.name = "twist_drill";
  params.diameter_m = diameter_m;
  params.config_folder = ConfigFolder().c_str();
  OsteonTool* tool = nullptr;
  EXPECT_OK(osteon_tool_create(OSTEON_ABI, &params, &tool));
  return Owned<OsteonTool>(tool);
}

// Steps the engine once with the tool at this height, then evaluates the hand's wrench. The spindle stands
// still.
OsteonWrench Press(OsteonSession* session, double z_mm) {
  const OsteonPose pose = Above(z_mm);
  OsteonWrench wrench{};
  EXPECT_OK(osteon_session_step(session, &pose, 0.0, 0.001));
  EXPECT_OK(osteon_session_evaluate(session, &pose, nullptr, &wrench));
  return wrench;
}

// Moves the tool down to `z_mm` at 5 mm/s and holds it for 1.5 s, until the mount is at rest.
OsteonWrench PressAndHold(OsteonSession* session, double z_mm) {
  OsteonWrench wrench{};
  for (double z = 4.2; z > z_mm; z -= 0.005) wrench = Press(session, z);
  for (int i = 0; i < 1500; ++i) wrench = Press(session, z_mm);
  return wrench;
}

// Default stiffnesses: 47.4e3 N/m of the mount, 20e3 N/m of the coupling.
TEST(OsteonCompliance, ABoneOnAMountMovesByForceOverStiffness) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  OsteonComplianceParams params = OnAMount();
  params.mount_damping_ratio = 0.5;
  ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, session.get(), &params));
  const OsteonWrench wrench = PressAndHold(session.get(), 3.0);
  const OsteonDeflection d = DeflectionIn(session.get());
  ASSERT_GT(wrench.force_N[2], 5.0);
  EXPECT_NEAR(-d.mount_m[2], wrench.force_N[2] / 47.4e3, 0.01 * wrench.force_N[2] / 47.4e3);
  EXPECT_NEAR(d.bone.position_m[2], d.mount_m[2], 1e-6) << "pressed over its point, it hardly turns";
  EXPECT_NEAR(d.head.position_m[2], 3.0e-3 - d.mount_m[2], 1e-6) << "less deep in the bone than in G";
  EXPECT_EQ(d.gives_way, 1U);
  EXPECT_EQ(d.noticed, 1U);
  EXPECT_EQ(d.beyond_limit, 0U);

  const auto rigid = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const double rigid_N = PressAndHold(rigid.get(), 3.0).force_N[2];
  const double series = 1.0 / (1.0 + 20e3 / 47.4e3);
  EXPECT_NEAR(wrench.force_N[2], series * rigid_N, 0.02 * rigid_N) << "coupling and mount in series";
}

// At the same poses and wrenches, the servo loop's compliance elements give the same deflections as the
// session.
TEST(OsteonCompliance, DeflectionEqualsThatOfTheServoLoop) {
  const auto tool = Drill(0.0032);
  OsteonBoneParams bone_params;
  osteon_bone_params_default(&bone_params);
  bone_params.scene = "thin_plate";
  bone_params.config_folder = ConfigFolder().c_str();
  OsteonBone* made = nullptr;
  ASSERT_OK(osteon_bone_create(OSTEON_ABI, &bone_params, &made));
  const Owned<OsteonBone> bone(made);
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  OsteonComplianceParams params = OnAMount();
  params.tool = 1;
  ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, session.get(), &params));

  const config::ToolConfig loaded = config::LoadTool(ConfigFolder() + "/tools/twist_drill.yaml", 0.0032);
  control::ComplianceParams levels;
  levels.tool = config::ToolLinkOf(loaded.bending->compliance, loaded.bending->relaxation_s, 60.0);
  levels.mount = control::BoneMountParams{.p_WMo_m = {0.0, 0.0, -0.02}};
  control::Compliance expected(levels, 0.001);
  OsteonPose approach{};
  ASSERT_OK(osteon_bone_approach(bone.get(), 0.006, &approach));
  double bend_m = 0.0, mount_m = 0.0;
  OsteonDeflection d{};
  for (int ms = 0; ms < 2500; ++ms) {
    OsteonPose pose = approach;
    pose.position_m[2] -= 4e-6 * ms;
    pose.position_m[0] += 2e-7 * ms;
    OsteonWrench wrench{};
    ASSERT_OK(osteon_session_step(session.get(), &pose, 0.0, 0.001));
    ASSERT_OK(osteon_session_evaluate(session.get(), &pose, nullptr, &wrench));
    d = DeflectionIn(session.get());
    // the wrench on T, moved to the bent head, drives the expected elements
    const auto& q = pose.orientation_wxyz;
    Pose X_GT = Pose::Identity();
    X_GT.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    X_GT.translation() = Vector3(pose.position_m[0], pose.position_m[1], pose.position_m[2]);
    const Matrix3 R_MW = expected.X_WM().linear().transpose();
    const Vector3 f_W(wrench.force_N), arm_W = X_GT.linear() * expected.bend().head<3>();
    const Vector3 t_W = Vector3(wrench.torque_Nm) - arm_W.cross(f_W);
    expected.Step({.f = R_MW * f_W, .t = R_MW * t_W}, {}, X_GT);
    for (int i = 0; i < 3; ++i) {
      ASSERT_NEAR(d.bend_m[i], expected.bend()[i], 1e-12) << ms << " ms";
      ASSERT_NEAR(d.bend_rad[i], expected.bend()[3 + i], 1e-10) << ms << " ms";
      ASSERT_NEAR(d.mount_m[i], expected.mount().d[i], 1e-12) << ms << " ms";
      ASSERT_NEAR(d.head.position_m[i], expected.X_ME(X_GT).translation()[i], 1e-12) << ms << " ms";
    }
    bend_m = std::max(bend_m, std::hypot(d.bend_m[0], d.bend_m[1]));
    mount_m = std::max(mount_m, std::abs(d.mount_m[2]));
  }
  EXPECT_GT(bend_m, 1e-6);
  EXPECT_GT(mount_m, 50e-6);
}

// The engine cuts at the place of the bent head: if the bone was displaced by d, the cut is d less deep.
TEST(OsteonCompliance, EngineCutsWhereTheHeadIsInTheBone) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  OsteonComplianceParams params = OnAMount();
  params.mount_damping_ratio = 0.5;
  ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, session.get(), &params));
  (void)PressAndHold(session.get(), 3.4);
  const OsteonDeflection before = DeflectionIn(session.get());
  (void)Press(session.get(), 3.4);
  const OsteonFigures figures = FiguresOf(session.get());
  const double head_z_m = before.head.position_m[2];
  EXPECT_LT(head_z_m, 4.2e-3);
  EXPECT_GT(head_z_m, 3.4e-3 + 0.05e-3);
  // the wrench in the figures is that of the coupling's spring between the frame's pose and the frame's
  // proxy, before limits
  EXPECT_NEAR(figures.wrench.force_N[2], 20e3 * (figures.proxy.position_m[2] - head_z_m),
              0.05 * figures.wrench.force_N[2]);
}

TEST(OsteonCompliance, SwitchedOffEqualsASessionWithoutCompliance) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto plain = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const auto switched = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const OsteonComplianceParams off = Rigid();
  ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, switched.get(), &off));
  for (double z = 4.2; z > 2.5; z -= 0.01) {
    const OsteonWrench a = Press(plain.get(), z), b = Press(switched.get(), z);
    ASSERT_EQ(std::memcmp(&a, &b, sizeof a), 0) << z;
  }
  const OsteonDeflection d = DeflectionIn(switched.get());
  EXPECT_EQ(d.gives_way, 0U);
  EXPECT_EQ(d.bone.orientation_wxyz[0], 1.0);
}

TEST(OsteonCompliance, DeflectionIsZeroAfterUndoAndAfterSwitchingOff) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const OsteonComplianceParams params = OnAMount();
  ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, session.get(), &params));
  ASSERT_OK(osteon_session_mark(session.get()));
  (void)PressAndHold(session.get(), 3.2);
  EXPECT_NE(DeflectionIn(session.get()).mount_m[2], 0.0);
  const OsteonPose free = Above(4.3);
  ASSERT_OK(osteon_session_undo(session.get(), &free));
  EXPECT_EQ(DeflectionIn(session.get()).mount_m[2], 0.0);
  (void)PressAndHold(session.get(), 3.2);
  EXPECT_NE(DeflectionIn(session.get()).mount_m[2], 0.0);
  ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, session.get(), nullptr));
  EXPECT_EQ(DeflectionIn(session.get()).gives_way, 0U);
  (void)Press(session.get(), 3.2);
  EXPECT_EQ(DeflectionIn(session.get()).gives_way, 0U);
}

TEST(OsteonCompliance, RefusesParamsAndNamesTheAcceptedValue) {
  const auto bone = BlockOfBalls();
  const auto ball = BallTool();
  const auto session = MakeSession(bone.get(), ball.get(), Lockstep(false));
  const auto refused = [&](OsteonSession* by, const std::string& text, const auto& change) {
    OsteonComplianceParams params = Rigid();
    change(params);
    EXPECT_EQ(osteon_session_set_compliance(OSTEON_ABI, by, &params), OSTEON_ERROR_ARGUMENT);
    EXPECT_NE(std::string(osteon_last_error()).find(text), std::string::npos) << osteon_last_error();
  };
  refused(session.get(), "accepted a tool with `bending`", [](auto& p) { p.tool = 1; });
  refused(session.get(), "layer: found no soft tissue", [](auto& p) { p.layer = 1; });
  refused(session.get(), "period_s: found 0", [](auto& p) { p.period_s = 0.0; });
  refused(session.get(), "mount_damping_ratio: found 0.01, accepted at least 0.05",
          [](auto& p) { p.mount = 1, p.mount_damping_ratio = 0.01; });
  refused(session.get(), "mount_mass_kg: found 0.2, accepted at least 0.42",
          [](auto& p) { p.mount = 1, p.mount_mass_kg = 0.2; });
  refused(session.get(), "mount_inertia_kg_m2: found 0.001 about x, accepted at least 0.01",
          [](auto& p) { p.mount = 1, p.mount_inertia_kg_m2[0] = 0.001; });
  refused(session.get(), "stiffness_N_per_m",
          [](auto& p) { p.mount = 1, p.mount_stiffness_N_per_m[1] = NAN; });
  const auto drill = Drill(0.0032);
  const auto drilling = MakeSession(bone.get(), drill.get(), Lockstep(false));
  refused(drilling.get(), "buckles at", [](auto& p) { p.tool = 1, p.push_N = 300.0; });
  OsteonComplianceParams bends = Rigid();
  bends.tool = 1;
  ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, drilling.get(), &bends));
  const OsteonPose free = Above(40.0);
  EXPECT_EQ(osteon_session_change_tool(drilling.get(), ball.get(), &free), OSTEON_ERROR_ARGUMENT)
      << "nobody knows how the ball bends";

  EXPECT_EQ(osteon_session_set_compliance(OSTEON_ABI + 1, session.get(), nullptr), OSTEON_ERROR_ABI);
  EXPECT_EQ(osteon_session_set_compliance(OSTEON_ABI, nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_deflection(session.get(), nullptr), OSTEON_ERROR_ARGUMENT);
}

// A change to a tool of unknown bending is refused: the surface is cut by the tool in use.
TEST(OsteonCompliance, TheToolInUseCarvesTheSurfaceAfterARefusedChange) {
  const auto bone = BlockOfBalls();
  const auto drill = Drill(0.0032);
  const auto ball = BallTool();
  OsteonComplianceParams bends = Rigid();
  bends.tool = 1;
  std::array<double, 2> volumes_m3{};
  for (const bool is_refused : {false, true}) {
    const auto session = MakeSession(bone.get(), drill.get(), Lockstep(true));
    ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, session.get(), &bends));
    OsteonPose pose = Above(40.0);
    pose.orientation_wxyz[0] = 0.0;  // +z of the drill points into the block
    pose.orientation_wxyz[1] = 1.0;
    if (is_refused) {
      ASSERT_EQ(osteon_session_change_tool(session.get(), ball.get(), &pose), OSTEON_ERROR_ARGUMENT);
    }
    for (double z_mm = 1.5; z_mm > -1.5; z_mm -= 0.002) {
      pose.position_m[2] = 1e-3 * z_mm;
      ASSERT_OK(osteon_session_step(session.get(), &pose, 300.0, 0.001));
    }
    ASSERT_GT(FiguresOf(session.get()).removed_volume_m3, 1e-9);
    OsteonSurfaceInfo info{};
    const std::string file = testing::TempDir() + "osteon_refused_tool.stl";
    ASSERT_OK(osteon_session_surface_export(session.get(), file.c_str(), &info));
    volumes_m3[is_refused ? 1 : 0] = info.volume_m3;
  }
  EXPECT_EQ(volumes_m3[0], volumes_m3[1]);
}

TEST(OsteonCompliance, WrenchStaysWithinItsLimitAndNothingAllocates) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  OsteonSettings settings = Lockstep(false);
  settings.max_force_N = 30.0;
  const auto session = MakeSession(bone.get(), tool.get(), settings);
  const OsteonComplianceParams params = OnAMount();
  ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, session.get(), &params));
  double largest_N = 0.0;
  for (double z = 4.2; z > -2.0; z -= 0.01) {
    const OsteonWrench wrench = Press(session.get(), z);
    largest_N = std::max(largest_N, std::hypot(wrench.force_N[0], wrench.force_N[1], wrench.force_N[2]));
  }
  EXPECT_LE(largest_N, 30.0);
  EXPECT_GT(largest_N, 29.0);
  const OsteonPose pose = Above(-2.0);
  const OsteonTwist twist{};
  OsteonWrench wrench{};
  ASSERT_OK(osteon_session_set_compliance(OSTEON_ABI, session.get(), &params));
  rt::CheckedNoAllocScope scope;
  for (int i = 0; i < 20; ++i) (void)osteon_session_evaluate(session.get(), &pose, &twist, &wrench);
  scope.End();
}

TEST(OsteonLibrary, FillsNoStructOfAnotherAbi) {
  const auto expect_untouched = [](auto init) {
    return [init](auto params) {
      std::memset(&params, 0x5a, sizeof params);
      auto filled = params;
      EXPECT_EQ(init(OSTEON_ABI + 1, &filled), OSTEON_ERROR_ABI);
      EXPECT_EQ(std::memcmp(&params, &filled, sizeof params), 0);
      EXPECT_EQ(init(OSTEON_ABI, &filled), OSTEON_OK);
      EXPECT_NE(std::memcmp(&params, &filled, sizeof params), 0);
      EXPECT_EQ(init(OSTEON_ABI, nullptr), OSTEON_ERROR_ARGUMENT);
    };
  };
  expect_untouched(osteon_bone_params_init)(OsteonBoneParams{});
  expect_untouched(osteon_tool_params_init)(OsteonToolParams{});
  expect_untouched(osteon_settings_init)(OsteonSettings{});
  expect_untouched(osteon_plan_params_init)(OsteonPlanParams{});
  expect_untouched(osteon_guidance_params_init)(OsteonGuidanceParams{});
  expect_untouched(osteon_compliance_params_init)(OsteonComplianceParams{});
}

}  // namespace
}  // namespace osteon::plugin
