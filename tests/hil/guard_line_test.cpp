// Tests simulated arm, guard and controller, which are connected by real sockets. If the guard or the
// controller fails, the arm must come to rest.

#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "hil/simulated_cell_thread.h"
#include "io/fri/fri_link.h"
#include "io/fri/fri_relay.h"
#include "test_client.h"

namespace osteon::hil {
namespace {

using control::SessionState;
using safety::GuardFinding;

// more than the 5 of a real arm, because a busy machine may delay a thread for long
constexpr int kLostInARow = 300;

// A simulated arm that tolerates many late answers.
SimulatedCell PatientCell() {
  SimulatedCellParams params;
  params.arm = kinematics::Iiwa14();
  params.fri.quality.end_after_lost_in_a_row = kLostInARow;
  params.fri.quality.end_after_lost_per_s = 1000000;
  params.fri.quality.good_max_lost_per_s = 1000000;
  params.fri.quality.good_timeout_s = 3600.0;
  params.q_start = {0.0, 0.6, 0.0, -1.3, 0.0, 0.9, 0.0};
  return SimulatedCell(params, MakeReamingScript({}));
}

// The guard's limits: the arm's own limits, and time limits that a busy machine can keep.
safety::GuardParams Limits() {
  safety::GuardParams params{.arm = kinematics::ChainFrom(kinematics::Iiwa14())};
  params.answer_age_s = 0.2;
  params.silence_s = 0.15;
  return params;
}

// Repeats an action in its own thread until End is called.
class RepeatingThread {
 public:
  explicit RepeatingThread(std::function<void()> step)
      : thread_([this, step = std::move(step)] {
          while (!stop_.load()) step();
        }) {}
  ~RepeatingThread() { End(); }
  RepeatingThread(const RepeatingThread&) = delete;
  RepeatingThread& operator=(const RepeatingThread&) = delete;
  void End() {
    stop_.store(true);
    if (thread_.joinable()) thread_.join();
  }

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

class GuardLine : public testing::Test {
 protected:
  void SetUp() override {
    auto link = io::FriLink::Open({.port = 0});
    ASSERT_TRUE(link) << link.error();
    link_ = std::move(*link);
    auto relay = io::FriRelay::Open({.arm_port = 0, .controller_port = link_->port()}, monitor_);
    ASSERT_TRUE(relay) << relay.error();
    relay_ = std::move(*relay);
    cell_.emplace(CellThreadParams{.client_port = relay_->port()}, PatientCell());
    guard_.emplace([this] {
      (void)relay_->Serve(rt::MonotonicNow() + rt::kMillisecond);
      latched_.store(monitor_.latched());
    });
    controller_.emplace([this] { StepController(); });
    ASSERT_TRUE(Until([this] { return moved_.load() > 200; })) << "the arm follows";
  }

  // Runs one cycle of the controller: A1 moves slowly, at 0.05 rad/s. Once sends_illegal_command_ is set, A4
  // jumps by 0.3 rad.
  void StepController() {
    if (link_->Receive(state_, rt::MonotonicNow() + 20 * rt::kMillisecond) != control::ReceiveResult::kOk)
      return;
    if (state_.session == SessionState::kCommandingActive) {
      if (state_.holding) command_ = {.q = state_.q_ipo, .activation = state_.activation};
      command_.q[0] += 5e-5;
      if (sends_illegal_command_.load()) command_.q[3] += 0.3;
      ++moved_;
    }
    (void)link_->Send(command_);
  }

  // Waits until the condition holds. @returns false if it does not hold within 20 s
  static bool Until(const std::function<bool()>& holds) {
    for (int i = 0; i < 20'000; ++i) {
      if (holds()) return true;
      rt::SleepUntil(rt::MonotonicNow() + rt::kMillisecond);
    }
    return false;
  }
  CellState Arm() { return cell_->statistics().cell; }
  // Expects that the arm leaves commanding because answers are missing, and then rests.
  void ExpectArmAtRest() {
    ASSERT_TRUE(Until([this] { return Arm().session < SessionState::kCommandingWait; }));
    EXPECT_EQ(Arm().stop.reason, StopReason::kLostInARow) << "nothing else reached it";
    ASSERT_TRUE(Until([this] {
      const CellState a = Arm();
      rt::SleepUntil(rt::MonotonicNow() + 20 * rt::kMillisecond);
      const CellState b = Arm();
      return b.cycle > a.cycle && a.q_meas == b.q_meas;
    })) << "bit for bit the same position";
  }

  control::ArmState state_;
  control::ArmCommand command_;
  std::atomic<bool> sends_illegal_command_{false}, latched_{false};
  std::atomic<int> moved_{0};
  std::unique_ptr<io::FriLink> link_;
  safety::GuardMonitor monitor_{Limits()};
  std::unique_ptr<io::FriRelay> relay_;
  std::optional<SimulatedCellThread> cell_;
  std::optional<RepeatingThread> guard_, controller_;
};

TEST_F(GuardLine, TheArmStopsWhenTheGuardDies) {
  guard_->End();
  const control::JointArray q_cmd_before = Arm().q_cmd;
  ExpectArmAtRest();
  EXPECT_NEAR(Arm().q_cmd[0], q_cmd_before[0], 1e-3) << "a cycle or two may have been under way";
  EXPECT_FALSE(monitor_.latched());
}

TEST_F(GuardLine, TheArmStopsWhenTheControllerDies) {
  controller_->End();
  ASSERT_TRUE(Until([this] { return latched_.load(); }));
  ExpectArmAtRest();
  guard_->End();
  EXPECT_EQ(monitor_.reason().finding, GuardFinding::kSilence) << Describe(monitor_.reason());
  EXPECT_FALSE(monitor_.permits());
}

TEST_F(GuardLine, AnIllegalCommandNeverReachesTheArm) {
  const control::JointArray q_cmd_before = Arm().q_cmd;
  sends_illegal_command_.store(true);
  ASSERT_TRUE(Until([this] { return latched_.load(); }));
  ExpectArmAtRest();
  EXPECT_EQ(Arm().q_cmd[3], q_cmd_before[3]) << "of .3 rad in a millisecond, nothing";
  guard_->End();
  EXPECT_TRUE(monitor_.reason().finding == GuardFinding::kJointSpeed ||
              monitor_.reason().finding == GuardFinding::kJointPosition)
      << Describe(monitor_.reason());
  EXPECT_EQ(monitor_.reason().joint, 4);
  EXPECT_GT(monitor_.counters().withheld, 0u);
}

}  // namespace
}  // namespace osteon::hil
