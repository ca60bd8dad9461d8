#pragma once

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/cpu_watch.h"
#include "tests/app/command.h"

// A run in wall time may stall because this machine is overloaded, and then proves nothing about the product.
// The overload is measured, not assumed: a test is skipped only if its threads were woken late.

namespace osteon::app {

/// Measures from its construction on how late this machine wakes a thread on each CPU. The threads have no
/// real-time priority, like those of the simulation and the simulated devices.
class WakeupWatch {
 public:
  /// How late the latest wake-up so far was.
  [[nodiscard]] rt::Nanoseconds worst() const { return watch_.longest(); }

 private:
  rt::CpuWatch watch_{0};
};

/// A wake-up this late loses ten messages of an arm: twice what the loop and the simulated arms tolerate.
inline constexpr rt::Nanoseconds kLateWakeup = 10 * rt::kMillisecond;

/// Whether a fault of the summary reports lateness, and all others report it too or may follow from it.
[[nodiscard]] bool IsStall(const nlohmann::json& summary);

/// Whether this machine's lateness explains that a run ended with exit code 1: its faults are those of a
/// stall, and a thread was woken late meanwhile. Crashes, other faults, or stalls on a punctual machine are
/// failures.
/// @param summary  the run's, with `faults`
[[nodiscard]] testing::AssertionResult MachineWasLate(const CommandResult& run, const nlohmann::json& summary,
                                                      rt::Nanoseconds worst_wakeup);

/// The message of a test that is skipped after a number of such runs.
[[nodiscard]] std::string SkippedForLateness(int attempts, rt::Nanoseconds worst_wakeup);

}  // namespace osteon::app
