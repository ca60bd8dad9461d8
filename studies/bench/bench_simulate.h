#pragma once

#include <filesystem>
#include <string>

namespace osteon::studies {

/// Options of `osteon bench simulate`.
struct BenchSimulateOptions {
  std::filesystem::path config_root;
  int ticks{5000};  ///< per round, one each millisecond
  int rounds{3};    ///< number of rounds over all three connections
  std::string engine{"auto"};
  std::string device{};
  std::filesystem::path json{};
};

/// Measures the age of the contact model in each tick of a loop at 1 kHz, and the time from a tick's command
/// until the contact model for this command is available. It compares three connections in turn, with the
/// same bone, tool and poses: the engine as a thread of this process, in a process of its own by shared
/// memory, and in a process of its own by UDP on the loopback.
/// @returns the process's exit code: 0; 1 if an engine could not be made; 130 if ended by Ctrl-C.
[[nodiscard]] int RunBenchSimulate(const BenchSimulateOptions& options);

}  // namespace osteon::studies
