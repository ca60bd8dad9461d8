#pragma once

#include <cstddef>
#include <filesystem>

namespace osteon::studies {

/// Options of `osteon bench tick`.
struct BenchTickOptions {
  std::filesystem::path config_root;
  std::size_t ticks{10'000};  ///< to time: only ticks in which the tool presses count
  bool compliance{false};     ///< each part that may give way, in turn, instead of the tick's stages
  /// A plan whose guidance is timed, none, at gain 0 and as planned in turn, instead of the tick's stages.
  std::filesystem::path plan{};
  std::filesystem::path json{};
};

/// Times the whole servo tick of cells/demo.yaml at the pace of its period: FRI over loopback, the cell's CAN
/// devices in memory, the loop with eight planes at the tool, the answer, the recorder. Beside each tick, the
/// parts of the loop are timed on that tick's inputs. The wake-up is not included.
///
/// With a plan, times the tick without guidance, at gain 0 and guided, in turn.
/// With compliance, times the tick with nothing, tool, layer, mount and all of them giving way, in turn.
/// @returns the process's exit code: 0; 1 if the tool never pressed, a tick was not answered or the
/// figures can't be written; 2 bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunBenchTick(const BenchTickOptions& options);

}  // namespace osteon::studies
