#pragma once

#include <optional>

#include "control/rt/clock.h"
#include "simulation/frame_record.h"

namespace osteon::app {

/// How long a turning tool was pressed into bone, and how much of that time it cut nothing. A frame that comes
/// late has a long way to go; where the proxy's slide alone takes all that a frame may go (`max_slide_um`),
/// nothing is left for the cut, and bone stays that the hand's force would have removed.
struct CutTime {
  /// @param spindle_turns  at the pose that the frame is for
  void Add(const simulation::FrameRecord& frame, bool spindle_turns);

  double pressed_s{0.0};  ///< with more than kPressed_N and an engaged surface
  double idle_s{0.0};     ///< of it, in frames that neither cut nor did any work

  /// Of the pressed time; 0 where it was never pressed.
  [[nodiscard]] double idle_share() const { return pressed_s > 0.0 ? idle_s / pressed_s : 0.0; }

  static constexpr double kPressed_N = 5.0;

 private:
  std::optional<rt::Nanoseconds> last_pose_;
};

}  // namespace osteon::app
