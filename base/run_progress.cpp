#include "base/run_progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "base/text.h"

namespace osteon::base {
namespace {

constexpr double kLinePeriod_s = 10.0;                  // time between two lines of a run without an end
constexpr rt::Nanoseconds kStatusPeriod = 100'000'000;  // time between two status lines on a terminal

}  // namespace

RunProgress::RunProgress(std::string name, double seconds)
    : name_(std::move(name)),
      seconds_(seconds),
      terminal_(isatty(STDERR_FILENO) != 0),
      next_(seconds > 0.0 ? 0.1 : kLinePeriod_s) {}

std::size_t RunProgress::StatusColumns() { return TerminalColumns(STDERR_FILENO).value_or(201) - 1; }

void RunProgress::Show(double at_s) { Show(at_s, ""); }

void RunProgress::Show(double at_s, std::string_view status) {
  const double share = seconds_ > 0.0 ? std::min(1.0, at_s / seconds_) : 0.0;
  if (terminal_ && !status.empty()) {
    if (const rt::Nanoseconds now = rt::MonotonicNow(); now - shown_ >= kStatusPeriod) {
      shown_ = now;
      fmt::print(stderr, "\r\033[K{}", status);
    }
  } else if (terminal_ && seconds_ > 0.0) {
    constexpr int kWidth = 40;  // columns of the bar
    const int filled = static_cast<int>(share * kWidth);
    fmt::print(stderr, "\r[{:{}}] {:4.1f} of {:.1f} s", std::string(static_cast<std::size_t>(filled), '#'),
               kWidth, share * seconds_, seconds_);
  } else if (terminal_) {
    fmt::print(stderr, "\r{:.1f} s", at_s);
  } else if (seconds_ > 0.0 && share >= next_) {
    if (status.empty())
      fmt::print(stderr, "{}: {:.1f} of {:.1f} s\n", name_, share * seconds_, seconds_);
    else
      fmt::print(stderr, "{}: {}\n", name_, status);
    next_ = std::floor(share * 10.0) / 10.0 + 0.1;
  } else if (seconds_ <= 0.0 && at_s >= next_) {
    if (status.empty())
      fmt::print(stderr, "{}: {:.0f} s\n", name_, at_s);
    else
      fmt::print(stderr, "{}: {}\n", name_, status);
    next_ = at_s + kLinePeriod_s;
  }
  std::fflush(stderr);
}

void RunProgress::Done() const {
  if (terminal_) fmt::print(stderr, "\r\033[K");
}

}  // namespace osteon::base
