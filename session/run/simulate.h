#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace osteon::session {

/// The default port of `osteon simulate`.
inline constexpr std::uint16_t kSimulatePort = 30300;

struct SimulateOptions {
  std::filesystem::path local{};  ///< folder of a run on this machine, with the shared memory; empty: UDP
  std::string address{"127.0.0.1"};
  std::uint16_t port{kSimulatePort};
  std::filesystem::path token_file{};  ///< file with the token; needed except for a loopback address
  std::string engine{"auto"};          ///< one of WallTimeEngineNames
  std::string device{};                ///< part of a Vulkan device's name
  std::filesystem::path json{};        ///< file for the report, written at the process's end
};

/// Runs `osteon simulate`: the cutting engine in a process of its own. It serves one run after the other
/// until Ctrl-C; with `local`, it serves one run and ends with it.
/// @returns the process's exit code: 0 ended by Ctrl-C, SIGTERM or with its run; 1 no engine could be made;
/// 2 wrong input, or the port is taken.
[[nodiscard]] int RunSimulate(const SimulateOptions& options);

}  // namespace osteon::session
