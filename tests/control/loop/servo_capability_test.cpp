// Tests the requirement that the loop renders no wrench that the arm's joint torques can't hold in the arm's
// present posture.

#include <gtest/gtest.h>

#include "kinematics/payload.h"
#include "servo_bench.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::control {
namespace {

using kinematics::JointVectorN;

// Torque limits of joint A2, which carries most of the hand's push. The first is sufficient for the push, the
// second is not.
constexpr double kStrong_Nm = 320.0, kWeak_Nm = 110.0;

// The bench's arm with this torque limit of A2. Each link has 4 kg, in a long link at its middle, and the
// tool has 2 kg.
kinematics::ChainParams<7> Body(double shoulder_Nm) {
  const kinematics::LbrParams lbr = kinematics::Iiwa14();
  const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ();
  const Vector3 axes[7] = {z, y, z, -y, z, y, z};
  const double lift_m[7] = {0.0, lbr.base_to_shoulder_m, 0.0, lbr.shoulder_to_elbow_m,
                            0.0, lbr.elbow_to_wrist_m,   0.0};
  const double middle_m[7] = {0.2, 0.0, 0.2, 0.0, 0.2, 0.0, 0.1};
  kinematics::ChainParams<7> chain;
  for (std::size_t i = 0; i < 7; ++i) {
    chain.joints[i].X_PJ = Eigen::Translation3d(0.0, 0.0, lift_m[i]) * Pose::Identity();
    chain.joints[i].axis_J = axes[i];
    chain.joints[i].limits = lbr.limits[i];
    chain.joints[i].link = {
        .mass_kg = 4.0, .p_LLcm_m = middle_m[i] * z, .I_LLcm_kg_m2 = 0.02 * Matrix3::Identity()};
  }
  chain.X_LF = Eigen::Translation3d(0.0, 0.0, lbr.wrist_to_flange_m) * Pose::Identity();
  chain.has_masses = true;
  chain.joints[1].limits.torque_Nm = shoulder_Nm;
  return kinematics::WithPayload(
      chain, {.mass_kg = 2.0, .p_LLcm_m = {0.0, 0.0, 0.08}, .I_LLcm_kg_m2 = 0.004 * Matrix3::Identity()});
}

// @param body  masses and torque limits of the arm; nothing: the loop does not limit by torque
ServoParams Params(std::optional<kinematics::ChainParams<7>> body) {
  ServoParams params = ServoBench::Params();
  params.max_tracking_error_m = 1.0;
  params.arm_body = std::move(body);
  return params;
}

// Largest ratio of a joint's torque to its limit, computed by the dynamics of the chain. The arm is at rest
// in this posture and exerts the record's coupling wrench at the tool.
double MaxTorqueRatio(const kinematics::ChainParams<7>& body, const JointArray& joints,
                      const TickRecord& record) {
  const kinematics::SerialChain<7> chain(body);
  const JointVectorN<7> q = Eigen::Map<const JointVectorN<7>>(joints.data()), zero = JointVectorN<7>::Zero();
  const Wrench F_T_W = record.F_coupling_T_W;
  const Vector3 p_FT_W = chain.FlangePose(q).linear() * ServoBench::FlangeToTool().translation();
  const Wrench reaction_F{.f = -F_T_W.f, .t = -F_T_W.t - p_FT_W.cross(F_T_W.f)};
  const JointVectorN<7> tau = chain.InverseDynamics(q, zero, zero, reaction_F);
  double max_ratio = 0.0;
  for (int i = 0; i < 7; ++i)
    max_ratio =
        std::max(max_ratio, std::abs(tau[i]) / body.joints[static_cast<std::size_t>(i)].limits.torque_Nm);
  return max_ratio;
}

struct PressResult {
  double max_torque_ratio{0.0};  ///< largest ratio of a joint's torque to its limit during the run
  /// largest sine of the angle between the limited force and the feed direction
  double off_direction{0.0};
  int limited_ticks{0}, ticks{0};
  TickRecord last;
  safety::LimitCount arm;  ///< how often the arm's torque limited the wrench
};

// A hand presses the tool against the plane with 150 N for 1.5 s.
PressResult Press(const ServoParams& params, const kinematics::ChainParams<7>& body) {
  ServoBench bench(params);
  bench.Activate();
  bench.push_N = 150.0;
  PressResult pressed;
  for (int i = 0; i < 1500; ++i) {
    // the tick computes its wrench for the posture before its own motion
    const JointArray posture = bench.command.q;
    pressed.last = bench.Tick();
    if (pressed.last.phase != Phase::kHaptic) continue;
    ++pressed.ticks;
    pressed.max_torque_ratio =
        std::max(pressed.max_torque_ratio, MaxTorqueRatio(body, posture, pressed.last));
    if (pressed.last.arm_share < 1.0) {
      ++pressed.limited_ticks;
      const Vector3 f = pressed.last.F_coupling_T_W.f;
      if (f.norm() > 1.0)
        pressed.off_direction = std::max(pressed.off_direction, f.normalized().cross(bench.feed_W).norm());
    }
    EXPECT_LE(pressed.last.wrench_scale, pressed.last.arm_share);
  }
  pressed.arm = bench.loop.statistics().limits.Of(safety::Limit::kArmTorque);
  return pressed;
}

TEST(ServoCapability, TheRenderedWrenchKeepsEveryJointWithinItsTorque) {
  const kinematics::ChainParams<7> body = Body(kWeak_Nm);
  const PressResult unlimited = Press(Params({}), body);
  ASSERT_GT(unlimited.max_torque_ratio, 1.05)
      << "the hand must ask for more than the arm has, or nothing is proven";
  EXPECT_EQ(unlimited.arm.ticks, 0u);

  const PressResult limited = Press(Params(body), body);
  ASSERT_GT(limited.limited_ticks, 50);
  EXPECT_EQ(limited.arm.ticks, static_cast<std::uint64_t>(limited.limited_ticks));
  EXPECT_LE(limited.max_torque_ratio, 1.0 + 1e-9) << "rounding of two ways to the same torque";
  EXPECT_LT(limited.off_direction, 1e-9) << "the wrench keeps its direction: the plane's normal";
}

TEST(ServoCapability, TheTorqueLimitOfAStrongArmChangesNothing) {
  const PressResult with = Press(Params(Body(kStrong_Nm)), Body(kStrong_Nm));
  const PressResult without = Press(Params({}), Body(kStrong_Nm));
  EXPECT_EQ(with.limited_ticks, 0);
  EXPECT_EQ(with.last.q_cmd, without.last.q_cmd);
  EXPECT_EQ(Vector3(with.last.F_coupling_T_W.f), Vector3(without.last.F_coupling_T_W.f));
}

TEST(ServoCapability, DoesNotAllocate) {
  ServoBench bench(Params(Body(kWeak_Nm)));
  bench.Activate();
  bench.push_N = 150.0;
  for (int i = 0; i < 500; ++i) {
    rt::CheckedNoAllocScope no_alloc;
    static_cast<void>(bench.Tick());
  }
}

struct LeadResult {
  double load_at_start{0.0},
      load_at_end{0.0};       ///< load that the last posture can hold, as a ratio to the wanted load
  std::vector<Vector3> path;  ///< tool position of each tick [m]
};
// A hand moves the tool to and fro in free air for 18 s. The wanted load is the largest load that the start
// posture can hold.
// @param load_speed_rad_per_s  speed at which the elbow turns toward postures that can hold more; 0: the
// elbow does not turn
LeadResult LeadToAndFro(double load_speed_rad_per_s) {
  const kinematics::ChainParams<7> body = Body(kStrong_Nm);
  kinematics::LoadTarget<7> wanted;
  wanted.load = {.axial_N = 1.0, .lateral_N = 0.2};
  wanted.p_F = ServoBench::FlangeToTool().translation();
  for (int i = 0; i < 7; ++i)
    wanted.torque_limit_Nm[i] = body.joints[static_cast<std::size_t>(i)].limits.torque_Nm;
  const kinematics::SerialChain<7> chain(body);
  const double held_N = kinematics::HeldLoad<7>(chain, wanted, ServoBench::StartJoints()).value;
  wanted.load = {.axial_N = held_N, .lateral_N = 0.2 * held_N};

  ServoParams params = Params(body);
  params.posture_load = wanted.load;
  params.posture.load_speed_rad_per_s = load_speed_rad_per_s;
  ServoBench bench(params, 0.5);
  bench.Activate();
  const Vector3 side_W = ServoBench::StartPose().linear().col(1);
  LeadResult led;
  led.load_at_start = kinematics::HeldLoad<7>(chain, wanted, ServoBench::StartJoints()).value;
  for (int i = 0; i < 18'000; ++i) {
    bench.side_W_N = 5.0 * std::sin(2.0 * 3.141592653589793 * i / 1000.0) * side_W;
    led.path.emplace_back(bench.Tick().X_WT_cmd.p);
    EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
  }
  led.load_at_end =
      kinematics::HeldLoad<7>(chain, wanted, Eigen::Map<const JointVectorN<7>>(bench.command.q.data())).value;
  return led;
}

TEST(ServoCapability, TheElbowTurnsToHoldMoreLoadWithoutMovingTheTool) {
  const LeadResult still = LeadToAndFro(0.0), turning = LeadToAndFro(0.3);
  EXPECT_NEAR(still.load_at_start, 1.0, 1e-9);
  EXPECT_GT(turning.load_at_end, still.load_at_end + 0.05);
  double apart_m = 0.0;
  for (std::size_t i = 0; i < turning.path.size(); ++i)
    apart_m = std::max(apart_m, (turning.path[i] - still.path[i]).norm());
  EXPECT_LT(apart_m, 1e-5) << "a tick's third order, over 18 s";
}

TEST(ServoCapability, RefusesAnArmWithoutTorqueLimits) {
  kinematics::ChainParams<7> body = Body(kStrong_Nm);
  body.joints[3].limits.torque_Nm = 0.0;
  try {
    ServoBench bench(Params(body));
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("joint 4: found 0"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace osteon::control
