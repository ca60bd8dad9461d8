#pragma once

#include <cstddef>
#include <filesystem>

namespace osteon::studies {

/// Options of `osteon bench tick`.
struct BenchTickOptions {
  std::filesystem::path config_root;
  std::size_t ticks{10'000};  ///< number of timed ticks, counting only ticks in which the tool presses
  /// true: instead of the tick's stages, time the tick at each level of compliance (LevelsOf)
  bool compliance{false};
  /// File of a plan. If it is given, the tick is timed without guidance, with the plan's guidance at gain 0,
  /// and with guidance as planned, instead of the tick's stages. Empty: no plan.
  std::filesystem::path plan{};
  std::filesystem::path json{};
};

/// Times the whole servo tick of cells/demo.yaml at the pace of its period: FRI over loopback, the cell's CAN
/// devices in memory, the loop with eight planes at the tool, the answer, the recorder. After each tick, the
/// parts of the loop are timed once more on that tick's inputs. The wake-up is not included.
///
/// With a plan, times the tick without guidance, at gain 0 and guided, in turn.
/// With compliance, times the tick in turn with no compliant part, with a compliant tool, layer or mount, and
/// with all of them.
/// @returns the process's exit code: 0; 1 if the tool never pressed, a tick was not answered or the
/// figures can't be written; 2 bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunBenchTick(const BenchTickOptions& options);

}  // namespace osteon::studies
