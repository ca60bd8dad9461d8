#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "config/reading/load_surgical_plan.h"
#include "control/coupling/coupling_pipeline.h"
#include "session/procedure/plan_guidance.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/loop/servo_parts.h"
#include "tests/plugin/plugin_objects.h"

// Plans, guidance and assessment through the C interface.

namespace osteon::plugin {
namespace {

static_assert(sizeof(OsteonPlanParams) == 24 && sizeof(OsteonPlanInfo) == 144 && sizeof(OsteonReamer) == 56);
static_assert(sizeof(OsteonGuidanceParams) == 48 && sizeof(OsteonGuidanceOutput) == 112);
static_assert(sizeof(OsteonAssessment) == 168 && sizeof(OsteonScoreItem) == 80);

constexpr double kDegree_rad = 0.017453292519943295;

OsteonPose PoseOf(const Pose& X) {
  const Eigen::Quaterniond q(X.linear());
  const Vector3 p = X.translation();
  return {.position_m = {p.x(), p.y(), p.z()}, .orientation_wxyz = {q.w(), q.x(), q.y(), q.z()}};
}

// The pose as the library reads it: with a normalised quaternion.
Pose PoseAsRead(const OsteonPose& pose) {
  const auto& q = pose.orientation_wxyz;
  Pose X = Pose::Identity();
  X.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  X.translation() = Vector3(pose.position_m[0], pose.position_m[1], pose.position_m[2]);
  return X;
}

struct DestroyPlan {
  void operator()(OsteonPlan* plan) const { osteon_plan_destroy(plan); }
  void operator()(OsteonGuidance* guidance) const { osteon_guidance_destroy(guidance); }
};
using OwnedPlan = std::unique_ptr<OsteonPlan, DestroyPlan>;
using OwnedGuidance = std::unique_ptr<OsteonGuidance, DestroyPlan>;

OwnedPlan ShippedPlan() {
  OsteonPlanParams params;
  osteon_plan_params_default(&params);
  params.config_folder = ConfigFolder().c_str();
  OsteonPlan* plan = nullptr;
  EXPECT_OK(osteon_plan_create(OSTEON_ABI, &params, &plan));
  return OwnedPlan(plan);
}

OwnedGuidance MakeGuidance(const OsteonPlan* plan, const OsteonGuidanceParams& params) {
  OsteonGuidance* guidance = nullptr;
  EXPECT_OK(osteon_guidance_create(OSTEON_ABI, plan, &params, &guidance));
  return OwnedGuidance(guidance);
}

OsteonGuidanceParams DefaultGuidanceParams() {
  OsteonGuidanceParams params;
  osteon_guidance_params_default(&params);
  return params;
}

const config::SurgicalPlanConfig& LoadedPlan() {
  static const auto plan = config::LoadSurgicalPlan(ConfigFolder() + "/plans/acetabulum.yaml");
  return plan;
}

// The pose of a tool along the planned axis, tilted about the head's centre. The head's centre is `height_m`
// above its planned place.
Pose AlongThePlan(const procedure::SurgicalPlan& plan, const procedure::PlannedTool& reamer, double height_m,
                  double tilt_rad = 0.0) {
  Pose X_GT = Pose::Identity();
  X_GT.linear() = RotationFromZTo(plan.axis_G) * ExpRotation(Vector3(M_PI - tilt_rad, 0, 0));
  X_GT.translation() =
      plan.CentreOf(reamer) + height_m * plan.axis_G + 0.5 * reamer.diameter_m * X_GT.linear().col(2);
  return X_GT;
}

// A contact model with one plane, square to the tool's feed and `depth_m` behind its apex.
simulation::ContactModel PlaneBehind(const Pose& X_GT, double depth_m, rt::Nanoseconds now) {
  const Vector3 feed = X_GT.linear().col(2);
  simulation::ContactModel model;
  model.frame = 1;
  model.pose_stamp = now;
  model.X_WP = X_GT;
  model.contact_count = 1;
  model.contacts[0].p_W_m = Vector3(X_GT.translation() - depth_m * feed);
  model.contacts[0].n_W = Vector3(-feed);
  model.contacts[0].stiffness_N_per_m = 20e3;
  return model;
}

// The shipped plan is radiographic 40/15 deg; cup_axis_test.cpp has the same angles of the other definitions.
TEST(OsteonPlan, InfoHasTheCupAnglesOfAllThreeDefinitions) {
  const auto plan = ShippedPlan();
  OsteonPlanInfo info{};
  ASSERT_OK(osteon_plan_info(plan.get(), &info));
  EXPECT_NEAR(info.radiographic.inclination_rad, 40.0 * kDegree_rad, 1e-12);
  EXPECT_NEAR(info.radiographic.anteversion_rad, 15.0 * kDegree_rad, 1e-12);
  EXPECT_NEAR(info.operative.inclination_rad, 38.3808 * kDegree_rad, 1e-4 * kDegree_rad);
  EXPECT_NEAR(info.anatomic.anteversion_rad, 22.6291 * kDegree_rad, 1e-4 * kDegree_rad);
  EXPECT_EQ(info.reamer_count, 4U);
  EXPECT_EQ(info.is_left, 0U);
  EXPECT_EQ(info.has_guidance, 1U);
  OsteonReamer reamer{};
  ASSERT_OK(osteon_plan_reamer(plan.get(), 3, &reamer));
  EXPECT_DOUBLE_EQ(reamer.diameter_m, 0.050);
  double depth_m = 0.0;
  for (int i = 0; i < 3; ++i) depth_m += (reamer.center_m[i] - reamer.apex_m[i]) * info.cup_axis[i];
  EXPECT_NEAR(depth_m, 0.025, 1e-12);
}

TEST(OsteonPlan, InfoOfAnOpeningLeavesValuesOfACupNan) {
  const OsteonPlanParams params{.plan = "molar", .rubric = nullptr, .config_folder = ConfigFolder().c_str()};
  OsteonPlan* plan = nullptr;
  ASSERT_OK(osteon_plan_create(OSTEON_ABI, &params, &plan));
  OsteonPlanInfo info{};
  EXPECT_EQ(osteon_plan_info(plan, &info), OSTEON_OK);
  EXPECT_EQ(info.reamer_count, 2U);
  EXPECT_DOUBLE_EQ(info.cup_diameter_m, 3.5e-3);
  EXPECT_NEAR(info.cup_axis[2], 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(info.native_center_m[0]));
  EXPECT_TRUE(std::isnan(info.anatomic.inclination_rad));
  EXPECT_EQ(info.has_guidance, 1U);
  osteon_plan_destroy(plan);
}

TEST(OsteonPlan, RefusesWithTheValueAndWhatIsAccepted) {
  OsteonPlan* none = reinterpret_cast<OsteonPlan*>(1);
  OsteonPlanParams params{.plan = "no_such", .rubric = nullptr, .config_folder = ConfigFolder().c_str()};
  EXPECT_EQ(osteon_plan_create(OSTEON_ABI, &params, &none), OSTEON_ERROR_FILE);
  EXPECT_EQ(none, nullptr);
  EXPECT_NE(std::string(osteon_last_error()).find("acetabulum"), std::string::npos) << osteon_last_error();
  EXPECT_EQ(osteon_plan_create(OSTEON_ABI + 1, &params, &none), OSTEON_ERROR_ABI);
  const auto plan = ShippedPlan();
  OsteonReamer reamer{};
  EXPECT_EQ(osteon_plan_reamer(plan.get(), 4, &reamer), OSTEON_ERROR_ARGUMENT);
  EXPECT_NE(std::string(osteon_last_error()).find("found 4, accepted 0 … 3"), std::string::npos);
  OsteonGuidance* guidance = nullptr;
  OsteonGuidanceParams wrong = DefaultGuidanceParams();
  wrong.max_force_N = 201.0;
  EXPECT_EQ(osteon_guidance_create(OSTEON_ABI, plan.get(), &wrong, &guidance), OSTEON_ERROR_ARGUMENT);
  EXPECT_NE(std::string(osteon_last_error()).find("max_force_N: found 201"), std::string::npos);
  wrong = DefaultGuidanceParams();
  wrong.gain = NAN;
  EXPECT_EQ(osteon_guidance_create(OSTEON_ABI, plan.get(), &wrong, &guidance), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(guidance, nullptr);

  const auto made = MakeGuidance(plan.get(), DefaultGuidanceParams());
  OsteonPose pose{.position_m = {NAN, 0, 0}, .orientation_wxyz = {1, 0, 0, 0}};
  OsteonGuidanceOutput output;
  EXPECT_EQ(osteon_guidance_evaluate(made.get(), &pose, nullptr, nullptr, &output), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(output.wrench.force_N[0], 0.0);
  EXPECT_EQ(osteon_guidance_set_gain(made.get(), 1.5), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_guidance_set_model_age(made.get(), NAN), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_guidance_evaluate(nullptr, nullptr, nullptr, nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
}

// A random walk in and out of the corridor, while bone also presses: the C interface gives what the servo
// loop's pipeline gives.
TEST(OsteonGuidance, OutputEqualsThatOfTheServoLoop) {
  const procedure::SurgicalPlan& surgical = LoadedPlan().plan;
  const procedure::PlannedTool& reamer = surgical.tools[1];
  control::ServoParams params = control::ServoBench::Params();
  params.wrench.max_force_N = 60.0;
  params.wrench.max_torque_Nm = 5.0;
  const control::ServoParams unguided = params;
  params.guidance = session::GuidanceOf(surgical, reamer, Pose::Identity());
  ASSERT_TRUE(params.guidance);
  const auto arm = control::Follower(params);
  control::CouplingPipeline pipeline(params), bone(unguided);
  pipeline.Reset();
  bone.Reset();
  OsteonGuidanceParams guidance_params = DefaultGuidanceParams();
  guidance_params.reamer = 1;
  guidance_params.max_force_N = 60.0;
  guidance_params.max_torque_Nm = 5.0;
  guidance_params.max_speed_m_per_s = params.twist.max_speed_m_per_s;
  guidance_params.period_s = params.period_s;
  const auto plan = ShippedPlan();
  const auto guidance = MakeGuidance(plan.get(), guidance_params);

  std::mt19937 random(39);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&] { return Vector3(unit(random), unit(random), unit(random)); };
  const Pose X_start = AlongThePlan(surgical, reamer, 1e-3);
  Vector3 p_m = Vector3::Zero(), turn = Vector3::Zero(), v = Vector3::Zero(), w = Vector3::Zero();
  rt::Nanoseconds now = rt::kSecond;
  double largest_N = 0.0, least_share = 1.0, largest_share = 0.0;
  for (int i = -300; i < 4000; ++i) {  // i < 0: at rest in the corridor while the coupling fades in
    now += rt::kMillisecond;
    if (i >= 0) v = 0.98 * v + 0.012 * vector() - 0.03 * p_m;
    if (i >= 0) w = 0.98 * w + 0.06 * vector() - 0.03 * turn;
    p_m += 1e-3 * v;
    turn += 1e-3 * w;
    Pose X_raw = X_start;
    X_raw.translation() += p_m;
    X_raw.linear() = ExpRotation(turn) * X_start.linear();
    const OsteonPose pose = PoseOf(X_raw);
    const Pose X_GT = PoseAsRead(pose);
    // for a while the model is late, by up to 50 ms
    const double age_s = i > 1500 && i < 2500 ? 0.025 + 0.025 * std::sin(0.02 * i) : 0.0;
    const simulation::ContactModel model =
        PlaneBehind(X_start, i < 0 ? 0.0 : 4e-3 * std::max(0.0, std::sin(0.01 * i)),
                    now - static_cast<rt::Nanoseconds>(std::llround(1e9 * age_s)));
    ASSERT_OK(
        osteon_guidance_set_model_age(guidance.get(), 1e-9 * static_cast<double>(now - model.pose_stamp)));
    safety::LimitSet acting;
    const control::CouplingInput input{.model = model, .X_WT = X_GT, .V_WT = {.v = v, .w = w}, .now = now};
    static_cast<void>(bone.Evaluate(input, *arm, acting));
    const Wrench bone_wrench = bone.Render(*arm, acting).F;
    static_cast<void>(pipeline.Evaluate(input, *arm, acting));
    static_cast<void>(pipeline.Render(*arm, acting));

    const OsteonTwist twist{.linear_m_per_s = {v.x(), v.y(), v.z()},
                            .angular_rad_per_s = {w.x(), w.y(), w.z()}};
    const OsteonWrench other{.force_N = {bone_wrench.f.x(), bone_wrench.f.y(), bone_wrench.f.z()},
                             .torque_Nm = {bone_wrench.t.x(), bone_wrench.t.y(), bone_wrench.t.z()}};
    OsteonGuidanceOutput output;
    ASSERT_OK(osteon_guidance_evaluate(guidance.get(), &pose, &twist, &other, &output));
    if (i < 0) continue;
    const control::Guidance& expected = *pipeline.guidance();
    const Wrench& F = expected.scale().F_T_W();
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(output.wrench.force_N[axis], F.f[axis], 1e-12) << i;
      ASSERT_NEAR(output.wrench.torque_Nm[axis], F.t[axis], 1e-12) << i;
    }
    ASSERT_NEAR(output.share, expected.scale().scale(), 1e-12) << i;
    ASSERT_NEAR(output.energy_J, expected.scale().energy_J(), 1e-12) << i;
    ASSERT_EQ(output.stop_spindle != 0, expected.stops_spindle()) << i;
    ASSERT_EQ(output.inside != 0, expected.field().inside) << i;
    ASSERT_EQ(output.jumped, 0U) << i;
    ASSERT_LE((bone_wrench.f + Vector3(output.wrench.force_N)).norm(), 60.0) << i;
    ASSERT_LE(output.energy_J + output.share * output.potential_J, 1e-6) << i;
    largest_N = std::max(largest_N, F.f.norm());
    if (!expected.field().inside) least_share = std::min(least_share, output.share);
    largest_share = std::max(largest_share, output.share);
  }
  EXPECT_GT(largest_N, 20.0);
  EXPECT_EQ(largest_share, 1.0);
  EXPECT_LT(least_share, 0.5) << "bone or energy took it back at times";
}

TEST(OsteonGuidance, WaitsUntilInsideTheCorridorAndRestartsAfterAJump) {
  const procedure::SurgicalPlan& surgical = LoadedPlan().plan;
  const procedure::PlannedTool& reamer = surgical.tools[0];
  const auto plan = ShippedPlan();
  const auto guidance = MakeGuidance(plan.get(), DefaultGuidanceParams());
  OsteonGuidanceOutput output;
  const auto evaluate = [&](double height_m) {
    const OsteonPose pose = PoseOf(AlongThePlan(surgical, reamer, height_m));
    EXPECT_OK(osteon_guidance_evaluate(guidance.get(), &pose, nullptr, nullptr, &output));
  };
  for (int i = 0; i < 100; ++i) evaluate(-2e-3);
  EXPECT_EQ(output.share, 0.0);
  EXPECT_NEAR(output.depth_m, 2e-3, 1e-9);
  for (double h = -2e-3; h < 1e-3; h += 1e-5) evaluate(h);
  EXPECT_EQ(output.inside, 1U);
  EXPECT_EQ(output.share, 1.0);
  for (double h = 1e-3; h > -2e-3; h -= 1e-5) evaluate(h);
  EXPECT_GT(Vector3(output.wrench.force_N).dot(surgical.axis_G), 10.0) << "it pushes out";
  evaluate(-9e-3);
  EXPECT_EQ(output.jumped, 1U);
  EXPECT_EQ(Vector3(output.wrench.force_N), Vector3(0, 0, 0));
  evaluate(-9e-3);
  EXPECT_EQ(output.jumped, 0U);
  EXPECT_EQ(output.share, 0.0);
  ASSERT_OK(osteon_guidance_set_gain(guidance.get(), 0.25));
  for (double h = -9e-3; h < 1e-3; h += 1e-5) evaluate(h);
  EXPECT_EQ(output.share, 0.25);
  ASSERT_OK(osteon_guidance_reset(guidance.get()));
}

TEST(OsteonGuidance, NeitherAllocatesNorLocks) {
  const procedure::SurgicalPlan& surgical = LoadedPlan().plan;
  const auto plan = ShippedPlan();
  const auto guidance = MakeGuidance(plan.get(), DefaultGuidanceParams());
  std::vector<OsteonPose> poses;
  for (int i = 0; i < 500; ++i)
    poses.push_back(PoseOf(AlongThePlan(surgical, surgical.tools[0], 2e-3 - 1e-5 * i, 5e-4 * i)));
  const OsteonTwist twist{.linear_m_per_s = {0.0, 0.0, -0.01}, .angular_rad_per_s = {0.5, 0.0, 0.0}};
  const OsteonWrench other{.force_N = {0.0, 0.0, 30.0}, .torque_Nm = {}};
  OsteonGuidanceOutput output;
  rt::CheckedNoAllocScope scope;
  for (const OsteonPose& pose : poses)
    (void)osteon_guidance_evaluate(guidance.get(), &pose, &twist, &other, &output);
  (void)osteon_guidance_set_gain(guidance.get(), 0.5);
  (void)osteon_guidance_set_model_age(guidance.get(), 0.03);
  (void)osteon_guidance_reset(guidance.get());
  scope.End();
  EXPECT_EQ(output.inside, 0U);
}

// Reams the shipped cup with the plan's last reamer alone, tilted to the plan.
class OsteonAssess : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    OsteonBoneParams params;
    osteon_bone_params_default(&params);
    params.config_folder = ConfigFolder().c_str();
    ASSERT_OK(osteon_bone_create(OSTEON_ABI, &params, &bone_));
  }
  static void TearDownTestSuite() { osteon_bone_destroy(bone_); }
  void SetUp() override {
    OsteonToolParams params;
    osteon_tool_params_default(&params);
    params.diameter_m = 0.050;
    params.config_folder = ConfigFolder().c_str();
    OsteonTool* made = nullptr;
    ASSERT_OK(osteon_tool_create(OSTEON_ABI, &params, &made));
    tool.reset(made);
    session = MakeSession(bone_, tool.get(), Lockstep(false));
  }
  void Ream(double tilt_rad) {
    const procedure::SurgicalPlan& surgical = LoadedPlan().plan;
    const double spindle = osteon_tool_spindle_rad_per_s(tool.get());
    const auto step = [&](double height_m) {
      const OsteonPose pose = PoseOf(AlongThePlan(surgical, surgical.tools.back(), height_m, tilt_rad));
      ASSERT_OK(osteon_session_step(session.get(), &pose, spindle, 0.1));
    };
    for (double height_m = 25e-3; height_m > 10e-3; height_m -= 0.5e-3) step(height_m);
    for (double height_m = 10e-3; height_m > 0.0; height_m -= 50e-6) step(height_m);
    for (int i = 0; i < 600; ++i) step(0.0);  // 60 s, because the last tenths of a millimetre take long
  }
  static inline OsteonBone* bone_ = nullptr;
  Owned<OsteonTool> tool;
  Owned<OsteonSession> session;
};

TEST_F(OsteonAssess, ScoresWhatWasReamedAsPlanned) {
  Ream(0.0);
  const auto plan = ShippedPlan();
  OsteonAssessment found{};
  std::vector<OsteonScoreItem> items(16);
  std::size_t count = 0;
  ASSERT_OK(osteon_session_assess(session.get(), plan.get(), &found, items.data(), items.size(), &count));
  EXPECT_NEAR(found.diameter_m, 0.050, 0.1e-3);
  EXPECT_NEAR(found.axis_error_rad, 0.0, 1e-3);
  for (const double shift_m : {found.medial_m, found.superior_m, found.posterior_m})
    EXPECT_NEAR(shift_m, 0.0, 0.6e-3);
  // 7699 mm³ is the closed form for the full depth, which 60 s of cutting do not reach
  EXPECT_GT(found.removed_m3, 0.8 * 7699e-9);
  EXPECT_LT(found.removed_m3, 1.02 * 7699e-9);
  EXPECT_GT(found.score, 85.0);
  double points = 0.0;
  for (std::size_t i = 0; i < count; ++i) points += items[i].points;
  EXPECT_NEAR(points, found.score, 1e-9) << "no deduction";
  EXPECT_EQ(osteon_session_assess(session.get(), plan.get(), &found, items.data(), 2, &count),
            OSTEON_ERROR_BUFFER);
}

TEST_F(OsteonAssess, UsesTheAxisOfTheToolThatCut) {
  const auto plan = ShippedPlan();
  OsteonAssessment found{};
  Ream(14.0 * kDegree_rad);
  ASSERT_OK(osteon_session_assess(session.get(), plan.get(), &found, nullptr, 0, nullptr));
  EXPECT_NEAR(found.axis_error_rad, 14.0 * kDegree_rad, 0.3 * kDegree_rad);
  // after a change of tool, until the new tool cuts, the axis is still that of the tool that cut
  const OsteonPose out = PoseOf(AlongThePlan(LoadedPlan().plan, LoadedPlan().plan.tools.back(), 0.04));
  ASSERT_OK(osteon_session_change_tool(session.get(), tool.get(), &out));
  ASSERT_OK(osteon_session_assess(session.get(), plan.get(), &found, nullptr, 0, nullptr));
  EXPECT_NEAR(found.axis_error_rad, 14.0 * kDegree_rad, 0.3 * kDegree_rad);
}

TEST(OsteonAssessment, RefusesABoneOfAnotherPlan) {
  OsteonBoneParams params;
  osteon_bone_params_default(&params);
  const std::vector<float> ball{0.0F, 0.0F, 0.0F, 5.0F};
  params.balls_mm = ball.data();
  params.ball_count = 1;
  params.config_folder = ConfigFolder().c_str();
  params.site_axis[2] = -1.0;
  params.site_radius_m = 0.003;
  OsteonBone* made = nullptr;
  ASSERT_OK(osteon_bone_create(OSTEON_ABI, &params, &made));
  const Owned<OsteonBone> bone(made);
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const auto plan = ShippedPlan();
  OsteonAssessment found{};
  EXPECT_EQ(osteon_session_assess(session.get(), plan.get(), &found, nullptr, 0, nullptr),
            OSTEON_ERROR_ARGUMENT);
  EXPECT_NE(std::string(osteon_last_error()).find("off the scene's cup"), std::string::npos);
}

}  // namespace
}  // namespace osteon::plugin
