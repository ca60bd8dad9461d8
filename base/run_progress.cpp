#include "base/run_progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

namespace osteon::app {
namespace {

constexpr double kEverySeconds = 10.0;  // between lines of a run without an end

}  // namespace

RunProgress::RunProgress(std::string name, double seconds)
    : name_(std::move(name)),
      seconds_(seconds),
      terminal_(isatty(STDERR_FILENO) != 0),
      next_(seconds > 0.0 ? 0.1 : kEverySeconds) {}

void RunProgress::Show(double at_s) {
  const double share = seconds_ > 0.0 ? std::min(1.0, at_s / seconds_) : 0.0;
  if (terminal_ && seconds_ > 0.0) {
    constexpr int kWidth = 40;
    const int filled = static_cast<int>(share * kWidth);
    fmt::print(stderr, "\r[{:{}}] {:4.1f} of {:.1f} s", std::string(static_cast<std::size_t>(filled), '#'),
               kWidth, share * seconds_, seconds_);
  } else if (terminal_) {
    fmt::print(stderr, "\r{:.1f} s", at_s);
  } else if (seconds_ > 0.0 && share >= next_) {
    fmt::print(stderr, "{}: {:.1f} of {:.1f} s\n", name_, share * seconds_, seconds_);
    next_ = std::floor(share * 10.0) / 10.0 + 0.1;
  } else if (seconds_ <= 0.0 && at_s >= next_) {
    fmt::print(stderr, "{}: {:.0f} s\n", name_, at_s);
    next_ = at_s + kEverySeconds;
  }
  std::fflush(stderr);
}

void RunProgress::Done() const {
  if (terminal_) fmt::print(stderr, "\r\033[K");
}

}  // namespace osteon::app
