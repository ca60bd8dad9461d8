#include "plugin/include/osteon_host_plan.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/plugin/plugin_objects.h"
#include "tests/temporary_path.h"

// Velocities, compliance, plans and guidance in the axes of each host (game engine).

namespace osteon::plugin {
namespace {

constexpr std::array<host::Axes, 4> kAllAxes{host::kOsteon, host::kGodot, host::kUnity, host::kUnreal};

host::SessionParams BlockParams(const char* scene) {
  host::SessionParams params;
  params.scene = scene;
  params.config_folder = ConfigFolder().c_str();
  params.lockstep = true;
  params.engine = OSTEON_ENGINE_CPU;
  return params;
}

void ExpectAlike(const host::Vector& found, const host::Vector& expected, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], tolerance) << "axis " << i;
}

host::Quaternion Product(const host::Quaternion& a, const host::Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
          a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1]};
}

/// Presses a tool with a still spindle into the cup for 0.3 s, beside its axis. @returns the pose at the end.
host::Pose Press(host::Session& session) {
  host::Pose pose;
  EXPECT_OK(session.Approach(0.0, &pose));
  EXPECT_OK(session.Step(pose, 0.0, 0.001));
  EXPECT_OK(session.Approach(-0.0165, &pose));
  const host::Vector aside = host::PositionToHost(session.axes(), {0.8e-3, 0.3e-3, 0.0});
  for (std::size_t i = 0; i < 3; ++i) pose.position[i] += aside[i];
  host::Wrench wrench;
  for (int ms = 0; ms < 300; ++ms) {
    EXPECT_OK(session.Step(pose, 0.0, 0.001));
    EXPECT_OK(session.Evaluate(pose, &wrench));
  }
  return pose;
}

TEST(HostSession, WrenchDependsOnVelocityAlikeInAllAxes) {
  const host::Vector v{0.02, -0.01, -0.05}, w{0.3, -0.2, 0.5};  // expressed in G
  for (const host::Axes& axes : kAllAxes) {
    host::Session session(axes);
    ASSERT_OK(session.Open(BlockParams("acetabulum")));
    const host::Pose pose = Press(session);
    const host::Twist twist{host::PositionToHost(axes, v), host::AxialToHost(axes, w)};
    const OsteonTwist back = host::TwistFromHost(axes, twist);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(back.linear_m_per_s[i], v[i], 1e-15);
      EXPECT_EQ(back.angular_rad_per_s[i], w[i]);
    }
    host::Wrench rest, moving;
    ASSERT_OK(session.Evaluate(pose, &rest));
    ASSERT_OK(session.Evaluate(pose, twist, &moving));
    const OsteonPose X = host::PoseFromHost(axes, pose);
    const OsteonTwist V{{v[0], v[1], v[2]}, {w[0], w[1], w[2]}};
    OsteonWrench expected;
    ASSERT_OK(osteon_session_evaluate(session.session(), &X, &V, &expected));
    const host::Wrench F = host::WrenchToHost(axes, expected);
    ExpectAlike(moving.force_N, F.force_N, 1e-9);
    ExpectAlike(moving.torque_Nm, F.torque_Nm, 1e-9);
    const host::Vector down = host::DirectionToHost(axes, {0.0, 0.0, 1.0});
    double more_N = 0.0;
    for (std::size_t i = 0; i < 3; ++i) more_N += down[i] * (moving.force_N[i] - rest.force_N[i]);
    EXPECT_GT(more_N, 0.3) << "damping resists a tool that moves into the bone";
  }
}

TEST(HostSession, CompliantBoneMovesAlikeInAllAxes) {
  const host::Vector point_m{0.001, 0.002, -0.02};
  host::Deflection reference;
  for (const host::Axes& axes : kAllAxes) {
    host::Session session(axes);
    ASSERT_OK(session.Open(BlockParams("acetabulum")));
    OsteonComplianceParams params;
    ASSERT_OK(session.DefaultCompliance(&params));
    EXPECT_EQ(params.period_s, 0.001);
    params.mount = 1;
    const host::Vector point = host::DirectionToHost(axes, point_m);
    for (std::size_t i = 0; i < 3; ++i) {
      params.mount_point_m[i] = point[i];
      // make the mount stiffer along G's y than along G's x and z, so that swapped axes show
      params.mount_stiffness_N_per_m[i] *= axes.from[i] == 1 ? 2.0 : 1.0;
    }
    ASSERT_OK(session.SetCompliance(params));
    Press(session);
    host::Deflection found;
    ASSERT_OK(session.GetDeflection(&found));
    EXPECT_TRUE(found.gives_way);
    OsteonDeflection deflection;
    ASSERT_OK(osteon_session_deflection(session.session(), &deflection));
    const double* moved = deflection.mount_m;
    EXPECT_GT(std::hypot(moved[0], moved[1], moved[2]), 1e-5);
    ExpectAlike(found.mount, host::PositionToHost(axes, {moved[0], moved[1], moved[2]}), 1e-12);
    // Osteon's own axes come first: their result is the reference
    if (axes.units_per_m == 1.0 && axes.front == 1 && axes.Determinant() == 1) reference = found;
    // poses in other axes differ in their last bit, and rounding grows while pressing
    ExpectAlike(found.mount, host::PositionToHost(axes, reference.mount), 2e-6 * axes.units_per_m);
    ExpectAlike(found.mount_rad, host::AxialToHost(axes, reference.mount_rad), 1e-4);
    ExpectAlike(found.bone.position, host::PositionToHost(axes, reference.bone.position),
                5e-6 * axes.units_per_m);
    ASSERT_OK(session.DefaultCompliance(&params));
    ASSERT_OK(session.SetCompliance(params)) << "all off";
    ASSERT_OK(session.GetDeflection(&found));
    EXPECT_FALSE(found.gives_way);
  }
}

TEST(HostSession, ChangesToolsAndReturnsToASavedBone) {
  host::Session session(host::kUnreal);
  ASSERT_OK(session.Open(BlockParams("acetabulum")));
  host::Pose pose;
  ASSERT_OK(session.Approach(0.0, &pose));
  ASSERT_OK(session.Step(pose, 0.0, 0.001));
  const std::string file = TemporaryPath("host_session.osp");
  ASSERT_OK(session.Save(file.c_str()));
  const std::string& folder = ConfigFolder();
  EXPECT_EQ(session.ChangeTool("no_such_tool", 0.0, folder.c_str(), pose), OSTEON_ERROR_FILE);
  const double usual = session.spindle_rad_per_s();
  ASSERT_OK(session.ChangeTool("twist_drill", 0.0, folder.c_str(), pose));
  EXPECT_NE(session.spindle_rad_per_s(), usual);
  ASSERT_OK(session.Restore(file.c_str(), pose));
  EXPECT_EQ(session.Restore("/no/such/file", pose), OSTEON_ERROR_FILE);
  std::filesystem::remove(file);
}

TEST(HostPlan, GuidesAlikeInAllAxes) {
  host::Wrench reference;
  for (const host::Axes& axes : kAllAxes) {
    host::PlanParams params;
    params.config_folder = ConfigFolder().c_str();
    host::Plan plan(axes);
    ASSERT_OK(plan.Open(params));
    host::PlanInfo info;
    ASSERT_OK(plan.GetInfo(&info));
    ASSERT_EQ(info.values.reamer_count, 4U);
    host::Reamer reamer;
    ASSERT_OK(plan.GetReamer(0, &reamer));
    EXPECT_EQ(plan.GetReamer(4, &reamer), OSTEON_ERROR_ARGUMENT);
    ASSERT_OK(plan.GetReamer(0, &reamer));
    EXPECT_NEAR(std::hypot(info.cup_axis[0], info.cup_axis[1], info.cup_axis[2]), 1.0, 1e-12);

    OsteonGuidanceParams guidance_params;
    ASSERT_OK(osteon_guidance_params_init(OSTEON_ABI, &guidance_params));
    host::Guidance guidance(axes);
    host::Guided guided;
    EXPECT_EQ(guidance.Evaluate(host::Pose(), host::Twist(), host::Wrench(), &guided), OSTEON_ERROR_ARGUMENT);
    ASSERT_OK(guidance.Open(plan, guidance_params));
    // A half turn about the bisector of +z and the feed turns T's z to the feed, which is minus the cup's
    // axis. From step 200 on the tool also tilts; it is too deep by then.
    const host::Vector a = host::DirectionFromHost(axes, info.cup_axis);
    const host::Vector half{-a[0], -a[1], 1.0 - a[2]};
    const double length = std::hypot(half[0], half[1], half[2]);
    const host::Quaternion into{0.0, half[0] / length, half[1] / length, half[2] / length};
    host::Pose pose;
    for (int step = 0; step <= 400; ++step) {
      const double height = (1e-3 - 1e-5 * step) * axes.units_per_m;
      const double angle = step < 200 ? 0.0 : 1e-3 * (step - 200);
      const host::Quaternion q = Product({std::cos(0.5 * angle), std::sin(0.5 * angle), 0.0, 0.0}, into);
      pose = host::PoseToHost(axes, {{0.0, 0.0, 0.0}, {q[0], q[1], q[2], q[3]}});
      for (std::size_t i = 0; i < 3; ++i) pose.position[i] = reamer.apex[i] + height * info.cup_axis[i];
      host::Twist twist;
      twist.linear = host::Scaled(info.cup_axis, -0.01 * axes.units_per_m);
      ASSERT_OK(guidance.Evaluate(pose, twist, host::Wrench(), &guided));
    }
    EXPECT_GT(guided.values.depth_m, 2e-3);
    double out_N = 0.0;
    for (std::size_t i = 0; i < 3; ++i) out_N += guided.wrench.force_N[i] * info.cup_axis[i];
    EXPECT_GT(out_N, 20.0) << "pushed out, in the host's own axes";
    if (axes.units_per_m == 1.0 && axes.front == 1 && axes.Determinant() == 1) reference = guided.wrench;
    ExpectAlike(guided.wrench.force_N, host::DirectionToHost(axes, reference.force_N), 1e-6);
    ExpectAlike(guided.wrench.torque_Nm, host::AxialToHost(axes, reference.torque_Nm), 1e-6);
    EXPECT_GT(std::hypot(guided.wrench.torque_Nm[0], guided.wrench.torque_Nm[1], guided.wrench.torque_Nm[2]),
              0.01)
        << "tilted";
    ASSERT_OK(guidance.SetModelAge(0.1));
    ASSERT_OK(guidance.Evaluate(pose, host::Twist(), host::Wrench(), &guided));
    EXPECT_EQ(guided.values.share, 0.0);
    ASSERT_OK(guidance.Reset());
    ASSERT_OK(guidance.SetGain(0.5));
    EXPECT_EQ(guidance.SetGain(2.0), OSTEON_ERROR_ARGUMENT);
  }
}

TEST(HostPlan, ScoresASessionOnlyWithAnOpenPlan) {
  host::Session session(host::kGodot);
  ASSERT_OK(session.Open(BlockParams("acetabulum")));
  host::Plan plan(host::kGodot);
  host::Assessment assessment;
  EXPECT_EQ(plan.Assess(session, &assessment), OSTEON_ERROR_ARGUMENT) << "none is open";
  EXPECT_TRUE(assessment.items.empty());
  host::PlanParams params;
  params.plan = "no_such_plan";
  EXPECT_EQ(plan.Open(params), OSTEON_ERROR_FILE);
  params.plan = nullptr;
  params.config_folder = ConfigFolder().c_str();
  ASSERT_OK(plan.Open(params));
  ASSERT_OK(plan.Assess(session, &assessment));
  EXPECT_EQ(assessment.values.removed_m3, 0.0);
  ASSERT_FALSE(assessment.items.empty());
  EXPECT_STREQ(assessment.items[0].metric, "axis_error");
}

}  // namespace
}  // namespace osteon::plugin
