#pragma once

#include <cstddef>
#include <filesystem>

namespace osteon::studies {

/// Options of `osteon bench tick`.
struct BenchTickOptions {
  std::filesystem::path config_root;
  std::size_t ticks{10'000};  ///< number of timed ticks: only ticks in which the tool presses count
  bool compliance{false};     ///< time the tick with each part that may give way instead of its stages
  /// A plan: the tick is timed without guidance, with the plan's at gain 0 and as planned, in turn, instead
  /// of the tick's stages. Empty: no plan.
  std::filesystem::path plan{};
  std::filesystem::path json{};
};

/// Times the whole servo tick of cells/demo.yaml at the pace of its period: FRI over loopback, the cell's CAN
/// devices in memory, the loop with eight planes at the tool, the answer, the recorder. After each tick, the
/// parts of the loop are timed once more on that tick's inputs. The wake-up is not included.
///
/// With a plan, times the tick without guidance, at gain 0 and guided, in turn.
/// With compliance, times the tick in turn while nothing, the tool, the layer, the mount, or all give way.
/// @returns the process's exit code: 0; 1 if the tool never pressed, a tick was not answered or the
/// figures can't be written; 2 bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunBenchTick(const BenchTickOptions& options);

}  // namespace osteon::studies
