#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "control/tick_record.h"
#include "report/duration_counts.h"
#include "report/thin_curve.h"
#include "simulation/engine/frame_record.h"

namespace osteon::report {

/// A part of a run in one phase, paused or not.
struct PhaseStretch {
  control::Phase phase{control::Phase::kWaiting};
  bool paused{false};  ///< by the operator
  /// Stamps of the part's first tick, and of the first tick after the part; for the last part, of the run's
  /// last tick.
  rt::Nanoseconds begin{0}, end{0};
};

/// The data for a run's charts (run_charts.h), collected tick by tick and frame by frame. Memory stays at
/// some 20 MB, also for a run of hours.
struct RunCurves {
  /// Computes the depth of the tool's apex below the site's first floor [m] from X_WT; empty: the commanded
  /// depth is not drawn.
  std::function<double(const Pose&)> depth_of{};

  void Add(const control::TickRecord& tick);
  void Add(const simulation::FrameRecord& frame);

  /// The stamp at which time is 0: the first tick's, or the first frame's if there is no tick.
  [[nodiscard]] rt::Nanoseconds Start() const;

  // of the ticks
  std::optional<rt::Nanoseconds> first_tick, last_tick;  ///< stamps
  std::vector<PhaseStretch> phases;
  /// Sizes of the coupling's and the hand's force; axial: the coupling's part that resists the feed. NaN if
  /// nothing was computed.
  ThinCurve coupling_N, axial_N, hand_N;
  /// The fractions of the coupling's wrench that are rendered, and that the arm's torques can hold.
  ThinCurve rendered_percent, arm_percent;
  ThinCurve speed_mm_per_s, in_bone_mm, model_age_ms;
  /// Depth of the commanded tool's apex below the first floor, while the tool is in bone; else NaN.
  ThinCurve commanded_depth_mm;
  /// How far the tool bends, its surface layer gives way, and the bone moves on its mount. Empty curves: the
  /// cell is rigid. A part whose compliance is off stays at zero.
  ThinCurve bend_mm, layer_mm, mount_mm;
  bool bends{false}, has_layer{false}, mount_moves{false};  ///< in any tick
  bool wrench_cut{false};  ///< limits reduced the wrench in some tick; if not, rendered_percent stays 100
  DurationCounts wakeup, compute;  ///< from the arm's message to the wake-up, and from there to the answer

  // of the frames
  std::optional<rt::Nanoseconds> first_frame;  ///< stamp
  ThinCurve depth_mm, volume_mm3;              ///< depth: NaN before the first touch
  bool touched{false};                         ///< the tool has met bone in some frame
  DurationCounts frame;                        ///< time to compute a frame

 private:
  void AddCompliance(const control::TickRecord& tick);
};

}  // namespace osteon::report
