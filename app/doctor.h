#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace osteon::app {

// Verdicts of a check.
inline constexpr const char* kCheckGood = "good";
inline constexpr const char* kCheckUsable = "usable";
inline constexpr const char* kCheckMissing = "missing";

/// One thing that was looked at.
struct Check {
  std::string name, value, verdict, advice;
};

struct DoctorOptions {
  std::uint16_t fri_port{30200};  ///< that a demo would listen on
  double seconds{10.0};           ///< of timer latency, as often: with SCHED_FIFO and without
  std::filesystem::path json{};
};

/// Looks at this machine: Vulkan devices, timer latency, scheduling and memory rights, kernel, network, CAN.
/// @param progress  called now and then with the time spent, of 2 options.seconds; may be empty
[[nodiscard]] std::vector<Check> Examine(const DoctorOptions& options,
                                         const std::function<void(double at_s)>& progress);

/// Prints the checks; writes them to `json` unless empty. @returns 0, or 1 where the demo could not run here.
[[nodiscard]] int RunDoctor(const DoctorOptions& options);

}  // namespace osteon::app
