#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace osteon::studies {

/// Options of `osteon bench console`.
struct BenchConsoleOptions {
  int rounds{5};
  double seconds{12.0};    ///< of each demo
  int reloads{0};          ///< above 0: pages that are loaded and left during one demo, instead of the rounds
  std::string chromium{};  ///< program that opens the page; empty: no leg with a browser
  std::filesystem::path json{};
};

/// Measures what the console costs a cell that runs: the demo without it, with eight pages of which one does
/// not read, with one page, with one page while other work keeps every core busy, and with a page in a
/// browser, in turn; the tick's compute and wake-up and the frame, as medians over rounds. Also how often the
/// carved bone reaches a page while it is cut, how old it is then, and the time from a tick to its figures:
/// taken by a page without a browser, and drawn by the browser.
///
/// With `reloads` a page is loaded and left so often during a demo, every third of them as by a kill: the
/// demo must have no fault for it, and hold neither descriptors, threads nor memory afterwards.
/// @returns the process's exit code: 0; 1 a demo failed, reloads left something, or the figures can't be
/// written; 130 ended by Ctrl-C.
[[nodiscard]] int RunBenchConsole(const BenchConsoleOptions& options);

}  // namespace osteon::studies
