#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "control/tick_record.h"
#include "report/duration_counts.h"
#include "report/thin_curve.h"
#include "simulation/engine/frame_record.h"

namespace osteon::report {

/// A part of a run in which neither the phase nor the pause changes.
struct PhaseStretch {
  control::Phase phase{control::Phase::kWaiting};
  bool paused{false};  ///< by the operator
  /// Stamps of the part's first tick and of the first tick after the part. The last part of a run ends at the
  /// run's last tick.
  rt::Nanoseconds begin{0}, end{0};
};

/// The data for a run's charts (run_charts.h), collected tick by tick and frame by frame. Memory stays below
/// some 20 MB even for a run of hours.
struct RunCurves {
  /// Computes, from X_WT, the depth of the tool's apex below the floor of the uncut site [m]; empty: the
  /// commanded depth is not drawn.
  std::function<double(const Pose&)> depth_of{};

  void Add(const control::TickRecord& tick);
  void Add(const simulation::FrameRecord& frame);

  /// The stamp at which time is 0: the first tick's, or the first frame's if there is no tick.
  [[nodiscard]] rt::Nanoseconds Start() const;

  // from the ticks
  std::optional<rt::Nanoseconds> first_tick, last_tick;  ///< stamps
  std::vector<PhaseStretch> phases;
  /// Magnitudes of the coupling's force and of the hand's force; axial_N is the component of the coupling's
  /// force that resists the feed. NaN in ticks in which nothing was computed.
  ThinCurve coupling_N, axial_N, hand_N;
  /// The fraction of the coupling's wrench that is rendered, and the fraction that the arm's joint torques
  /// can hold.
  ThinCurve rendered_percent, arm_percent;
  ThinCurve speed_mm_per_s, in_bone_mm, model_age_ms;
  /// Depth of the commanded tool's apex below the floor of the uncut site, while the tool is in bone; else
  /// NaN.
  ThinCurve commanded_depth_mm;
  /// Bending of the tool, compression of the tissue layer, and displacement of the bone on its mount. The
  /// curves are empty if the cell has no compliance. A part whose compliance is off stays at zero.
  ThinCurve bend_mm, layer_mm, mount_mm;
  bool bends{false}, has_layer{false}, mount_moves{false};  ///< whether the part moved in any tick
  bool wrench_cut{false};  ///< limits reduced the wrench in some tick; if not, rendered_percent stays 100
  /// time from the arm's message to the wake-up, and from the wake-up to the answer
  DurationCounts wakeup, compute;

  // from the frames
  std::optional<rt::Nanoseconds> first_frame;  ///< stamp
  ThinCurve depth_mm, volume_mm3;              ///< depth: NaN before the first touch
  bool touched{false};                         ///< the tool has met bone in some frame
  DurationCounts frame;                        ///< time to compute a frame

 private:
  void AddCompliance(const control::TickRecord& tick);
};

}  // namespace osteon::report
