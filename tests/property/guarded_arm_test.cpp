// Property tests: a controller sends random commands and errors. At each level, the simulated arm refuses
// what a real arm refuses; behind the guard it also stays within the cell's limits.

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "config/reading/load_robot.h"
#include "hil/arm/simulated_arm.h"
#include "hil/fri/fri_server.h"
#include "kinematics/payload.h"
#include "tests/hil/test_client.h"
#include "tests/property/loop_oracle.h"
#include "tests/property/property_check.h"
#include "tests/property/wild_values.h"
#include "tests/property/wild_zone.h"
#include "tests/safety/guard_bench.h"

namespace osteon::property {
namespace {

using control::JointArray;
using control::SessionState;
using kinematics::JointVector;
using safety::GuardBench;
using safety::GuardDecision;
using safety::GuardSession;

constexpr double kTool_m = 0.2;      // from the flange to the tool's apex
constexpr double kStepMargin = 1.1;  // the arm's own tolerance, FriServerParams::step_margin
constexpr double kRounding = 1.0 + 1e-6;
constexpr double kLag_m = 1e-3;  // a lagging arm may leave its commanded path by this much at a corner

// Kinds of operations (Op::what): those from kPushes on make the controller drift, the others are errors.
constexpr int kPushes = 10, kKinds = 13;

// A session that becomes active after a few messages.
hil::FriServerParams FastServerParams() {
  return {.quality = {.fair_after_answers = 1, .good_after_answers = 2, .excellent_after_answers = 3},
          .request_after_good_cycles = 1,
          .activate_after_mirrored_answers = 1};
}

// Up to three zones for any of the guarded points, which are inside or outside at the start.
using ZoneChoices = std::vector<ZoneChoice>;
rc::Gen<ZoneChoices> AnyZones() {
  return rc::gen::resize(3, rc::gen::container<ZoneChoices>(AnyZone(-1, 1)));
}

safety::GuardParams GuardParamsWith(const ZoneChoices& zones) {
  safety::GuardParams params = GuardBench::Params();
  params.workspace_margin_m = 0.3e-3;  // small: a case lasts 0.05 s and has to reach the bounds
  params.workspace.sphere_radius_m = 0.006;
  params.workspace.plane_offset_m = GuardBench::Start().translation().z() - 0.004;
  const ArmPoints start = PointsOfIiwa(GuardBench::StartJoints(), kTool_m);
  for (const ZoneChoice& zone : zones) params.workspace.zones.push_back(ZoneOf(zone, start));
  return params;
}

std::unique_ptr<hil::SimulatedArm> MakeArm(hil::ArmLevel level) {
  static const auto chain = kinematics::WithPayload(
      std::get<kinematics::ChainParams<7>>(
          config::LoadRobot(OSTEON_SOURCE_DIR "/config/robots/lbr_iiwa_14_r820.yaml").chain),
      {.mass_kg = 2.0, .p_LLcm_m = {0.0, 0.0, 0.08}, .I_LLcm_kg_m2 = 0.004 * Matrix3::Identity()});
  hil::SimulatedArmParams params{.level = level, .lbr = kinematics::Iiwa14()};
  if (level == hil::ArmLevel::kDynamic) params.chain = chain;
  params.p_FT_m = Vector3(0.0, 0.0, kTool_m);
  params.q_start = Eigen::Map<const JointVector>(GuardBench::StartJoints().data());
  return hil::MakeSimulatedArm(params, 1e-3);
}

// A controller that sends anything, the guard if there is one, the arm's session server, and the arm.
class ControllerAndArm {
 public:
  ControllerAndArm(hil::ArmLevel level, bool guarded, const ZoneChoices& zones)
      : level_(level),
        guarded_(guarded),
        limits_(GuardParamsWith(zones)),
        server_(FastServerParams(), kinematics::Iiwa14().limits,
                Eigen::Map<const JointVector>(GuardBench::StartJoints().data())),
        body_(MakeArm(level)),
        monitor_(limits_) {
    entered_.resize(zones.size());
    NoteZones(PointsOfIiwa(GuardBench::StartJoints(), kTool_m), PointsOfIiwa(commanded_, kTool_m));
    server_.Open();
    for (int i = 0; i < 12 && server_.state() != SessionState::kCommandingActive; ++i) Cycle(Op{});
  }

  [[nodiscard]] bool active() const { return server_.state() == SessionState::kCommandingActive; }
  [[nodiscard]] double max_step_m() const { return max_step_m_; }
  /// Index of the zone at which the guard stopped the arm; -1: none.
  [[nodiscard]] int stopped_at_zone() const {
    return monitor_.reason().finding == safety::GuardFinding::kZone ? monitor_.reason().joint - 1 : -1;
  }

  /// Runs one period. @returns the arm's violation; empty if there is none
  [[nodiscard]] std::string Tick(const Op& op) {
    Cycle(op);
    return Judge();
  }

 private:
  void Cycle(const Op& op) {
    now_ += rt::kMillisecond;
    const auto message = server_.BeginCycle({.q = body_->q()}, now_);
    ShowArmToGuard();
    Answer(op, static_cast<std::uint32_t>(hil::UintAt(message, {1, 2})));
    server_.EndCycle();
    hil::ArmDrive drive;
    drive.q_cmd = server_.q_commanded();
    body_->Step(drive, {});
  }

  // Gives the guard the arm's message of this cycle.
  void ShowArmToGuard() {
    const SessionState state = server_.state();
    safety::GuardArmMessage seen{.sequence = ++arm_sequence_};
    seen.session = state == SessionState::kCommandingActive ? GuardSession::kActive
                   : state == SessionState::kCommandingWait ? GuardSession::kWaiting
                   : state == SessionState::kIdle           ? GuardSession::kIdle
                                                            : GuardSession::kMonitoring;
    std::copy_n(body_->q().data(), 7, seen.q_meas.begin());
    if (seen.session >= GuardSession::kWaiting) seen.q_ipo = GuardBench::StartJoints();
    static_cast<void>(monitor_.OnArmMessage(seen, now_));
    monitor_.CheckSilence(now_);
  }

  // The controller's answer to the arm's message, with the operation's drift or error, through the guard.
  void Answer(const Op& op, std::uint32_t message) {
    if (op.what >= kPushes)  // the joint drifts at up to 5 rad/s until its next drift
      drift_[static_cast<std::size_t>(op.which)] = 1e-3 * std::clamp(op.value, -5.0, 5.0);
    if (op.what == 1) return;  // silence
    if (active())
      for (std::size_t i = 0; i < 7; ++i) q_[i] += drift_[i];
    safety::GuardCommand command{.sequence = ++sequence_, .reflected = arm_sequence_, .q = q_};
    std::vector<double> joints, wrench, tau;
    const auto which = static_cast<std::size_t>(op.which);
    switch (op.what) {
      case 2:  // a joint jumps
        (*command.q)[which] = op.value;
        break;
      case 3:  // a joint steps
        (*command.q)[which] += op.value;
        break;
      case 4:  // a wrench overlay
        command.wrench.emplace()[which % 6] = 10.0 * op.value;
        wrench.assign(command.wrench->begin(), command.wrench->end());
        break;
      case 5:  // a torque overlay
        command.tau.emplace()[which] = op.value;
        tau.assign(command.tau->begin(), command.tau->end());
        break;
      case 6:  // the command has no joint positions
        command.q.reset();
        break;
      case 7:  // answers an earlier message
        command.reflected -= static_cast<std::uint32_t>(op.which);
        message -= static_cast<std::uint32_t>(op.which);
        break;
      case 8:  // goes back in its own sequence
        command.sequence = --sequence_;
        break;
      default:
        break;
    }
    if (command.q) joints.assign(command.q->begin(), command.q->end());
    std::vector<std::uint8_t> datagram = hil::OverlayCommand(command.sequence, message, joints, wrench, tau);
    if (op.what == 9) {  // damaged in transit; tried without a guard only
      if (guarded_) return;
      datagram[which * datagram.size() / 7] ^= static_cast<std::uint8_t>(1u << which);
    }
    if (guarded_ && monitor_.OnCommand(command, now_ + 300'000) != GuardDecision::kPass) return;
    static_cast<void>(server_.Receive(datagram));
  }

  // Checks the arm's own limits, and behind the guard the cell's. @returns the violation; empty if there is
  // none
  [[nodiscard]] std::string Judge() {
    JointArray commanded{}, q{};
    std::copy_n(server_.q_commanded().data(), 7, commanded.begin());
    std::copy_n(body_->q().data(), 7, q.begin());
    // after lost messages a step may be longer, because it has more periods
    ++periods_;
    const double time_s = 1e-3 * periods_;
    for (std::size_t i = 0; i < 7; ++i) {
      const kinematics::JointLimits& limit = kinematics::Iiwa14().limits[i];
      if (!(commanded[i] >= limit.lower_rad && commanded[i] <= limit.upper_rad))
        return fmt::format("joint {} is told {} rad", i + 1, commanded[i]);
      if (!(std::abs(commanded[i] - commanded_[i]) <=
            kStepMargin * kRounding * limit.velocity_rad_per_s * time_s))
        return fmt::format("joint {} is told to step by {} rad", i + 1, commanded[i] - commanded_[i]);
      if (!(q[i] >= limit.lower_rad - 1e-3 && q[i] <= limit.upper_rad + 1e-3))
        return fmt::format("joint {} is at {} rad", i + 1, q[i]);
    }
    const ArmPoints before = PointsOfIiwa(commanded_, kTool_m), after = PointsOfIiwa(commanded, kTool_m);
    const double step_m = (after.p_tool_m - before.p_tool_m).norm();
    max_step_m_ = std::max(max_step_m_, step_m / periods_);
    const ArmPoints actual = PointsOfIiwa(q, kTool_m);
    std::string violation = guarded_ ? JudgeCell(after, actual, step_m, time_s) : "";
    NoteZones(after, actual);
    if (commanded != commanded_) periods_ = 0;
    commanded_ = commanded;
    return violation;
  }

  [[nodiscard]] std::string JudgeCell(const ArmPoints& commanded, const ArmPoints& actual, double step_m,
                                      double time_s) const {
    const safety::GuardParams& limits = limits_;
    if (!(step_m <= kRounding * (1.0 + limits.margin) * limits.max_speed_m_per_s * time_s + 1e-12))
      return fmt::format("the tool is told to step by {} m in {} s", step_m, time_s);
    const auto outside_m = [&](const Vector3& p) {
      return std::max((p - limits.workspace.sphere_center_W_m).norm() - limits.workspace.sphere_radius_m,
                      limits.workspace.plane_offset_m - p.z());
    };
    if (!(outside_m(commanded.p_tool_m) <= limits.workspace_margin_m + 1e-9))
      return fmt::format("the tool is told to be {} m outside", outside_m(commanded.p_tool_m));
    const double lag_m = level_ == hil::ArmLevel::kKinematic ? 1e-9 : kLag_m;
    if (!(outside_m(actual.p_tool_m) <= limits.workspace_margin_m + lag_m))
      return fmt::format("the tool is {} m outside", outside_m(actual.p_tool_m));
    for (std::size_t i = 0; i < entered_.size(); ++i) {
      const safety::ZoneParams& zone = limits.workspace.zones[i];
      const double commanded_m = PastBound_m(zone, PointOf(commanded, zone.point)),
                   actual_m = PastBound_m(zone, PointOf(actual, zone.point));
      if (entered_[i].commanded && !(commanded_m <= limits.workspace_margin_m + 1e-9))
        return fmt::format("the arm is told to be {} m past zone {}", commanded_m, i + 1);
      if (entered_[i].actual && !(actual_m <= limits.workspace_margin_m + lag_m))
        return fmt::format("the arm is {} m past zone {}", actual_m, i + 1);
    }
    return {};
  }

  // A zone binds as soon as the commanded position, and after it the real position, has been within the
  // zone's bound.
  void NoteZones(const ArmPoints& commanded, const ArmPoints& actual) {
    for (std::size_t i = 0; i < entered_.size(); ++i) {
      const safety::ZoneParams& zone = limits_.workspace.zones[i];
      entered_[i].commanded |= PastBound_m(zone, PointOf(commanded, zone.point)) <= 0.0;
      entered_[i].actual |= entered_[i].commanded && PastBound_m(zone, PointOf(actual, zone.point)) <= 0.0;
    }
  }

  hil::ArmLevel level_;
  bool guarded_;
  safety::GuardParams limits_;
  hil::FriServer server_;
  std::unique_ptr<hil::SimulatedArm> body_;
  safety::GuardMonitor monitor_;

  rt::Nanoseconds now_{rt::kSecond};
  std::uint32_t arm_sequence_{0}, sequence_{0};
  JointArray q_{GuardBench::StartJoints()}, drift_{};
  JointArray commanded_{GuardBench::StartJoints()};
  int periods_{0};  // periods since the arm last got a new command
  double max_step_m_{0.0};
  struct EnteredZone {
    bool commanded{false}, actual{false};
  };
  std::vector<EnteredZone> entered_;  // one entry for each zone
};

// Runs random operations; fails with the first violation.
void CheckArmKeepsLimits(hil::ArmLevel level, bool guarded) {
  const ZoneChoices zones = *AnyZones().as("zones");
  const std::vector<Op> ops = *WildOps(kPushes, kKinds).as("ops");
  ControllerAndArm controller_and_arm(level, guarded, zones);
  RC_ASSERT(controller_and_arm.active());
  for (std::size_t tick = 0; tick < ops.size(); ++tick) {
    const std::string violation = controller_and_arm.Tick(ops[tick]);
    if (!violation.empty()) RC_FAIL("tick " + std::to_string(tick) + ": " + violation);
  }
}

constexpr int kShards = 8;  // parts of the 25 000 cases that run in parallel
class ArmProperty : public testing::TestWithParam<int> {};

TEST_P(ArmProperty, BehindTheGuardTheKinematicArmKeepsItsLimits) {
  CheckShard(GetParam(), kShards, 25'000, [] { CheckArmKeepsLimits(hil::ArmLevel::kKinematic, true); });
}
INSTANTIATE_TEST_SUITE_P(Shard, ArmProperty, testing::Range(0, kShards));

TEST(ArmPropertyLevels, BehindTheGuardTheLaggingArmKeepsItsLimits) {
  CheckShard(100, 1, 1'000, [] { CheckArmKeepsLimits(hil::ArmLevel::kServo, true); });
}

TEST(ArmPropertyLevels, BehindTheGuardTheArmWithMassesKeepsItsLimits) {
  CheckShard(101, 1, 1'000, [] { CheckArmKeepsLimits(hil::ArmLevel::kDynamic, true); });
}

TEST(ArmPropertyLevels, WithoutTheGuardTheArmRefusesWhatARealArmRefuses) {
  for (const auto level : {hil::ArmLevel::kKinematic, hil::ArmLevel::kServo, hil::ArmLevel::kDynamic})
    CheckShard(102 + static_cast<int>(level), 1, 1'000, [level] { CheckArmKeepsLimits(level, false); });
}

TEST(ArmPropertyCases, RandomCasesMoveTheArmAndReachZonesOfEveryShape) {
  int fast = 0, cases = 0;
  std::array<int, 5> stopped_at{};  // number of cases by the zone's shape
  CheckShard(110, 1, 4'000, [&] {
    const ZoneChoices zones = *AnyZones();
    const std::vector<Op> ops = *WildOps(kPushes, kKinds);
    ControllerAndArm controller_and_arm(hil::ArmLevel::kKinematic, true, zones);
    for (const Op& op : ops) static_cast<void>(controller_and_arm.Tick(op));
    ++cases;
    fast += controller_and_arm.max_step_m() > 0.1e-3;  // 0.1 m/s of the permitted 0.25 m/s
    if (const int zone = controller_and_arm.stopped_at_zone(); zone >= 0)
      ++stopped_at[static_cast<std::size_t>(zones[static_cast<std::size_t>(zone)].shape)];
  });
  EXPECT_GT(fast, cases / 20);
  for (const int stopped : stopped_at) EXPECT_GT(stopped, 2) << stopped << "of this shape of zone";
}

// The guard takes the joints' origins from the robot's file, the loop takes its closed form's lengths.
TEST(GuardOfShippedArms, PlacesElbowAndFlangeWhereTheLoopPlacesThem) {
  for (const char* name : {"lbr_iiwa_14_r820", "lbr_iiwa_7_r800"}) {
    const auto robot = config::LoadRobot(std::string(OSTEON_SOURCE_DIR "/config/robots/") + name + ".yaml");
    const auto& chain = std::get<kinematics::ChainParams<7>>(robot.chain);
    const kinematics::LbrArm loop(kinematics::LbrParamsFrom(chain));
    const safety::GuardKinematics guard(chain, Pose::Identity(), Pose::Identity());
    std::srand(4);
    for (int i = 0; i < 1000; ++i) {
      const JointVector q = 2.0 * JointVector::Random();
      EXPECT_LT((guard.ComputePlacement(q).p_WElbow - loop.Points(q).p_BElbow).norm(), 1e-9) << name;
      EXPECT_LT((guard.ComputePlacement(q).p_WFlange - loop.FlangePose(q).translation()).norm(), 1e-9)
          << name;
    }
  }
}

}  // namespace
}  // namespace osteon::property
