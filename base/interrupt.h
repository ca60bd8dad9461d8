#pragma once

#include <atomic>

namespace osteon::base {

/// A flag that becomes true at the first Ctrl-C (SIGINT), SIGTERM or SIGHUP (a terminal that was closed)
/// after InstallInterrupt, and by RequestInterrupt. A second SIGINT or SIGTERM, half a second or more after
/// the first, ends the process at once; SIGHUP never does.
[[nodiscard]] std::atomic<bool>& Interrupted();
/// Installs the handlers. A SIGHUP that is ignored (`nohup`) stays ignored.
void InstallInterrupt();
/// Sets the flag as if this signal had arrived: SIGPIPE if nobody reads the output any more, kOperatorsStop
/// for a stop by `osteon stop` or the console. Any thread.
void RequestInterrupt(int signal_number) noexcept;
inline constexpr int kOperatorsStop = 1000;  // larger than the number of any signal
/// Name of the first request: "SIGINT", "SIGTERM", "SIGHUP", "SIGPIPE", "operator"; empty if there was none.
[[nodiscard]] const char* InterruptName();

/// An operator's requests to a running cell: by `osteon pause`, `resume` and `recover`, by the console, and,
/// after InstallPauseSignals, by SIGUSR1 (a pause) and SIGUSR2 (its end). The
/// code that acts on a request clears it.
struct OperatorRequests {
  std::atomic<bool> pause{false}, resume{false}, recover{false};
};
/// The requests to this process. Any thread.
[[nodiscard]] OperatorRequests& AskedByOperator();
/// Installs the handlers of SIGUSR1 and SIGUSR2.
void InstallPauseSignals();

/// Exit code of a run that was ended by Ctrl-C, as a shell reports it: 128 + SIGINT. A run that was ended by
/// SIGTERM has the same exit code.
inline constexpr int kExitInterrupted = 130;

/// Exit code of an interrupted process: 129 (128 + SIGHUP) if the terminal was closed, 141 (128 + SIGPIPE) if
/// nobody reads the output, 0 after an operator's stop, since such an end is no failure. Otherwise `ctrl_c`.
[[nodiscard]] int InterruptExitCode(int ctrl_c = kExitInterrupted);

}  // namespace osteon::base
