#pragma once

#include <cstddef>
#include <filesystem>

namespace osteon::app {

/// `osteon bench tick`.
struct BenchTickOptions {
  std::filesystem::path config_root;
  std::size_t ticks{10'000};  ///< timed: those in which the tool presses
  std::filesystem::path json{};
};

/// Times the whole servo tick of cells/demo.yaml, paced by its period: FRI over the loopback, the cell's CAN
/// devices in memory, the loop with eight planes at the tool, the answer, the recorder; and, beside each
/// tick, the parts of the loop on that tick's inputs. The wake-up is not in it.
/// @returns the process's exit code: 0; 1 where the tool never pressed, a tick was not answered or the
/// figures can't be written; 2 bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunBenchTick(const BenchTickOptions& options);

}  // namespace osteon::app
