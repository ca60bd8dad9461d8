#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace osteon::studies {

/// Options of `osteon bench console`.
struct BenchConsoleOptions {
  int rounds{5};
  double seconds{12.0};    ///< of each demo
  std::string chromium{};  ///< program that opens the page; empty: no leg with a browser
  std::filesystem::path json{};
};

/// Measures what the console costs a cell that runs: the demo without it, with eight pages of which one does
/// not read, with one page, with one page while other work keeps every core busy, and with a page in a
/// browser, in turn; the tick's compute and wake-up and the frame, as medians over rounds. Also how often the
/// carved bone reaches a page while it is cut, and how old it is then.
/// @returns the process's exit code: 0; 1 a demo failed, or the figures can't be written; 130 ended by
/// Ctrl-C.
[[nodiscard]] int RunBenchConsole(const BenchConsoleOptions& options);

}  // namespace osteon::studies
