#pragma once

#include <limits>
#include <string>

#include "app/report/run_curves.h"
#include "app/report/time_axis.h"

// The plots of a run, as SVG. Time counts from the first tick (or frame, where there is none) where no axis is
// given.

namespace osteon::app {

/// From the first tick on, or the first frame where there is none.
[[nodiscard]] inline TimeAxis FromFirst(const RunCurves& run) { return {.zero = run.Start()}; }

/// Sizes of the rendered coupling force and of the hand's force, and the coupling force along the tool, with
/// the limit.
[[nodiscard]] std::string ForceChart(const RunCurves& run, double force_limit_N, const TimeAxis& time);
[[nodiscard]] inline std::string ForceChart(const RunCurves& run, double force_limit_N) {
  return ForceChart(run, force_limit_N, FromFirst(run));
}

/// Deepest apex and removed volume, one above the other.
[[nodiscard]] std::string ProgressChart(const RunCurves& run);

/// Tool speed, how far the tool is beyond its collision-free pose, and the contact model's age, one above the
/// other; no limit line where the speed's limit is 0, or the other infinite.
[[nodiscard]] std::string MotionChart(const RunCurves& run, double speed_limit_m_per_s,
                                      double max_tool_in_bone_m, const TimeAxis& time);
[[nodiscard]] inline std::string MotionChart(
    const RunCurves& run, double speed_limit_m_per_s,
    double max_tool_in_bone_m = std::numeric_limits<double>::infinity()) {
  return MotionChart(run, speed_limit_m_per_s, max_tool_in_bone_m, FromFirst(run));
}

/// Histograms; empty text where nothing was measured (virtual time).
[[nodiscard]] std::string WakeupHistogram(const RunCurves& run);
[[nodiscard]] std::string ComputeHistogram(const RunCurves& run);
[[nodiscard]] std::string FrameTimeHistogram(const RunCurves& run);

}  // namespace osteon::app
