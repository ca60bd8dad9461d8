#pragma once

#include "base/clock.h"
#include "base/marker.h"

namespace osteon::io {

/// Decides when a drive in fault is reset: at most kAttempts times, with a pause between the attempts, and
/// only while resets are allowed (control::CellCommands::clear_faults). If the fault returns after each
/// reset, a person must remove its cause.
class DriveReset {
 public:
  static constexpr int kAttempts = 3;
  /// Pause between two attempts: longer than a drive takes to boot and answer.
  static constexpr rt::Nanoseconds kBetween = rt::kSecond / 2;

  /// Call once per tick. Returns true if a reset should be tried now; call Count() after the reset.
  [[nodiscard]] bool IsDue(bool allowed, bool faulty, rt::Nanoseconds now) OSTEON_RT {
    if (!allowed) attempts_ = 0;
    return allowed && faulty && attempts_ < kAttempts && (attempts_ == 0 || now - last_ >= kBetween);
  }
  /// Counts a reset that was sent.
  void Count(rt::Nanoseconds now) OSTEON_RT {
    ++attempts_;
    last_ = now;
  }
  /// Number of resets counted since resets were allowed.
  [[nodiscard]] int attempts() const OSTEON_RT { return attempts_; }

 private:
  int attempts_{0};
  rt::Nanoseconds last_{0};
};

}  // namespace osteon::io
