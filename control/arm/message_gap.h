#pragma once

#include <algorithm>
#include <cstdint>

#include "base/marker.h"
#include "control/ports.h"

namespace osteon::control {

/// Counts the periods between two of the arm's messages: one, and one more for each message between them that
/// was lost in transit or overtaken before it was read. It uses the link's counters instead of a clock, so
/// that jitter does not change the result. It does not use the messages' sequence number, because that number
/// (IPOC of RSI) may increase by more than one per message.
class MessageGap {
 public:
  /// Call once per message. @returns periods since the message before, >= 1; 1 for the first
  double Step(const ArmState& state) OSTEON_RT {
    const double skipped = known_ ? Increase(state.lost, lost_) + Increase(state.late, late_) : 0.0;
    known_ = true;
    lost_ = state.lost;
    late_ = state.late;
    return 1.0 + skipped;
  }
  void Reset() OSTEON_RT { known_ = false; }

 private:
  // Increase of a counter, at least 0. A counter falls if a message that was counted as lost arrives late.
  static double Increase(std::uint32_t now, std::uint32_t before) OSTEON_RT {
    return std::max(0.0, static_cast<double>(static_cast<std::int32_t>(now - before)));
  }

  bool known_{false};
  std::uint32_t lost_{0}, late_{0};
};

}  // namespace osteon::control
