#pragma once

#include <atomic>

namespace osteon::app {

/// Becomes true at the first Ctrl-C (SIGINT), SIGTERM or SIGHUP (a terminal that was closed) once
/// InstallInterrupt was called, and where RequestInterrupt was. A second SIGINT or SIGTERM, half a second
/// after the first or later, ends the process at once; SIGHUP never does.
[[nodiscard]] std::atomic<bool>& Interrupted();
/// A SIGHUP that is ignored (`nohup`) stays so.
void InstallInterrupt();
/// As if the signal had come: SIGPIPE where nobody reads what is printed any more. Any thread.
void RequestInterrupt(int signal_number) noexcept;
/// The first of them: "SIGINT", "SIGTERM", "SIGHUP", "SIGPIPE"; empty where there was none.
[[nodiscard]] const char* InterruptName();

/// What an operator asks a running cell for by a signal, once InstallPause was called: SIGUSR1 a pause,
/// SIGUSR2 its end. Whoever acts on one clears it.
struct PauseSignals {
  std::atomic<bool> pause{false}, resume{false};
};
[[nodiscard]] PauseSignals& AskedPauses();
void InstallPause();

/// Exit code of a run that was ended by Ctrl-C, as a shell reports it: 128 + SIGINT. Also of SIGTERM.
inline constexpr int kExitInterrupted = 130;

/// Of what was interrupted: 129 (128 + SIGHUP) where the terminal was closed, 141 (128 + SIGPIPE) where
/// nobody reads what is printed, else `ctrl_c`.
[[nodiscard]] int InterruptExitCode(int ctrl_c = kExitInterrupted);

}  // namespace osteon::app
