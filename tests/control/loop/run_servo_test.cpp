#include "control/loop/run_servo.h"

#include <algorithm>

#include <atomic>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "control/loop/rest_time.h"

#include "base/clock.h"
#include "servo_bench.h"

// Tests RunServo, which runs the servo loop in real time with an arm, devices and a recorder until the run
// ends.

namespace osteon::control {
namespace {

// A simulated arm. It sleeps so that it delivers one message per millisecond. It becomes active after
// `active_after` messages, follows its command at once, and closes the link after `closes_after` messages.
class FakeArm : public ArmLink {
 public:
  explicit FakeArm(int active_after = 3, int closes_after = 1 << 30)
      : active_after_(active_after), closes_after_(closes_after) {
    Eigen::Map<kinematics::JointVector>(state_.q_meas.data()) = ServoBench::StartJoints();
    next_ = rt::MonotonicNow();
  }

  ReceiveResult Receive(ArmState& state, rt::Nanoseconds deadline) OSTEON_RT override {
    if (received >= closes_after_) return ReceiveResult::kClosed;
    if (silent) {
      rt::SleepUntil(deadline);
      return ReceiveResult::kTimeout;
    }
    next_ += rt::kMillisecond;
    rt::SleepUntil(next_);
    const bool left = received >= leaves_after && received < returns_after;
    state_.session =
        received < active_after_ || left ? SessionState::kCommandingWait : SessionState::kCommandingActive;
    state_.activation = received < returns_after ? 1 : 2;
    if (loop != nullptr && received == recovers_after) loop->RequestRecovery();
    if (loop != nullptr && received == stops_after) stop.store(true);
    state_.stamp = next_;
    state_.q_ipo = state_.q_meas;
    state_.has_ipo = true;
    ++state_.sequence;
    ++received;
    state = state_;
    return ReceiveResult::kOk;
  }
  bool Send(const ArmCommand& command) OSTEON_RT override {
    state_.q_meas = command.q;
    ++sent;
    return true;
  }

  int received{0}, sent{0};
  bool silent{false};
  // Numbers of messages after which the arm leaves COMMANDING_ACTIVE and returns to it, and after which the
  // operator requests a recovery or a stop of `loop`.
  int leaves_after{1 << 30}, returns_after{1 << 30}, recovers_after{1 << 30}, stops_after{1 << 30};
  ServoLoop* loop{nullptr};
  std::atomic<bool> stop{false};

 private:
  int active_after_, closes_after_;
  ArmState state_;
  rt::Nanoseconds next_;
};

// Simulates the cell's devices and the simulation: a hand that pushes along y, and a new contact model of
// free space at each reading.
class FakeWorld : public CellDevices {
 public:
  explicit FakeWorld(rt::LatestValue<simulation::ContactModel>& models) : models_(models) {}
  CellReadings Exchange(const CellCommands&, rt::Nanoseconds) OSTEON_RT override {
    if (--stands_still_at == 0) rt::SleepUntil(rt::MonotonicNow() + 4 * rt::kMillisecond);
    const rt::Nanoseconds now = rt::MonotonicNow();
    if (frames_left > 0) {
      --frames_left;
      ++model_.frame;
      model_.pose_stamp = now;
      models_.Store(model_);
    }
    const Wrench F_T_W{.f = {0.0, 0.5, 0.0}, .t = Vector3::Zero()};
    return {.force = {.stamp = now, .F_S = ServoBench::OnTheSensor(F_T_W, ServoBench::StartPose())}};
  }
  int frames_left{1'000'000};
  int stands_still_at{-1};  ///< number of the reading (from 1) before which the thread is suspended for 4 ms

 private:
  rt::LatestValue<simulation::ContactModel>& models_;
  simulation::ContactModel model_;
};

// Keeps up to 20 000 ticks and refuses all further ticks.
class FakeRecorder : public TickRecorder {
 public:
  FakeRecorder() { records.reserve(20'000); }
  bool Push(const TickRecord& record) OSTEON_RT override {
    if (records.size() == records.capacity()) return false;
    records.push_back(record);
    return true;
  }
  std::vector<TickRecord> records;
};

// A loop and everything that it needs to run. `second` has the same parameters and repeats the ticks of
// `loop`.
struct Rig {
  ServoLoop loop{ServoBench::Params(), ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                 ServoBench::Arm().ArmAngle(ServoBench::StartJoints())};
  ServoLoop second{ServoBench::Params(), ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                   ServoBench::Arm().ArmAngle(ServoBench::StartJoints())};
  rt::LatestValue<simulation::ContactModel> models;
  rt::LatestValue<simulation::ToolCommand> commands;
  ThreadSimulation simulation{models, commands};
  FakeWorld world{models};
  FakeRecorder recorder;

  RunServoResult Run(FakeArm& arm, RunServoParams params) {
    params.thread = {.priority = 0};
    return RunServo(loop, {.link = arm, .devices = world, .simulation = simulation, .recorder = recorder},
                    params);
  }
};

TEST(RunServo, RunsItsSecondsThenStopsInOrderAndAnswersEveryMessage) {
  Rig rig;
  FakeArm arm;
  const RunServoResult result = rig.Run(arm, {.seconds = 0.2});
  EXPECT_EQ(result.end, RunEnd::kSeconds);
  EXPECT_EQ(result.faults.bits(), 0u);
  EXPECT_EQ(arm.sent, arm.received) << "to the last one";
  EXPECT_EQ(rig.loop.phase(), Phase::kStopped);
  EXPECT_EQ(result.ticks, rig.recorder.records.size());
  EXPECT_EQ(rig.recorder.records.back().phase, Phase::kStopped);
  EXPECT_EQ(result.wakeup.count(), static_cast<std::uint64_t>(arm.received));
  EXPECT_EQ(result.period.count(), result.statistics.active_ticks - 1);
  // the fake arm's time stamps are exactly 1 ms apart, however late the machine wakes the thread. The only
  // error is the width of the histogram's bin
  EXPECT_NEAR(1e9 / static_cast<double>(result.period.Quantile(0.5)), 1000.0, 5.0);
  EXPECT_EQ(rig.commands.Load().stamp, rig.loop.tool_command().stamp);
}

// The thread is suspended after its wake-up, so the reading's time stamp is later than the wake-up. The
// reading must still count as fresh, and not as one from the future.
TEST(RunServo, AThreadSuspendedBeforeItsReadingTakesTheReadingAsFresh) {
  Rig rig;
  FakeArm arm;
  rig.world.stands_still_at = 150;
  const RunServoResult result = rig.Run(arm, {.seconds = 0.25});
  EXPECT_LT(rig.world.stands_still_at, 0) << "it did stand still";
  EXPECT_EQ(result.faults.bits(), 0u);
  EXPECT_EQ(result.end, RunEnd::kSeconds);
  for (const TickRecord& tick : rig.recorder.records) EXPECT_LT(tick.sensor_age_s, 0.1) << tick.tick;
}

// After the stop, the run must continue for at_rest_s, to record the arm at rest.
TEST(RunServo, AfterTheStopTheArmAtRestIsRecordedForTheGivenTime) {
  for (const double rest_s : {0.0, 0.1}) {
    Rig rig;
    FakeArm arm;
    const RunServoResult result = rig.Run(arm, {.seconds = 0.2, .at_rest_s = rest_s});
    EXPECT_EQ(result.end, RunEnd::kSeconds);
    EXPECT_EQ(result.faults.bits(), 0u);
    EXPECT_EQ(arm.sent, arm.received);
    const auto at_rest = std::count_if(rig.recorder.records.begin(), rig.recorder.records.end(),
                                       [](const TickRecord& tick) { return tick.phase == Phase::kStopped; });
    // one message per millisecond, fewer if the machine is late
    EXPECT_GE(at_rest, rest_s > 0.0 ? 20 : 1);
    if (rest_s == 0.0) {
      EXPECT_EQ(at_rest, 1);
    }
  }
}

// The rest time is set to 100 ns. It begins with the first tick that is not in stop category 0. If the arm
// stays in category 0, the wait must end after 4 times the rest time.
TEST(RestTime, BeginsAtRestAndGivesUpOnAnArmNeverSeenToStand) {
  using safety::CellState;
  RestTime seen(100);
  EXPECT_FALSE(seen.IsOver(CellState::kStop0, 1000)) << "not yet measured to stand";
  EXPECT_FALSE(seen.IsOver(CellState::kStop0, 1150));
  EXPECT_FALSE(seen.IsOver(CellState::kFault, 1200));
  EXPECT_FALSE(seen.IsOver(CellState::kFault, 1299));
  EXPECT_TRUE(seen.IsOver(CellState::kFault, 1300));
  RestTime silent(100);
  EXPECT_FALSE(silent.IsOver(CellState::kStop0, 1000));
  EXPECT_FALSE(silent.IsOver(CellState::kStop0, 1399));
  EXPECT_TRUE(silent.IsOver(CellState::kStop0, 1400));
  RestTime none(0);
  EXPECT_TRUE(none.IsOver(CellState::kStop0, 1000));
}

// Counts how often the link is warmed up before a tick.
class WarmUpCountingArm : public FakeArm {
 public:
  void WarmUp(const ArmCommand&) OSTEON_RT override { ++warm_ups; }
  int warm_ups{0};
};

TEST(RunServo, RepeatsEachTickAndWarmsUpTheLinkBeforeTheNext) {
  Rig rig;
  WarmUpCountingArm arm;
  const RunServoResult result = rig.Run(arm, {.seconds = 0.3, .second = &rig.second});
  EXPECT_EQ(result.end, RunEnd::kSeconds);
  EXPECT_EQ(result.faults.bits(), 0u);
  EXPECT_EQ(arm.sent, arm.received);
  EXPECT_GT(arm.warm_ups, 0) << "where the machine woke it in time";
  EXPECT_EQ(rig.second.statistics().active_ticks + 1, rig.loop.statistics().active_ticks)
      << "in step; after the last tick there is no next message to repeat it before";
}

TEST(RunServo, ATickWhoseRepetitionDiffersEndsTheRun) {
  Rig rig;
  ServoParams other = ServoBench::Params();
  other.admittance.mass_kg.y() *= 1.0 + 1e-15;  // the mass along y, because the hand pushes along y
  ServoLoop differs(other, ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                    ServoBench::Arm().ArmAngle(ServoBench::StartJoints()));
  FakeArm arm;
  const RunServoResult result = rig.Run(arm, {.seconds = 5.0, .second = &differs});
  EXPECT_EQ(result.end, RunEnd::kFault);
  EXPECT_TRUE(result.faults.Has(safety::Fault::kRepeatDiffers));
  EXPECT_EQ(rig.loop.phase(), Phase::kStopped);
}

// When the recorder has so many waiting records that some will soon be lost, the cell must stop in the next
// tick. The second loop repeats the ticks with the same inputs, so it must find no difference.
TEST(RunServo, AStalledRecorderEndsTheRun) {
  constexpr std::size_t kSeen = 300;
  struct Stalls : FakeRecorder {
    [[nodiscard]] bool Stalled() const OSTEON_RT override { return records.size() >= kSeen; }
  };
  Rig rig;
  Stalls recorder;
  FakeArm arm;
  const RunServoResult result = RunServo(
      rig.loop, {.link = arm, .devices = rig.world, .simulation = rig.simulation, .recorder = recorder},
      {.seconds = 5.0, .give_up_s = 5.0, .second = &rig.second});
  EXPECT_EQ(result.end, RunEnd::kFault);
  EXPECT_EQ(result.faults.bits(), static_cast<std::uint32_t>(safety::Fault::kRecorder));
  EXPECT_EQ(rig.loop.phase(), Phase::kStopped);
  ASSERT_GT(recorder.records.size(), kSeen);
  EXPECT_EQ(recorder.records[kSeen - 1].faults, 0u);
  EXPECT_TRUE(recorder.records[kSeen].input.recorder_stalled);
  EXPECT_EQ(recorder.records[kSeen].faults, static_cast<std::uint32_t>(safety::Fault::kRecorder));
}

// The cell must also stop if the recorder refuses a tick.
TEST(RunServo, AFullRecorderEndsTheRun) {
  struct Full : FakeRecorder {
    bool Push(const TickRecord& record) OSTEON_RT override {
      return records.size() < 300 && FakeRecorder::Push(record);
    }
  };
  Rig rig;
  Full recorder;
  FakeArm arm;
  const RunServoResult result = RunServo(
      rig.loop, {.link = arm, .devices = rig.world, .simulation = rig.simulation, .recorder = recorder},
      {.seconds = 5.0, .give_up_s = 5.0});
  EXPECT_EQ(result.end, RunEnd::kFault);
  EXPECT_TRUE(result.faults.Has(safety::Fault::kRecorder));
  EXPECT_GT(result.unrecorded, 0u);
}

TEST(RunServo, AStopFlagStopsInOrder) {
  Rig rig;
  FakeArm arm;
  std::atomic<bool> stop{false};
  struct StopAfter : FakeRecorder {
    std::atomic<bool>* flag{nullptr};
    bool Push(const TickRecord& record) OSTEON_RT override {
      if (records.size() == 50) flag->store(true);
      return FakeRecorder::Push(record);
    }
  } recorder;
  recorder.flag = &stop;
  const RunServoResult result = RunServo(
      rig.loop, {.link = arm, .devices = rig.world, .simulation = rig.simulation, .recorder = recorder},
      {.seconds = 0.0, .thread = {.priority = 0}, .stop = &stop});
  EXPECT_EQ(result.end, RunEnd::kStopFlag);
  EXPECT_EQ(rig.loop.phase(), Phase::kStopped);
  EXPECT_EQ(result.faults.bits(), 0u);
}

TEST(RunServo, AFaultEndsTheRunAndIsReported) {
  Rig rig;
  rig.world.frames_left = 100;
  FakeArm arm;
  const RunServoResult result = rig.Run(arm, {.seconds = 5.0});
  EXPECT_EQ(result.end, RunEnd::kFault);
  EXPECT_TRUE(result.faults.Has(safety::Fault::kModelStale));
}

// Number of recorded ticks in this state.
std::size_t CountTicks(const FakeRecorder& recorder, safety::CellState state) {
  return static_cast<std::size_t>(std::ranges::count(recorder.records, static_cast<std::uint8_t>(state),
                                                     [](const TickRecord& t) { return t.cell_state; }));
}

TEST(RunServo, AHeldFaultIsClearedByARecoveryAndRenderingContinues) {
  Rig rig;
  FakeArm arm;
  arm.leaves_after = 100;
  arm.returns_after = 200;
  arm.recovers_after = 400;
  arm.loop = &rig.loop;
  const RunServoResult result = rig.Run(arm, {.seconds = 0.5, .give_up_s = 0.25, .hold_at_fault = true});
  EXPECT_EQ(result.end, RunEnd::kSeconds);
  EXPECT_FALSE(result.faults.Any()) << "the recovery has cleared it";
  EXPECT_TRUE(result.cleared.Has(safety::Fault::kSession)) << "and it is not forgotten";
  EXPECT_EQ(result.operator_recoveries, 1);
  EXPECT_EQ(result.recovered, 0) << "none by itself";
  EXPECT_GT(CountTicks(rig.recorder, safety::CellState::kFault), 150u)
      << "the arm's return alone moves nothing";
  const auto asked =
      std::ranges::find_if(rig.recorder.records, [](const TickRecord& t) { return t.input.recover; });
  ASSERT_NE(asked, rig.recorder.records.end());
  const auto rendered = std::count_if(asked, rig.recorder.records.end(),
                                      [](const TickRecord& t) { return t.phase == Phase::kHaptic; });
  EXPECT_GT(rendered, 100) << "500 ms less 100 before and 200 of the recovery: the hold does not count";
}

TEST(RunServo, AStopDuringAHoldEndsWithTheFault) {
  Rig rig;
  FakeArm arm;
  arm.leaves_after = 100;
  arm.stops_after = 400;
  arm.loop = &rig.loop;
  const RunServoResult result =
      rig.Run(arm, {.seconds = 0.0, .give_up_s = 0.1, .hold_at_fault = true, .stop = &arm.stop});
  EXPECT_EQ(result.end, RunEnd::kFault);
  EXPECT_TRUE(result.faults.Has(safety::Fault::kSession));
  EXPECT_EQ(result.operator_recoveries, 0);
  EXPECT_GE(arm.received, 400) << "it was held until the stop";
}

TEST(RunServo, AFaultThatAllowsNoRecoveryEndsTheRunInsteadOfAHold) {
  Rig rig;
  FakeArm arm;
  rig.world.frames_left = 100;
  const RunServoResult result = rig.Run(arm, {.seconds = 10.0, .hold_at_fault = true});
  EXPECT_EQ(result.end, RunEnd::kFault);
  EXPECT_TRUE(result.faults.Has(safety::Fault::kModelStale));
  EXPECT_LT(arm.received, 5000);
}

TEST(RunServo, WithoutASimulationItNeverBeginsAndReportsTheMissingModel) {
  Rig rig;
  rig.world.frames_left = 0;
  FakeArm arm;
  const RunServoResult result = rig.Run(arm, {.seconds = 5.0, .give_up_s = 0.2});
  EXPECT_EQ(result.end, RunEnd::kNeverActive);
  EXPECT_EQ(result.faults.bits(), 0u);
  EXPECT_EQ(rig.loop.permits().bits(),
            safety::MotionPermits::kAll & ~static_cast<std::uint32_t>(safety::MotionPermit::kModelFresh));
}

TEST(RunServo, ASilentArmOrAClosedLinkEndsTheRun) {
  Rig silent;
  FakeArm nobody;
  nobody.silent = true;
  EXPECT_EQ(silent.Run(nobody, {.give_up_s = 0.05}).end, RunEnd::kNeverActive);
  EXPECT_FALSE(silent.loop.faults().Any()) << "nothing was started, nothing failed";

  Rig closing;
  FakeArm closes(3, 40);
  const RunServoResult result = closing.Run(closes, {.seconds = 5.0});
  EXPECT_EQ(result.end, RunEnd::kLinkClosed);
  EXPECT_TRUE(result.faults.Has(safety::Fault::kArmStale));
}

TEST(RunServo, RefusesParametersOutOfRange) {
  Rig rig;
  FakeArm arm;
  EXPECT_THROW(rig.Run(arm, {.deadline_s = 0.0}), std::invalid_argument);
  EXPECT_THROW(rig.Run(arm, {.seconds = -1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
