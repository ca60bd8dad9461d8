#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace osteon::app {

/// One thing that was looked at. verdict: "good", "usable" or "missing".
struct Check {
  std::string name, value, verdict, advice;
};

/// Looks at this machine: Vulkan devices, timer latency, scheduling and memory rights, network, CAN.
/// @param fri_port  the port that a demo would listen on
[[nodiscard]] std::vector<Check> Examine(std::uint16_t fri_port);

/// Prints the checks; writes them to `json` unless empty. @returns 0, or 1 where the demo could not run here.
[[nodiscard]] int RunDoctor(std::uint16_t fri_port, const std::filesystem::path& json);

}  // namespace osteon::app
