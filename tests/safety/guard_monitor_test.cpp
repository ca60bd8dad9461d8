#include "safety/guard_monitor.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "guard_bench.h"
#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::safety {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(),
                 kInfinity = std::numeric_limits<double>::infinity();

GuardFinding Found(const GuardBench& bench) { return bench.monitor.reason().finding; }

// Sends one bad answer to an arm that follows: the guard must withhold it with this finding, and pass nothing
// more.
void ExpectWithheld(const GuardCommand& command, GuardFinding finding,
                    const GuardParams& params = GuardBench::Params()) {
  GuardBench bench(params);
  ASSERT_TRUE(bench.RunUntilArmFollows());
  ASSERT_EQ(bench.Message(GuardSession::kActive), GuardDecision::kPass);
  EXPECT_EQ(bench.Answer(command), GuardDecision::kWithhold) << Describe(bench.monitor.reason());
  EXPECT_EQ(Found(bench), finding) << Describe(bench.monitor.reason());
  EXPECT_FALSE(bench.monitor.permits());
  // the finding is latched: not even a harmless command passes
  bench.Message(GuardSession::kActive);
  EXPECT_EQ(bench.Answer(GuardBench::StartJoints()), GuardDecision::kWithhold);
  EXPECT_EQ(Found(bench), finding);
}

// The start posture with one joint moved.
GuardCommand Moved(int joint, double by_rad) {
  GuardCommand command{.q = GuardBench::StartJoints()};
  (*command.q)[static_cast<std::size_t>(joint)] += by_rad;
  return command;
}

TEST(GuardMonitor, PassesEveryCommandOfAMotionWithinTheLimits) {
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  // all joints swing; the apex reaches some 200 mm/s
  for (int i = 0; i < 20'000; ++i) {
    ASSERT_EQ(bench.Message(GuardSession::kActive), GuardDecision::kPass);
    GuardJoints q = GuardBench::StartJoints();
    for (std::size_t j = 0; j < 7; ++j)
      q[j] += 0.03 * (1.0 - std::cos(2e-3 * i * (1.0 + 0.1 * static_cast<double>(j))));
    if (i % 7 == 3 || i % 101 < 3) continue;  // lost answers
    ASSERT_EQ(bench.Answer(q), GuardDecision::kPass) << i << ": " << Describe(bench.monitor.reason());
  }
  EXPECT_TRUE(bench.monitor.permits());
  EXPECT_EQ(bench.monitor.counters().withheld + bench.monitor.counters().late, 0u);
}

TEST(GuardMonitor, WithholdsWhatIsNotFinite) {
  for (const double wild : {kNaN, kInfinity, -kInfinity}) {
    ExpectWithheld(Moved(3, wild), GuardFinding::kNotFinite);
    GuardCommand command = Moved(0, 0.0);
    command.wrench = {0.0, 0.0, 0.0, 0.0, wild, 0.0};
    ExpectWithheld(command, GuardFinding::kNotFinite);
    command = Moved(0, 0.0);
    command.tau = {0.0, wild, 0.0, 0.0, 0.0, 0.0, 0.0};
    ExpectWithheld(command, GuardFinding::kNotFinite);
  }
}

TEST(GuardMonitor, HoldsEachJointToItsSpeedAndItsRange) {
  const auto& limits = kinematics::Iiwa14().limits;
  GuardParams params = GuardBench::Params();
  params.max_speed_m_per_s = params.max_start_path_speed_m_per_s = params.max_turn_rad_per_s = 100.0;
  for (int joint = 0; joint < 7; ++joint) {
    const double step_rad = limits[static_cast<std::size_t>(joint)].velocity_rad_per_s * params.period_s;
    ExpectWithheld(Moved(joint, 1.01 * step_rad), GuardFinding::kJointSpeed, params);
    ExpectWithheld(Moved(joint, 1e308), GuardFinding::kJointPosition, params);
    GuardBench bench(params);
    ASSERT_TRUE(bench.RunUntilArmFollows());
    bench.Message(GuardSession::kActive);
    EXPECT_EQ(bench.Answer(Moved(joint, -0.99 * step_rad)), GuardDecision::kPass)
        << Describe(bench.monitor.reason());
  }
}

TEST(GuardMonitor, HoldsTheToolToItsLinearAndAngularSpeed) {
  const GuardParams params = GuardBench::Params();
  // A1 turns the whole arm: the apex' speed is proportional to its distance from that axis
  const Vector3 p = GuardBench::Start().translation();
  const double most_rad =
      (1.0 + params.margin) * params.max_speed_m_per_s * params.period_s / std::hypot(p.x(), p.y());
  ExpectWithheld(Moved(0, 1.01 * most_rad), GuardFinding::kToolSpeed);
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  bench.Message(GuardSession::kActive);
  EXPECT_EQ(bench.Answer(Moved(0, 0.99 * most_rad)), GuardDecision::kPass)
      << Describe(bench.monitor.reason());
  // A7 turns the tool about its own axis
  ExpectWithheld(Moved(6, 1.01 * (1.0 + params.margin) * params.max_turn_rad_per_s * params.period_s),
                 GuardFinding::kToolTurn);
}

// Steps of 0.1 mrad, each harmless, lead out of the sphere (A1) or below the plane (A2).
TEST(GuardMonitor, StopsASlowMotionAtTheSphereAndAtThePlane) {
  for (const int joint : {0, 1}) {
    GuardBench bench;
    ASSERT_TRUE(bench.RunUntilArmFollows());
    GuardJoints q = GuardBench::StartJoints();
    int passed = 0;
    for (; passed < 100'000; ++passed) {
      bench.Message(GuardSession::kActive);
      q[static_cast<std::size_t>(joint)] += 1e-4;
      if (bench.Answer(q) != GuardDecision::kPass) break;
    }
    EXPECT_EQ(Found(bench), joint == 0 ? GuardFinding::kWorkspace : GuardFinding::kPlane);
    const Vector3 p = GuardBench::ToolPose(q).translation(), start = GuardBench::Start().translation();
    const double out_m = joint == 0 ? (p - start).norm() - 0.15 : start.z() - 0.1 - p.z();
    EXPECT_NEAR(out_m, GuardBench::Params().workspace_margin_m, 1e-4) << "the first step beyond";
  }
}

TEST(GuardMonitor, StopsASlowMotionAtTheZonesOfFlangeAndElbow) {
  const kinematics::LbrArm arm(kinematics::Iiwa14());
  for (const ZonePoint point : {ZonePoint::kFlange, ZonePoint::kElbow}) {
    const auto place = [&](const GuardJoints& joints) {
      const kinematics::JointVector q = Eigen::Map<const kinematics::JointVector>(joints.data());
      return point == ZonePoint::kElbow ? arm.Points(q).p_BElbow : Vector3(arm.FlangePose(q).translation());
    };
    const Vector3 start = place(GuardBench::StartJoints());
    GuardParams params = GuardBench::Params();
    params.workspace.zones = {
        {.shape = ZoneShape::kSphere, .point = point, .p_W_m = start, .radius_m = 0.02}};
    GuardBench bench(params);
    ASSERT_TRUE(bench.RunUntilArmFollows());
    GuardJoints q = GuardBench::StartJoints();
    for (int passed = 0; passed < 10'000; ++passed) {
      bench.Message(GuardSession::kActive);
      q[0] += 1e-4;
      if (bench.Answer(q) != GuardDecision::kPass) break;
    }
    EXPECT_EQ(Found(bench), GuardFinding::kZone);
    EXPECT_NEAR((place(q) - start).norm(), 0.02 + params.workspace_margin_m, 1e-4) << "the first step beyond";
  }
}

// A zone binds if the arm was inside it when the arm was handed over to the PC. Here the first command is
// already beyond the zone's bound, but within the guard's margin, and must pass.
TEST(GuardMonitor, StopsASlowMotionOutOfAZoneInWhichTheArmWasHandedOver) {
  GuardParams params = GuardBench::Params();
  params.workspace.zones = {
      {.shape = ZoneShape::kSphere, .p_W_m = GuardBench::Start().translation(), .radius_m = 1e-5}};
  GuardBench bench(params);
  ASSERT_TRUE(bench.RunUntilArmFollows());
  GuardJoints q = GuardBench::StartJoints();
  int passed = 0;
  for (; passed < 1000; ++passed) {
    bench.Message(GuardSession::kActive);
    q[0] += 1e-4;
    if (bench.Answer(q) != GuardDecision::kPass) break;
  }
  EXPECT_EQ(Found(bench), GuardFinding::kZone);
  EXPECT_GT(passed, 10);
}

TEST(GuardMonitor, AnArmThatStartsOutsideMayComeInButNotGoOutAgain) {
  GuardParams params = GuardBench::Params();
  params.workspace.sphere_center_W_m.y() += 0.25;  // 0.1 m beyond the sphere
  GuardBench bench(params);
  ASSERT_TRUE(bench.RunUntilArmFollows());
  GuardJoints q = GuardBench::StartJoints();
  const auto go = [&](double step_rad, int steps) {
    for (int i = 0; i < steps; ++i) {
      bench.Message(GuardSession::kActive);
      q[0] += step_rad;
      if (bench.Answer(q) != GuardDecision::kPass) return false;
    }
    return true;
  };
  EXPECT_TRUE(go(0.0, 10)) << "it may stand there";
  EXPECT_TRUE(go(2e-4, 1500)) << Describe(bench.monitor.reason());
  EXPECT_FALSE(go(-2e-4, 3000));
  EXPECT_EQ(Found(bench), GuardFinding::kWorkspace);
}

// A compliant arm sags when it is handed over to the PC. The controller then commands the measured posture as
// fast as the joints' speed limits permit, which is faster than the tool's speed limit.
TEST(GuardMonitor, ACompliantArmMayStepFasterOnlyTowardItsMeasuredPosture) {
  const auto judge = [](bool compliant, double measured_rad, double step_rad) {
    GuardBench bench;
    EXPECT_TRUE(bench.RunUntilArmFollows());
    bench.arm.compliant = compliant;
    bench.arm.q_meas[0] += measured_rad;
    bench.Message(GuardSession::kActive);
    (void)bench.Answer(Moved(0, step_rad));
    return Found(bench);
  };
  EXPECT_EQ(judge(true, 0.01, 1.4e-3), GuardFinding::kNone) << "1 m/s of the apex";
  EXPECT_EQ(judge(false, 0.01, 1.4e-3), GuardFinding::kToolSpeed) << "in position control it would jump";
  EXPECT_EQ(judge(true, -0.01, 1.4e-3), GuardFinding::kToolSpeed) << "away from where it is";
  EXPECT_EQ(judge(true, 1e-3, 1.4e-3), GuardFinding::kToolSpeed) << "beyond where it is";
  EXPECT_EQ(judge(true, 0.01, 2e-3), GuardFinding::kJointSpeed);
}

TEST(GuardMonitor, ThePathToTheStartHasItsOwnSpeedLimitUntilTheStartIsReached) {
  GuardParams params = GuardBench::Params();
  params.max_speed_m_per_s = 0.1;
  params.q_start = GuardBench::StartJoints();
  (*params.q_start)[0] += 0.05;
  GuardBench bench(params);
  ASSERT_TRUE(bench.RunUntilArmFollows());
  const auto go = [&](double step_rad, int steps) {
    for (int i = 1; i <= steps; ++i) {
      bench.Message(GuardSession::kActive);
      GuardJoints q = bench.arm.q_meas;
      q[0] += step_rad;
      if (bench.Answer(q) != GuardDecision::kPass) return i;
    }
    return 0;
  };
  EXPECT_EQ(go(2.5e-4, 190), 0) << "some .18 m/s, to the start: " << Describe(bench.monitor.reason());
  EXPECT_EQ(go(1e-4, 100), 0);
  EXPECT_EQ(go(-2.5e-4, 1), 1);
  EXPECT_EQ(Found(bench), GuardFinding::kToolSpeed);
}

TEST(GuardMonitor, FindsAnArmThatDoesNotFollow) {
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  GuardJoints q = GuardBench::StartJoints();
  GuardDecision decision = GuardDecision::kPass;
  for (int i = 0; i < 10'000 && decision == GuardDecision::kPass; ++i) {
    bench.Message(GuardSession::kActive);
    q[0] += 1e-4;
    decision = bench.Answer(q);
    bench.arm.q_meas = GuardBench::StartJoints();
  }
  EXPECT_EQ(Found(bench), GuardFinding::kTracking);
  EXPECT_NEAR((GuardBench::ToolPose(q).translation() - GuardBench::Start().translation()).norm(), 1.25 * 0.03,
              1e-4);
}

TEST(GuardMonitor, HoldsForcesToTheCellsLimitWithoutAnyMargin) {
  GuardCommand command = Moved(0, 0.0);
  command.wrench = {0.0, 160.0, 120.0, 0.0, 0.0, 20.0};  // 200 N, 20 N·m
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  bench.Message(GuardSession::kActive);
  EXPECT_EQ(bench.Answer(command), GuardDecision::kPass) << Describe(bench.monitor.reason());
  command.wrench = {0.0, 160.1, 120.0, 0.0, 0.0, 0.0};
  ExpectWithheld(command, GuardFinding::kForce);
  command.wrench = {1e308, 1e308, 1e308, 0.0, 0.0, 0.0};
  ExpectWithheld(command, GuardFinding::kForce);
  command.wrench = {0.0, 0.0, 0.0, 15.0, 15.0, 0.0};
  ExpectWithheld(command, GuardFinding::kTorque);
  // torques that no wrench within the limits needs: at A7 20 N·m, because force has no lever there
  command.wrench.reset();
  command.tau = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.1};
  ExpectWithheld(command, GuardFinding::kJointTorque);
}

TEST(GuardMonitor, TorquesOfAWrenchWithinTheLimitsAlwaysPass) {
  const kinematics::SerialChain<7> chain(GuardBench::Params().arm);
  const GuardJoints q = GuardBench::StartJoints();
  const auto posture = chain.ComputePosture(Eigen::Map<const kinematics::JointVector>(q.data()));
  const auto J = chain.JacobianAt(posture, posture.X_BF * GuardBench::Params().X_FT.translation());
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  for (int i = 0; i < 500; ++i) {
    Eigen::Matrix<double, 6, 1> F;
    F << 200.0 * Vector3(std::cos(i), std::sin(i) * std::cos(3.0 * i), std::sin(i) * std::sin(3.0 * i)),
        20.0 * Vector3(std::sin(2.0 * i), std::cos(2.0 * i), 0.0);
    GuardCommand command{.q = q};
    Eigen::Map<kinematics::JointVector>(command.tau.emplace().data()) = J.transpose() * F;
    bench.Message(GuardSession::kActive);
    ASSERT_EQ(bench.Answer(command), GuardDecision::kPass) << Describe(bench.monitor.reason());
  }
}

TEST(GuardMonitor, PassesAnswersToTheNewestMessageOnceAndInTime) {
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  bench.Message(GuardSession::kActive);
  const GuardCommand old{.sequence = 90, .reflected = bench.arm.sequence, .q = GuardBench::StartJoints()};
  bench.Message(GuardSession::kActive);
  EXPECT_EQ(bench.monitor.OnCommand(old, bench.now), GuardDecision::kDrop) << "overtaken";
  const GuardCommand answer{.sequence = 91, .reflected = bench.arm.sequence, .q = GuardBench::StartJoints()};
  EXPECT_EQ(bench.monitor.OnCommand(answer, bench.now + 6 * rt::kMillisecond), GuardDecision::kDrop)
      << "too old";
  EXPECT_EQ(bench.monitor.OnCommand(answer, bench.now), GuardDecision::kPass);
  EXPECT_EQ(bench.monitor.OnCommand(answer, bench.now), GuardDecision::kDrop) << "replayed";
  EXPECT_EQ(bench.monitor.counters().late, 2u);
  EXPECT_EQ(bench.monitor.counters().duplicate, 1u);
  EXPECT_TRUE(bench.monitor.permits()) << "what is late is no lie";
  bench.Message(GuardSession::kActive);
  GuardCommand back{.sequence = 91, .reflected = bench.arm.sequence, .q = GuardBench::StartJoints()};
  EXPECT_EQ(bench.monitor.OnCommand(back, bench.now), GuardDecision::kWithhold);
  EXPECT_EQ(Found(bench), GuardFinding::kSequence);

  GuardBench other;
  ASSERT_TRUE(other.RunUntilArmFollows());
  other.Message(GuardSession::kActive);
  GuardCommand ahead{.sequence = 99, .reflected = other.arm.sequence + 1, .q = GuardBench::StartJoints()};
  EXPECT_EQ(other.monitor.OnCommand(ahead, other.now), GuardDecision::kWithhold);
  EXPECT_EQ(Found(other), GuardFinding::kNeverSent);
}

TEST(GuardMonitor, DropsMessagesOfTheArmThatAreNotNewAndAcceptsANewSession) {
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  EXPECT_EQ(bench.monitor.OnArmMessage(bench.arm, bench.now), GuardDecision::kDrop);
  bench.arm.sequence -= 3;
  EXPECT_EQ(bench.Message(GuardSession::kWaiting), GuardDecision::kDrop);
  bench.arm.sequence = 0;
  EXPECT_EQ(bench.Message(GuardSession::kMonitoring), GuardDecision::kPass);
  EXPECT_EQ(bench.Answer(GuardBench::StartJoints()), GuardDecision::kPass);
}

TEST(GuardMonitor, WithdrawsItsPermitIfTheControllerFallsSilentWhileTheArmMoves) {
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  for (int i = 1; i <= 5; ++i) {
    bench.Message(GuardSession::kActive);
    ASSERT_EQ(bench.Answer(Moved(0, 1e-4 * i)), GuardDecision::kPass);
  }
  // the arm ends commanding after 20 messages without an answer, as real arms do
  for (int i = 1; i <= 51; ++i) {
    bench.Message(i < 20 ? GuardSession::kActive : GuardSession::kMonitoring);
    bench.monitor.CheckSilence(bench.now);
    EXPECT_FALSE(bench.monitor.latched()) << i << " ms";
  }
  bench.monitor.CheckSilence(bench.now + 1'000'001);
  EXPECT_EQ(Found(bench), GuardFinding::kSilence);
  EXPECT_FALSE(bench.monitor.permits());
}

TEST(GuardMonitor, AControllerThatFallsSilentWithTheArmAtRestMayComeBack) {
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  for (int i = 1; i <= 5; ++i) {
    bench.Message(GuardSession::kActive);
    ASSERT_EQ(bench.Answer(Moved(0, 1e-4 * std::min(i, 4))), GuardDecision::kPass);
  }
  for (int i = 0; i < 100; ++i) {
    bench.Message(GuardSession::kMonitoring);
    bench.monitor.CheckSilence(bench.now);
  }
  EXPECT_FALSE(bench.monitor.latched());
  EXPECT_FALSE(bench.monitor.permits());
  bench.sequence = 0;  // the controller was started anew
  EXPECT_EQ(bench.Answer(GuardBench::StartJoints()), GuardDecision::kPass);
  EXPECT_TRUE(bench.monitor.permits());
}

TEST(GuardMonitor, TheGuardsOwnDelayDoesNotCountAsTheControllersSilence) {
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  bench.Message(GuardSession::kActive);
  ASSERT_EQ(bench.Answer(Moved(0, 1e-4)), GuardDecision::kPass);
  bench.Message(GuardSession::kActive);  // arrives, then the guard stalls
  bench.now += 100 * rt::kMillisecond;
  bench.monitor.CheckSilence(bench.now);
  EXPECT_TRUE(bench.monitor.permits());
  bench.monitor.CheckSilence(bench.now + 51 * rt::kMillisecond);
  EXPECT_EQ(Found(bench), GuardFinding::kSilence);
}

TEST(GuardMonitor, TheArmsSilenceDoesNotCountAsTheControllers) {
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  bench.Message(GuardSession::kActive);
  ASSERT_EQ(bench.Answer(Moved(0, 1e-4)), GuardDecision::kPass);
  bench.monitor.CheckSilence(bench.now + 10 * rt::kSecond);
  EXPECT_TRUE(bench.monitor.permits());
}

TEST(GuardMonitor, FindsAHandForceBeyondItsLimitFromTheArmsTorques) {
  const kinematics::SerialChain<7> chain(GuardBench::Params().arm);
  const auto J = chain.Jacobian(
      chain.ComputePosture(Eigen::Map<const kinematics::JointVector>(GuardBench::StartJoints().data())));
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  const auto push = [&](double force_N, int messages) {
    Eigen::Matrix<double, 6, 1> F;
    F << force_N * Vector3(2.0, -1.0, 2.0) / 3.0, Vector3(5.0, 10.0, -5.0);
    Eigen::Map<kinematics::JointVector>(bench.arm.tau_ext.emplace().data()) = J.transpose() * F;
    for (int i = 0; i < messages; ++i) {
      bench.Message(GuardSession::kActive);
      (void)bench.Answer(GuardBench::StartJoints());
    }
  };
  push(1.25 * 250.0 * 0.98, 100);
  push(1.25 * 250.0 * 1.02, 4);
  push(100.0, 1);
  EXPECT_FALSE(bench.monitor.latched()) << Describe(bench.monitor.reason());
  push(1.25 * 250.0 * 1.02, 5);
  EXPECT_EQ(Found(bench), GuardFinding::kHandForce);
}

TEST(GuardMonitor, RefusesAnswersWithoutAPositionOrWithACartesianPose) {
  ExpectWithheld({}, GuardFinding::kNoPosition);
  GuardCommand cartesian = Moved(0, 0.0);
  cartesian.cartesian = true;
  ExpectWithheld(cartesian, GuardFinding::kCartesian);
  GuardBench bench;
  bench.Message(GuardSession::kWaiting);
  EXPECT_EQ(bench.Answer(Moved(2, 0.021)), GuardDecision::kWithhold);
  EXPECT_EQ(Found(bench), GuardFinding::kNotMirrored);
}

TEST(GuardMonitor, DescribesEveryFindingInALineWithFoundAndAccepted) {
  for (int i = 1; i < kGuardFindings; ++i) {
    const std::string text = Describe(GuardReason{.finding = static_cast<GuardFinding>(i), .joint = 4});
    EXPECT_NE(text.find("found "), std::string::npos) << i << text;
    EXPECT_NE(text.find("accepted "), std::string::npos) << i << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

TEST(GuardMonitor, NamesEachParameterThatIsNotPositiveAndFinite) {
  const std::pair<const char*, double GuardParams::*> positive[] = {
      {"period_s", &GuardParams::period_s},
      {"max_speed_m_per_s", &GuardParams::max_speed_m_per_s},
      {"max_turn_rad_per_s", &GuardParams::max_turn_rad_per_s},
      {"tolerance_rad", &GuardParams::tolerance_rad},
      {"max_start_path_speed_m_per_s", &GuardParams::max_start_path_speed_m_per_s},
      {"max_tracking_error_m", &GuardParams::max_tracking_error_m},
      {"mirror_rad", &GuardParams::mirror_rad},
      {"max_force_N", &GuardParams::max_force_N},
      {"max_torque_Nm", &GuardParams::max_torque_Nm},
      {"max_hand_force_N", &GuardParams::max_hand_force_N},
      {"answer_age_s", &GuardParams::answer_age_s},
      {"silence_s", &GuardParams::silence_s},
      {"joint_speed_share", &GuardParams::joint_speed_share}};
  for (const auto& [name, field] : positive)
    for (const double none : {0.0, -1.0, kNaN, std::numeric_limits<double>::infinity()}) {
      GuardParams params = GuardBench::Params();
      params.*field = none;
      try {
        const GuardMonitor monitor(params);
        ADD_FAILURE() << name << ": " << none << " was accepted";
      } catch (const std::invalid_argument& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with(std::string("guard: ") + name + ": found "))
            << error.what();
      }
    }
}

TEST(GuardMonitor, RefusesParametersOutOfRange) {
  const auto refuses = [](auto change) {
    GuardParams params = GuardBench::Params();
    change(params);
    EXPECT_THROW(GuardMonitor{params}, std::invalid_argument);
  };
  refuses([](GuardParams& p) { p.period_s = 0.0; });
  refuses([](GuardParams& p) { p.margin = -0.1; });
  refuses([](GuardParams& p) { p.max_force_N = kNaN; });
  refuses([](GuardParams& p) { p.joint_speed_share = 1.1; });
  refuses([](GuardParams& p) { p.workspace.sphere_radius_m = 0.0; });
  refuses([](GuardParams& p) { p.arm.joints[2].limits.velocity_rad_per_s = 0.0; });
}

TEST(GuardMonitor, DoesNotAllocate) {
  GuardBench bench;
  ASSERT_TRUE(bench.RunUntilArmFollows());
  bench.arm.tau_ext = GuardJoints{};
  GuardCommand command = Moved(0, 1e-4);
  command.wrench = {};
  command.tau = GuardJoints{};
  rt::CheckedNoAllocScope no_alloc;
  bench.Message(GuardSession::kActive);
  (void)bench.Answer(command);
  bench.monitor.CheckSilence(bench.now);
}

}  // namespace
}  // namespace osteon::safety
