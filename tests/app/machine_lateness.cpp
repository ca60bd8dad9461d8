#include "tests/app/machine_lateness.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace osteon::app {
namespace {

std::string Milliseconds(rt::Nanoseconds t) { return std::to_string(t / 1'000'000) + " ms"; }

// Words of a fault's description which say that drive, PLC or controller did not hear the other in time.
constexpr std::array kSilences{
    "heartbeat lost",           "status lost",           "0x8130",
    "no connection to the PLC", "registers are too old", "PLC_HEARTBEAT (983) stands still"};

// Whether this fault is one that a device or the PLC reports when the loop's messages are late.
bool FollowsFromLateness(std::string_view fault) {
  return fault.ends_with(" stale") || fault == "arm left COMMANDING_ACTIVE" ||
         fault == "spindle drive fault" || fault == "motion not permitted";
}

// Whether this fault reports that a message or a contact model came too late.
// @param seen  its description in the summary
bool SaysTooLate(std::string_view fault, std::string_view seen) {
  // drive and PLC reported nothing wrong: only the age of their message is left as the reason
  if (seen.starts_with("ready; ") || seen.starts_with("permitted; ")) return true;
  if (fault == "spindle drive fault" || fault == "motion not permitted")
    return std::ranges::any_of(kSilences,
                               [&](const char* words) { return seen.find(words) != std::string_view::npos; });
  return FollowsFromLateness(fault);
}

}  // namespace

bool IsStall(const nlohmann::json& summary) {
  bool too_late = false;
  for (const nlohmann::json& fault : summary.at("faults_seen")) {
    const std::string name = fault.at("name"), seen = fault.at("seen");
    if (!FollowsFromLateness(name)) return false;
    too_late |= SaysTooLate(name, seen);
  }
  return too_late;
}

testing::AssertionResult MachineWasLate(const CommandResult& run, const nlohmann::json& summary,
                                        rt::Nanoseconds worst_wakeup) {
  if (run.exit_code != 1)
    return testing::AssertionFailure() << "exit code " << run.exit_code << ", which no delay explains\n"
                                       << run.out << run.err;
  if (!summary.contains("faults_seen") || !IsStall(summary))
    return testing::AssertionFailure() << "a stop that no delay explains\n" << summary.dump(2) << run.err;
  if (worst_wakeup < kLateWakeup)
    return testing::AssertionFailure()
           << "a stall on a machine that was punctual: its latest wake-up came " << Milliseconds(worst_wakeup)
           << " late, below " << Milliseconds(kLateWakeup) << "\n"
           << summary.dump(2) << run.err;
  return testing::AssertionSuccess() << "the machine woke a thread " << Milliseconds(worst_wakeup) << " late";
}

void Attempt::ExpectLate(const CommandResult& run, const nlohmann::json& summary, const WakeupWatch& watch,
                         const std::string& why) {
  worst_wakeup_ = watch.worst();
  EXPECT_TRUE(MachineWasLate(run, summary, worst_wakeup_)) << why;
}

void RepeatWhileLate(const std::function<void(Attempt&)>& make) {
  constexpr int kAttempts = 3;
  Attempt attempt;
  for (int i = 0; i < kAttempts; ++i) {
    attempt = {};
    make(attempt);
    if (!attempt.late() || testing::Test::HasFailure()) return;
  }
  GTEST_SKIP() << "skipped, this machine is too busy: " << kAttempts
               << " runs ended by a stall, and threads beside the last one were woken up to "
               << Milliseconds(attempt.worst_wakeup()) << " late";
}

}  // namespace osteon::app
