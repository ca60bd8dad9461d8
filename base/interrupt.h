#pragma once

#include <atomic>

namespace osteon::app {

/// A flag that becomes true at the first Ctrl-C (SIGINT), SIGTERM or SIGHUP (a terminal that was closed)
/// after InstallInterrupt, and by RequestInterrupt. A second SIGINT or SIGTERM, half a second or more after
/// the first, ends the process at once; SIGHUP never does.
[[nodiscard]] std::atomic<bool>& Interrupted();
/// Installs the handlers. A SIGHUP that is ignored (`nohup`) stays ignored.
void InstallInterrupt();
/// Sets the flag as if the signal had come: SIGPIPE if nobody reads the output any more. Any thread.
void RequestInterrupt(int signal_number) noexcept;
/// Name of the first signal: "SIGINT", "SIGTERM", "SIGHUP", "SIGPIPE"; empty if there was none.
[[nodiscard]] const char* InterruptName();

/// An operator's requests to a running cell by signal, after InstallPause: SIGUSR1 asks for a pause, SIGUSR2
/// for its end. Whoever acts on a request clears it.
struct PauseSignals {
  std::atomic<bool> pause{false}, resume{false};
};
[[nodiscard]] PauseSignals& AskedPauses();
void InstallPause();

/// Exit code of a run that was ended by Ctrl-C, as a shell reports it: 128 + SIGINT. Also for SIGTERM.
inline constexpr int kExitInterrupted = 130;

/// Exit code of an interrupted process: 129 (128 + SIGHUP) if the terminal was closed, 141 (128 + SIGPIPE) if
/// nobody reads the output, else `ctrl_c`.
[[nodiscard]] int InterruptExitCode(int ctrl_c = kExitInterrupted);

}  // namespace osteon::app
