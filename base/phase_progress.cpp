#include "base/phase_progress.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>

#include <fmt/format.h>

#include "base/clock.h"

namespace osteon::base {

PhaseProgress::PhaseProgress(std::string command, int phases, bool lines)
    : command_(std::move(command)),
      count_(phases),
      terminal_(isatty(STDERR_FILENO) != 0),
      lines_(lines && !terminal_) {
  if (terminal_) drawer_ = std::jthread([this](std::stop_token stop) { Draw(stop); });
}

PhaseProgress::~PhaseProgress() { Done(); }

void PhaseProgress::BeginPhase(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  EndPhase();
  running_ = name;
  begun_s_ = rt::ToSeconds(rt::MonotonicNow());
  if (lines_) fmt::print(stderr, "{}: {} of {}: {}\n", command_, done_.size() + 1, count_, name);
}

void PhaseProgress::EndPhase() {
  if (!running_.empty())
    done_.push_back({.name = running_, .seconds = rt::ToSeconds(rt::MonotonicNow()) - begun_s_});
  running_.clear();
}

void PhaseProgress::Done() {
  if (drawer_.joinable()) {
    drawer_.request_stop();
    drawer_.join();
    fmt::print(stderr, "\r\033[K");
    std::fflush(stderr);
  }
  const std::scoped_lock lock(mutex_);
  EndPhase();
}

void PhaseProgress::Draw(std::stop_token stop) {
  constexpr int kWidth = 30;  // columns of the bar
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (!running_.empty()) {
      const int filled = kWidth * static_cast<int>(done_.size()) / count_;
      fmt::print(stderr, "\r\033[K[{:{}}] {}, {:.1f} s", std::string(static_cast<std::size_t>(filled), '#'),
                 kWidth, running_, rt::ToSeconds(rt::MonotonicNow()) - begun_s_);
      std::fflush(stderr);
    }
    wake_.wait_for(lock, stop, std::chrono::milliseconds(100), [] { return false; });
  }
}

}  // namespace osteon::base
