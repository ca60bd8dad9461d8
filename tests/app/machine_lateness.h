#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "control/rt/clock.h"
#include "tests/app/command.h"

// A run in wall time may stall because this machine has no time for it, and then shows nothing about the
// product. That is measured, not assumed: a test is skipped only where its own threads were woken late
// meanwhile.

namespace osteon::app {

/// From here on threads of this process, one on each CPU, sleep for a millisecond at a time; how late they
/// are woken is what every program of this machine had to live with. They have no real-time rights: nor have
/// the simulation and the simulated devices.
class WakeupWatch {
 public:
  WakeupWatch();
  ~WakeupWatch();
  WakeupWatch(const WakeupWatch&) = delete;
  WakeupWatch& operator=(const WakeupWatch&) = delete;

  /// The latest wake-up so far.
  [[nodiscard]] rt::Nanoseconds worst() const { return worst_.load(); }

 private:
  std::atomic<bool> ends_{false};
  std::atomic<rt::Nanoseconds> worst_{0};
  std::vector<std::thread> threads_;
};

/// A wake-up this late loses ten messages of an arm: twice what the loop and the simulated arms bear.
inline constexpr rt::Nanoseconds kLateWakeup = 10 * rt::kMillisecond;

/// Whether all faults of a summary say that something came too late, or follow from that.
[[nodiscard]] bool IsStall(const nlohmann::json& summary);

/// Whether lateness of this machine explains that a run ended with exit code 1: its faults are those of a
/// stall, and a thread beside it was woken late. A crash, another fault, or a stall on a punctual machine are
/// failures.
/// @param summary  the run's, with `faults`
[[nodiscard]] testing::AssertionResult MachineWasLate(const CommandResult& run, const nlohmann::json& summary,
                                                      rt::Nanoseconds worst_wakeup);

/// What a test says that is skipped after a number of such runs.
[[nodiscard]] std::string SkippedForLateness(int attempts, rt::Nanoseconds worst_wakeup);

}  // namespace osteon::app
