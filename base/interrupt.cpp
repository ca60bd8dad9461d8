#include "base/interrupt.h"

#include <csignal>

#include "base/clock.h"

namespace osteon::base {
namespace {

// `timeout` and some service managers send a signal twice at the same time: to the process and to its group.
// Only a second signal that comes later than this ends the process [ns].
constexpr rt::Nanoseconds kSameSignal = 500'000'000;

std::atomic<bool> g_interrupted{false};
std::atomic<int> g_signal{0};             // number of the first signal
std::atomic<rt::Nanoseconds> g_first{0};  // time of the first signal; 0: none yet
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<rt::Nanoseconds>::is_always_lock_free,
              "set from a signal handler");

extern "C" void OnSignal(int signal_number) {
  RequestInterrupt(signal_number);
  // a second SIGHUP ends nothing: the system, the shell and a service manager may each send one
  if (signal_number == SIGHUP) return;
  const rt::Nanoseconds now = rt::MonotonicNow();
  rt::Nanoseconds first = 0;
  if (!g_first.compare_exchange_strong(first, now) && now - first > kSameSignal) {
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
  }
}

OperatorRequests g_pauses;

extern "C" void OnPauseSignal(int signal_number) {
  (signal_number == SIGUSR1 ? g_pauses.pause : g_pauses.resume).store(true);
}

}  // namespace

OperatorRequests& AskedByOperator() { return g_pauses; }

void InstallPauseSignals() {
  std::signal(SIGUSR1, OnPauseSignal);
  std::signal(SIGUSR2, OnPauseSignal);
}

std::atomic<bool>& Interrupted() { return g_interrupted; }

void InstallInterrupt() {
  std::signal(SIGINT, OnSignal);
  std::signal(SIGTERM, OnSignal);
  if (std::signal(SIGHUP, OnSignal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

void RequestInterrupt(int signal_number) noexcept {
  int none = 0;
  g_signal.compare_exchange_strong(none, signal_number);
  g_interrupted.store(true);
}

const char* InterruptName() {
  switch (g_signal.load()) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    case SIGPIPE:
      return "SIGPIPE";
    case kOperatorsStop:
      return "operator";
    default:
      return "";
  }
}

int InterruptExitCode(int ctrl_c) {
  const int signal_number = g_signal.load();
  if (signal_number == kOperatorsStop) return 0;
  return signal_number == SIGHUP || signal_number == SIGPIPE ? 128 + signal_number : ctrl_c;
}

}  // namespace osteon::base
