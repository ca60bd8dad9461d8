#pragma once

#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/cpu_watch.h"
#include "tests/app/command.h"

// A run in wall time may stall because this machine is overloaded. Such a run proves nothing about the
// product. The overload is measured, not assumed: a test is skipped only if this test's own threads were
// woken late.

namespace osteon::app {

/// Measures on each CPU how late this machine wakes a thread, from the object's construction on. Its threads
/// have no real-time priority, like those of the simulation and the simulated devices.
class WakeupWatch {
 public:
  /// The longest delay of a wake-up so far.
  [[nodiscard]] rt::Nanoseconds worst() const { return watch_.longest(); }

 private:
  rt::CpuWatch watch_{0};
};

/// A delay that loses ten messages of an arm, twice the number that the loop and the simulated arms tolerate.
inline constexpr rt::Nanoseconds kLateWakeup = 10 * rt::kMillisecond;

/// Whether the run of this summary stalled: at least one fault reports lateness, by its name or by its
/// description, and every other fault may follow from lateness.
[[nodiscard]] bool IsStall(const nlohmann::json& summary);

/// Whether this machine's lateness explains that a run ended with exit code 1: its faults are those of a
/// stall, and a thread was woken late during the run. A crash, another fault, or a stall on a punctual
/// machine is a failure.
/// @param summary  the run's summary, with `faults_seen`
[[nodiscard]] testing::AssertionResult MachineWasLate(const CommandResult& run, const nlohmann::json& summary,
                                                      rt::Nanoseconds worst_wakeup);

/// One attempt of a test whose run may end because of a late machine.
class Attempt {
 public:
  /// Call it for a run that has not done what the test expects: the test fails unless MachineWasLate() is
  /// true, and otherwise repeats the attempt. @param why  more text for the failure's message
  void ExpectLate(const CommandResult& run, const nlohmann::json& summary, const WakeupWatch& watch,
                  const std::string& why = {});

  /// Whether the run ended because of a late machine, so that the attempt proves nothing.
  [[nodiscard]] bool late() const { return worst_wakeup_ >= kLateWakeup; }
  [[nodiscard]] rt::Nanoseconds worst_wakeup() const { return worst_wakeup_; }

 private:
  rt::Nanoseconds worst_wakeup_{0};
};

/// Makes attempts until one is not late, three at most. After three late ones the test is skipped.
void RepeatWhileLate(const std::function<void(Attempt&)>& make);

}  // namespace osteon::app
