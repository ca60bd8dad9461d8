#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace osteon::studies {

/// Options of `osteon bench console`.
struct BenchConsoleOptions {
  int rounds{5};
  double seconds{12.0};    ///< length of each demo
  int reloads{0};          ///< above 0: pages that are loaded and left during one demo, instead of the rounds
  std::string chromium{};  ///< program that opens the page; empty: no leg with a browser
  std::filesystem::path json{};
};

/// Measures how much the console costs a running cell. It runs the demo in turn without the console, with
/// eight pages of which one does not read, with one page, with one page while other work keeps every core
/// busy, and with a page in a browser. The figures are medians over rounds: the tick's compute time and
/// wake-up, and the frame. It also measures how often the carved bone reaches a page while it is cut, how old
/// it is then, and the time from a tick until a page without a browser has received the tick's figures, and
/// until the browser has drawn them.
///
/// If `reloads` is above 0, a page is instead loaded and left that many times during one demo, every third
/// time as if it were killed. This must cause no fault in the demo, and leave no descriptors, threads or
/// memory.
/// @returns the process's exit code: 0; 1 if a demo failed, reloads left resources, or the figures can't be
///   written; 130 if ended by Ctrl-C.
[[nodiscard]] int RunBenchConsole(const BenchConsoleOptions& options);

}  // namespace osteon::studies
