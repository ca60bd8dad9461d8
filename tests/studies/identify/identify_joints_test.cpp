#include "studies/identify/identify_joints.h"

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "session/setup/cell_setup.h"
#include "studies/identify/excited_run.h"
#include "studies/identify/identify_estimate.h"
#include "studies/identify/identify_page.h"
#include "tests/temporary_path.h"

// Identifies joints of the shipped cells, excited one at a time in virtual time: two draws of two periods
// each, 24 s.

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

session::CellSetup CellNamed(const std::string& name) {
  auto setup =
      session::PrepareCell(fs::path(OSTEON_SOURCE_DIR) / "config/cells" / (name + ".yaml"), std::nullopt);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error());
  return std::move(*setup);
}

ExcitationRequest JointRequest(int joint, double peak_rad_per_s = 0.15) {
  return {.peak_speed_m_per_s = peak_rad_per_s, .seed = 1, .draws = 2, .periods = 2, .joint = joint};
}

// Excites a joint and adds its estimates to the result.
void AddJoint(const session::CellSetup& setup, const ExcitationRequest& request, IdentifyResult& result) {
  const fs::path file = TemporaryPath("joint.mcap");
  const auto run = RunExcited(setup, {.request = request, .recording = file});
  ASSERT_TRUE(run) << run.error();
  const auto added = AddRecording(file, setup.config, result);
  ASSERT_TRUE(added) << added.error();
}

// Expects the joint's estimates at the truth: within 0.5 %, and 0.02 ms of lag, as for an axis of the tool.
void ExpectTruth(const AxisResult& joint, const hil::ServoArmParams& truth, double period_s) {
  const std::string name = NameOf(joint.request);
  EXPECT_NEAR(joint.fit.bandwidth_hz.value, truth.bandwidth_hz, 0.005 * truth.bandwidth_hz) << name;
  EXPECT_NEAR(joint.fit.damping_ratio.value, truth.damping_ratio, 0.005 * truth.damping_ratio) << name;
  const double lag_s =
      truth.dead_cycles * period_s + truth.damping_ratio / (std::numbers::pi * truth.bandwidth_hz);
  EXPECT_NEAR(joint.fit.lag_s.value, lag_s, 0.02e-3) << name;
  EXPECT_NEAR(joint.fit.gain.value, 1.0, 0.005) << name;
  EXPECT_TRUE(joint.model_holds) << name;
}

TEST(IdentifyJoints, EachJointOfAnLbrIsIdentifiedAsSimulated) {
  const session::CellSetup setup = CellNamed("demo");
  IdentifyResult result = EmptyResult("demo", setup.config);
  for (int joint = 1; joint <= 7; ++joint) AddJoint(setup, JointRequest(joint), result);
  JudgeJoints(result);
  ASSERT_TRUE(result.refused.empty()) << result.refused.front().where << result.refused.front().what;
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front().where << result.warnings.front().what;
  EXPECT_TRUE(result.axes.empty());
  ASSERT_EQ(result.joints.size(), 7u);
  for (const AxisResult& joint : result.joints)
    ExpectTruth(joint, setup.config.simulated.servo, setup.config.servo.period_s);

  const auto json = nlohmann::json::parse(ToJson(result, "osteon identify"));
  ASSERT_EQ(json.at("joints").size(), 7u);
  const auto& last = json.at("joints").at(6);
  EXPECT_EQ(last.at("joint"), "A7");
  EXPECT_NEAR(last.at("hz").get<double>(), setup.config.simulated.servo.bandwidth_hz, 0.1);
  for (const char* key : {"speed_deg_per_s", "damping_ratio", "dead_time_ms", "lag_ms", "gain", "interval",
                          "chi2", "residual", "odd_ratio", "even_ratio"})
    EXPECT_TRUE(last.contains(key)) << key;
  EXPECT_LT(last.at("interval").at("lag_ms").at(0), last.at("lag_ms"));
  EXPECT_EQ(last.at("frf").size(), 27u);
  EXPECT_NE(IdentifyPage(result, "").find("Joint A7 at "), std::string::npos);
  EXPECT_NE(IdentifyPage(result, "").find("The joints, each moved alone"), std::string::npos);
  EXPECT_EQ(Judge(result).level, session::VerdictLevel::kGood);
}

TEST(IdentifyJoints, AJointOfAKrIsIdentifiedAsSimulated) {
  const session::CellSetup setup = CellNamed("kr_16_thin_plate");
  ASSERT_TRUE(setup.config.simulated.kr);
  IdentifyResult result = EmptyResult("kr", setup.config);
  for (const int joint : {1, 5}) AddJoint(setup, JointRequest(joint), result);
  JudgeJoints(result);
  ASSERT_TRUE(result.refused.empty()) << result.refused.front().where << result.refused.front().what;
  ASSERT_EQ(result.joints.size(), 2u);
  for (const AxisResult& joint : result.joints)
    ExpectTruth(joint, setup.config.simulated.kr->controller.servo, setup.config.servo.period_s);
  EXPECT_EQ(JointCount(setup.config), 6);
  const auto none = ExcitedAxisOf(setup.config, JointRequest(7));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error(), "found joint A7, accepted A1 … A6");
}

// An arm with masses, and with friction that the controller does not compensate. At 2 % of their speed its
// joints stick and must be refused; otherwise the fit would give absurd values (687 Hz and zeta 67 for A1 in
// a prototype).
TEST(IdentifyJoints, JointsThatStickAtASlowMotionAreRefused) {
  session::CellSetup setup = CellNamed("demo");
  setup.config.simulated.level = hil::ArmLevel::kDynamic;
  setup.config.simulated.dynamic.friction_compensation = 0.0;
  setup.config.simulated.dynamic.mount.reset();
  const auto& joints = setup.config.robot.lbr()->chain.joints;
  for (const int joint : {1, 5, 6, 7}) {
    IdentifyResult result = EmptyResult("demo", setup.config);
    const double slow = 0.02 * joints[static_cast<std::size_t>(joint - 1)].limits.velocity_rad_per_s;
    AddJoint(setup, JointRequest(joint, slow), result);
    JudgeJoints(result);
    std::string why;
    for (const auto* findings : {&result.refused, &result.warnings})
      for (const Finding& finding : *findings) why += finding.what + "\n";
    EXPECT_FALSE(result.refused.empty()) << "A" << joint << ": " << why;
    EXPECT_NE(why.find("the joint sticks"), std::string::npos) << "A" << joint << ": " << why;
  }
}

TEST(IdentifyJoints, LagsThatDifferBetweenJointsAreWarnedAbout) {
  IdentifyResult result{.cell = "demo", .valid_for = {}, .axes = {}};
  for (const int joint : {1, 2}) {
    AxisResult& found = result.joints.emplace_back();
    found.request = JointRequest(joint);
    found.by_encoders = {.lines = {{.hz = 0.75, .value = 1.0}}, .draws = 2, .periods = 4};
    found.fit = {.damping_ratio = {1.0}, .lag_s = {joint == 1 ? 0.024 : 0.026}, .chi2 = 1.0};
  }
  JudgeJoints(result);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_NE(result.warnings[0].what.find("found 24.00 ms of A1 and 26.00 ms of A2, accepted 5 %"),
            std::string::npos)
      << result.warnings[0].what;
  result.warnings.clear();
  result.joints[1].fit.lag_s.value = 0.0249;
  JudgeJoints(result);
  EXPECT_TRUE(result.warnings.empty());
}

TEST(ExcitedAxis, AJointsExcitationKeepsTheLimitsOfJointAndTool) {
  const session::CellSetup setup = CellNamed("demo");
  const auto& joints = setup.config.robot.lbr()->chain.joints;
  for (int joint = 1; joint <= 7; ++joint) {
    const auto axis = ExcitedAxisOf(setup.config, JointRequest(joint, 10.0));
    ASSERT_TRUE(axis) << axis.error();
    const control::MultisineState peak = control::ExcitationPath(axis->hold.path, axis->hold.period_s).peak();
    const auto& limits = joints[static_cast<std::size_t>(joint - 1)].limits;
    const double tool_m_per_rad = axis->hold.J_W.col(joint - 1).norm();
    EXPECT_LE(peak.x_m, 1.001 * kMaxJointTravel_rad);
    EXPECT_LE(peak.v_m_per_s, 1.001 * 0.2 * limits.velocity_rad_per_s);
    EXPECT_LE(peak.a_m_per_s2, 1.001 * 2.0 * limits.acceleration_rad_per_s2);
    EXPECT_LE(peak.v_m_per_s * tool_m_per_rad, 0.1001);
    EXPECT_LE(peak.a_m_per_s2 * tool_m_per_rad, 8.01);
    EXPECT_GT(peak.v_m_per_s, 0.05) << "A" << joint;
  }
}

TEST(ExcitedAxis, AJointIsStoredInTheRecordingsEvent) {
  const std::string text = EventText(JointRequest(3));
  const auto back = ParseEvent(text);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->joint, 3);
  EXPECT_EQ(back->peak_speed_m_per_s, 0.15);
  EXPECT_EQ(EventText(*back), text);
  EXPECT_EQ(EventText({.axis = 'x'}).find("joint"), std::string::npos) << "as before";
  for (const char* wrong : {"\"joint\":0", "\"joint\":8", "\"joint\":-1"})
    EXPECT_FALSE(ParseEvent(std::string(text).replace(text.find("\"joint\":3"), 9, wrong))) << wrong;
}

TEST(ExcitedRun, AnObstacleOnAJointsPathIsRefused) {
  session::CellSetup setup = CellNamed("demo");
  simulation::Ball obstacle = setup.bone.balls.front();
  const Pose X_WF = setup.config.start.X_WT * setup.config.tool.X_FT.inverse();
  // The nearest point of this ball is 70 mm beside the flange's axis, and the flange's radius is 65 mm. The
  // flange is clear of the ball at the start and hits it within a degree.
  const Vector3 sideways = setup.config.X_WB.linear() * Vector3::UnitY();
  const Vector3 center_G = setup.X_WG.inverse() * (X_WF.translation() + 0.071 * sideways);
  obstacle.center_m = center_G;
  obstacle.radius_m = 0.001;
  setup.bone.balls.push_back(obstacle);
  const auto run = RunExcited(setup, {.request = JointRequest(1), .recording = TemporaryPath("way.mcap")});
  ASSERT_FALSE(run);
  EXPECT_TRUE(run.error().starts_with("the way of joint A1: ")) << run.error();
  EXPECT_NE(run.error().find("the flange"), std::string::npos) << run.error();
}

}  // namespace
}  // namespace osteon::studies
