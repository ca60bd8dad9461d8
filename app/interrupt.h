#pragma once

#include <atomic>

namespace osteon::app {

/// Set by the first Ctrl-C (SIGINT) or SIGTERM once InstallInterrupt was called; another one half a second
/// later or more ends the process at once.
[[nodiscard]] std::atomic<bool>& Interrupted();
void InstallInterrupt();

/// What an operator asks a running cell for by a signal, once InstallPause was called: SIGUSR1 a pause,
/// SIGUSR2 its end. Whoever acts on one clears it.
struct PauseSignals {
  std::atomic<bool> pause{false}, resume{false};
};
[[nodiscard]] PauseSignals& AskedPauses();
void InstallPause();

/// Exit code of a run that was ended by Ctrl-C, as a shell reports it: 128 + SIGINT.
inline constexpr int kExitInterrupted = 130;

}  // namespace osteon::app
