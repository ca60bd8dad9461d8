#pragma once

#include <limits>
#include <string>

#include "report/run_curves.h"
#include "report/time_axis.h"

// The plots of a run, as SVG. Functions without a TimeAxis use FromFirst.

namespace osteon::report {

/// A time axis from the first tick on, or from the first frame if there is no tick.
[[nodiscard]] inline TimeAxis FromFirst(const RunCurves& run) { return {.zero = run.Start()}; }

/// Plots the magnitudes of the rendered coupling force and of the hand's force, the component of the coupling
/// force along the tool's axis, and the force limit.
[[nodiscard]] std::string ForceChart(const RunCurves& run, double force_limit_N, const TimeAxis& time);
[[nodiscard]] inline std::string ForceChart(const RunCurves& run, double force_limit_N) {
  return ForceChart(run, force_limit_N, FromFirst(run));
}

/// Plots the depth of the apex and the removed volume, one above the other.
[[nodiscard]] std::string ProgressChart(const RunCurves& run);

/// Plots tool speed, the tool's distance beyond its collision-free pose, and the contact model's age, one
/// above the other; A plot has no limit line if the speed limit is 0, or if the limit of the distance is
/// infinite.
[[nodiscard]] std::string MotionChart(const RunCurves& run, double speed_limit_m_per_s,
                                      double max_tool_in_bone_m, const TimeAxis& time);
[[nodiscard]] inline std::string MotionChart(
    const RunCurves& run, double speed_limit_m_per_s,
    double max_tool_in_bone_m = std::numeric_limits<double>::infinity()) {
  return MotionChart(run, speed_limit_m_per_s, max_tool_in_bone_m, FromFirst(run));
}

/// Plots the bending of the tool, the compression of the tissue layer and the displacement of the bone on its
/// mount, one above the other. A part that never moved has no plot. Returns an empty text if nothing moved.
[[nodiscard]] std::string ComplianceChart(const RunCurves& run);

/// Plots histograms; returns an empty text if nothing was measured (virtual time).
[[nodiscard]] std::string WakeupHistogram(const RunCurves& run);
[[nodiscard]] std::string ComputeHistogram(const RunCurves& run);
[[nodiscard]] std::string FrameTimeHistogram(const RunCurves& run);

}  // namespace osteon::report
