#pragma once

#include "studies/bench/bench_console.h"

namespace osteon::studies {

/// Runs `osteon bench console --reloads N`.
/// @returns the process's exit code, as RunBenchConsole
[[nodiscard]] int RunBenchReloads(const BenchConsoleOptions& options);

}  // namespace osteon::studies
