#pragma once

#include "base/clock.h"
#include "base/marker.h"

namespace osteon::io {

/// Decides when a drive in fault is reset: a few times, with a pause between the attempts, and only while
/// resets are allowed (control::CellCommands::clear_faults). A fault that comes back after each reset needs a
/// person.
class DriveReset {
 public:
  static constexpr int kAttempts = 3;
  /// Pause between two attempts: longer than a drive takes to boot and answer.
  static constexpr rt::Nanoseconds kBetween = rt::kSecond / 2;

  /// Call once a tick. True if a reset should be tried now; call Count() after a reset.
  [[nodiscard]] bool IsDue(bool allowed, bool faulty, rt::Nanoseconds now) OSTEON_RT {
    if (!allowed) attempts_ = 0;
    return allowed && faulty && attempts_ < kAttempts && (attempts_ == 0 || now - last_ >= kBetween);
  }
  /// Counts a reset that was sent.
  void Count(rt::Nanoseconds now) OSTEON_RT {
    ++attempts_;
    last_ = now;
  }
  /// Number of resets since they were allowed.
  [[nodiscard]] int attempts() const OSTEON_RT { return attempts_; }

 private:
  int attempts_{0};
  rt::Nanoseconds last_{0};
};

}  // namespace osteon::io
