#pragma once

#include <optional>
#include <vector>

#include "app/report/duration_counts.h"
#include "app/report/thin_curve.h"
#include "control/tick_record.h"
#include "simulation/frame_record.h"

namespace osteon::app {

/// A part of a run in one phase, paused or not.
struct PhaseStretch {
  control::Phase phase{control::Phase::kWaiting};
  bool paused{false};  ///< by the operator
  /// Stamps of its first tick and of the one after it, or of the last of all.
  rt::Nanoseconds begin{0}, end{0};
};

/// What the charts of a run (run_charts.h) show, gathered tick by tick and frame by frame. A run of hours
/// needs no more memory than one of minutes, some 20 MB.
struct RunCurves {
  void Add(const control::TickRecord& tick);
  void Add(const simulation::FrameRecord& frame);

  /// The first tick's stamp; without a tick the first frame's: what times count from.
  [[nodiscard]] rt::Nanoseconds Start() const;

  // of the ticks
  std::optional<rt::Nanoseconds> first_tick, last_tick;  ///< stamps
  std::vector<PhaseStretch> phases;
  ThinCurve coupling_N, axial_N, hand_N;    ///< NaN where nothing was computed
  ThinCurve rendered_percent, arm_percent;  ///< of the coupling's wrench: rendered, and that the arm can hold
  ThinCurve speed_mm_per_s, in_bone_mm, model_age_ms;
  bool wrench_cut{false};  ///< ever: else rendered_percent says nothing
  DurationCounts wakeup, compute;

  // of the frames
  std::optional<rt::Nanoseconds> first_frame;  ///< stamp
  ThinCurve depth_mm, volume_mm3;              ///< depth: NaN before the first touch
  bool touched{false};
  DurationCounts frame;  ///< times of computing one
};

}  // namespace osteon::app
