#pragma once

#include <filesystem>
#include <string>

namespace osteon::studies {

/// Options of `osteon bench simulate`.
struct BenchSimulateOptions {
  std::filesystem::path config_root;
  int ticks{5000};  ///< in a round, one each millisecond
  int rounds{3};    ///< over all three ways
  std::string engine{"auto"};
  std::string device{};
  std::filesystem::path json{};
};

/// Times how old the contact model is in each tick of a loop at 1 kHz, and how soon a tick's command has its
/// model, with the engine as a thread of this
/// process, in a process of its own by shared memory, and by UDP on the loopback: the same bone, tool and
/// poses, in turns.
/// @returns the process's exit code: 0; 1 if an engine could not be made; 130 ended by Ctrl-C.
[[nodiscard]] int RunBenchSimulate(const BenchSimulateOptions& options);

}  // namespace osteon::studies
