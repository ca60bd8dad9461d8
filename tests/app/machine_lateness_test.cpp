#include "tests/app/machine_lateness.h"

#include <sched.h>

#include <gtest/gtest.h>

#include "base/realtime_thread.h"

// Tests which failures of a run a late machine excuses, and the measurement of lateness.

namespace osteon::app {
namespace {

CommandResult EndedWith(int exit_code) { return {.exit_code = exit_code, .out = "", .err = ""}; }

// A summary with these faults, all with the same description.
nlohmann::json Faults(const std::vector<std::string>& faults, const std::string& seen = "") {
  nlohmann::json described = nlohmann::json::array();
  for (const std::string& name : faults) described.push_back({{"name", name}, {"seen", seen}});
  return {{"faults_seen", described}};
}

TEST(MachineLateness, ExcusesAStallOfAMachineThatWasLate) {
  EXPECT_TRUE(MachineWasLate(EndedWith(1), Faults({"arm message stale"}), kLateWakeup));
  EXPECT_TRUE(MachineWasLate(
      EndedWith(1), Faults({"arm left COMMANDING_ACTIVE", "spindle drive fault", "motion not permitted"}),
      kLateWakeup));
  EXPECT_TRUE(MachineWasLate(
      EndedWith(1), Faults({"spindle drive fault"}, "a fault: heartbeat lost: none came in time (bit 0)"),
      kLateWakeup));
  EXPECT_TRUE(MachineWasLate(EndedWith(1), Faults({"spindle drive fault"}, "ready; its status: 103 ms old"),
                             kLateWakeup));
  EXPECT_TRUE(MachineWasLate(EndedWith(1), Faults({"motion not permitted"}, "no connection to the PLC"),
                             kLateWakeup));
}

TEST(MachineLateness, ExcusesNoStallOfAPunctualMachine) {
  const auto verdict = MachineWasLate(EndedWith(1), Faults({"arm message stale"}), 3 * rt::kMillisecond);
  EXPECT_FALSE(verdict);
  EXPECT_NE(std::string(verdict.message()).find("came 3 ms late, below 10 ms"), std::string::npos)
      << verdict.message();
}

TEST(MachineLateness, ExcusesNeitherACrashNorAnotherFaultHoweverLateTheMachineWas) {
  EXPECT_FALSE(MachineWasLate(EndedWith(139), Faults({"arm message stale"}), rt::kSecond)) << "a crash";
  EXPECT_FALSE(MachineWasLate(EndedWith(2), Faults({"arm message stale"}), rt::kSecond)) << "no input";
  EXPECT_FALSE(MachineWasLate(EndedWith(1), nullptr, rt::kSecond)) << "no summary";
  EXPECT_FALSE(MachineWasLate(EndedWith(1), Faults({}), rt::kSecond)) << "no reason";
  EXPECT_FALSE(MachineWasLate(EndedWith(1), Faults({"motion not permitted"}, "EMERGENCY_STOP (978) is 1"),
                              rt::kSecond))
      << "nothing was late";
  EXPECT_FALSE(MachineWasLate(
      EndedWith(1), Faults({"spindle drive fault"}, "a fault: EMCY 0x7121 (motor blocked)"), rt::kSecond))
      << "nothing was late";
  EXPECT_FALSE(MachineWasLate(EndedWith(1), Faults({"arm message stale", "hand force"}), rt::kSecond));
}

// A real-time thread occupies one CPU for 30 ms. The watch on this CPU must report a late wake-up.
TEST(WakeupWatch, MeasuresAThreadThatIsKeptFromItsCpu) {
  // the watch's thread inherits this affinity; on another CPU it would not be delayed
  cpu_set_t all, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  const int cpu = sched_getcpu();
  CPU_ZERO(&one);
  CPU_SET(cpu, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  WakeupWatch watch;
  bool realtime = false;
  std::thread spinner([&realtime, cpu] {
    realtime = rt::SetUpRealtimeThread({.priority = 1, .cpu = cpu}).realtime;
    const rt::Nanoseconds end = rt::MonotonicNow() + 3 * kLateWakeup;
    while (realtime && rt::MonotonicNow() < end) {
    }
  });
  spinner.join();
  ASSERT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
  if (!realtime) GTEST_SKIP() << "skipped, no SCHED_FIFO for this user: nothing can keep a CPU to itself";
  rt::SleepUntil(rt::MonotonicNow() + 5 * rt::kMillisecond);  // sleeps, so that the waiting thread can run
  EXPECT_GT(watch.worst(), kLateWakeup);
}

}  // namespace
}  // namespace osteon::app
