#include "app/interrupt.h"

#include <csignal>

namespace osteon::app {
namespace {

std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

extern "C" void OnSignal(int signal_number) {
  g_interrupted.store(true);
  std::signal(signal_number, SIG_DFL);
}

PauseSignals g_pauses;

extern "C" void OnPauseSignal(int signal_number) {
  (signal_number == SIGUSR1 ? g_pauses.pause : g_pauses.resume).store(true);
}

}  // namespace

PauseSignals& AskedPauses() { return g_pauses; }

void InstallPause() {
  std::signal(SIGUSR1, OnPauseSignal);
  std::signal(SIGUSR2, OnPauseSignal);
}

std::atomic<bool>& Interrupted() { return g_interrupted; }

void InstallInterrupt() {
  std::signal(SIGINT, OnSignal);
  std::signal(SIGTERM, OnSignal);
}

}  // namespace osteon::app
