#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace osteon::session {

// The verdicts of a check: good for an arm; usable with a restriction, such as simulation only; missing.
inline constexpr const char* kCheckGood = "good";
inline constexpr const char* kCheckUsable = "usable";
inline constexpr const char* kCheckMissing = "missing";

/// One examined property of the machine and its verdict.
struct Check {
  std::string name, value;
  std::string verdict;      ///< kCheckGood, kCheckUsable or kCheckMissing
  std::string advice;       ///< what to do, or a remark; empty: nothing
  bool is_required{false};  ///< without this property the demo, or the named cell, cannot run
};

struct DoctorOptions {
  std::uint16_t fri_port{30200};  ///< port that a demo would listen on
  double seconds{10.0};           ///< duration of each of the two timer tests, with SCHED_FIFO and without
  std::filesystem::path json{};   ///< file for the checks as JSON; empty: none
  std::filesystem::path cell{};   ///< YAML file of a cell whose connections are examined as well; empty: none
};

/// Examines this machine: Vulkan devices, timer latency, scheduling and memory rights, kernel, network, CAN;
/// with a cell, also what its file names (cell_checks.h).
/// @param progress  called now and then with the time spent, out of 2 options.seconds; may be empty
[[nodiscard]] std::vector<Check> Examine(const DoctorOptions& options,
                                         const std::function<void(double at_s)>& progress);

/// Prints the checks; writes them to `json` unless empty. @returns 0, or 1 if the demo could not run here, or
/// something of the cell is missing. @throws config::ConfigError of the cell's file.
[[nodiscard]] int RunDoctor(const DoctorOptions& options);

}  // namespace osteon::session
