#pragma once

#include <algorithm>
#include <cstdint>

#include "base/marker.h"
#include "control/ports.h"

namespace osteon::control {

/// Counts the periods between two of the arm's messages: one, and one more for each message between them that
/// was lost in transit or overtaken before it was read. It uses counters instead of clocks, so that jitter
/// makes no motion faster or slower. A link's own sequence number (IPOC of RSI) may step by more than one and
/// cannot be used.
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
  // Increase of a counter; a counter falls when a message that counted as lost comes late.
  static double Increase(std::uint32_t now, std::uint32_t before) OSTEON_RT {
    return std::max(0.0, static_cast<double>(static_cast<std::int32_t>(now - before)));
  }

  bool known_{false};
  std::uint32_t lost_{0}, late_{0};
};

}  // namespace osteon::control
