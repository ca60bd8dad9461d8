#pragma once

#include "base/clock.h"
#include "simulation/engine/frame_record.h"

namespace osteon::session {

/// A pass ends after the tool has touched no bone for this long.
inline constexpr rt::Nanoseconds kClearOfPass = rt::kSecond / 2;

/// Longest time from one frame to the next that is added to the cutting time [s]. Of a longer gap, which is a
/// stall of the simulation, only this much is added.
inline constexpr double kMaxFrameGap_s = 0.1;

/// Decides in which frames bone is removed. A session's passes and its assessment both use this rule:
///
///     spindle turns, and (more volume is gone than in the frame before, or the bone gives way)
///
/// Mass points vanish one by one. In a slow cut, frames between two such points are also frames in which bone
/// is removed: the cut face advances, although no volume is gone yet.
class CutDetector {
 public:
  /// Takes the next frame. @param spindle_rad_per_s  spindle speed in the command for this frame
  /// @returns whether bone is removed in this frame; false for a frame with an error
  bool Step(const simulation::ContactModel& model, double spindle_rad_per_s);
  /// Begins again: the next frame is the first of another state of the bone.
  void Restart() { known_ = false; }

  /// Removed volume after the last frame, and before it; both are equal in the first frame.
  [[nodiscard]] double removed_m3() const { return removed_m3_; }
  [[nodiscard]] double removed_before_m3() const { return before_m3_; }

 private:
  bool known_{false};
  double removed_m3_{0.0}, before_m3_{0.0};
};

/// Finds the passes of a reaming: from the first frame in which the turning tool removes bone until the tool
/// has been clear of bone for kClearOfPass.
class PassDetector {
 public:
  enum class Change { kNone, kBegan, kEnded };

  /// Takes the next frame. @param stamp  stamp of its pose  @param spindle_rad_per_s  spindle speed in the
  /// command for this frame
  /// @returns whether a pass has begun or ended
  Change Step(const simulation::ContactModel& model, rt::Nanoseconds stamp, double spindle_rad_per_s);
  /// Ends the pass now. The next frame is the first of another state of the bone.
  void Restart();

  [[nodiscard]] bool open() const { return open_; }
  /// Whether the last frame had no contact.
  [[nodiscard]] bool clear() const { return clear_; }
  // the following values are those of the open pass or, if none is open, of the last pass
  [[nodiscard]] rt::Nanoseconds begin() const { return begin_; }
  /// Total time of the frames in which bone was removed (CutDetector).
  [[nodiscard]] double cutting_s() const { return cutting_s_; }
  [[nodiscard]] double removed_m3() const { return cut_.removed_m3() - removed_at_begin_m3_; }

 private:
  CutDetector cut_;
  bool open_{false}, clear_{true};
  rt::Nanoseconds begin_{0}, clear_since_{0}, last_{0};
  double cutting_s_{0.0}, removed_at_begin_m3_{0.0};
};

}  // namespace osteon::session
