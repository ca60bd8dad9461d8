#pragma once

#include <limits>
#include <span>
#include <string>

#include "app/report/time_axis.h"
#include "control/tick_record.h"
#include "kinematics/spatial.h"
#include "simulation/frame_record.h"

// The plots of a run's records, as SVG. Time counts from the first tick (or frame, where there is none) where
// no axis is given.

namespace osteon::app {

/// Sizes of the rendered coupling force and of the hand's force, and the coupling force along the tool, with
/// the limit.
[[nodiscard]] std::string ForceChart(std::span<const control::TickRecord> ticks, double force_limit_N,
                                     const TimeAxis& time);
[[nodiscard]] inline std::string ForceChart(std::span<const control::TickRecord> ticks,
                                            double force_limit_N) {
  return ForceChart(ticks, force_limit_N, FromFirst(ticks));
}

/// Deepest apex and removed volume, one above the other.
[[nodiscard]] std::string ProgressChart(std::span<const control::TickRecord> ticks,
                                        std::span<const simulation::FrameRecord> frames);

/// Tool speed, the tool's distance from its collision-free pose, and the contact model's age, one above the
/// other; no limit line where the speed's limit is 0 or the distance's infinite.
[[nodiscard]] std::string MotionChart(std::span<const control::TickRecord> ticks, double speed_limit_m_per_s,
                                      double max_tool_in_bone_m, const TimeAxis& time);
[[nodiscard]] inline std::string MotionChart(
    std::span<const control::TickRecord> ticks, double speed_limit_m_per_s,
    double max_tool_in_bone_m = std::numeric_limits<double>::infinity()) {
  return MotionChart(ticks, speed_limit_m_per_s, max_tool_in_bone_m, FromFirst(ticks));
}

/// Histograms; empty text where nothing was measured (virtual time).
[[nodiscard]] std::string WakeupHistogram(std::span<const control::TickRecord> ticks);
[[nodiscard]] std::string ComputeHistogram(std::span<const control::TickRecord> ticks);
[[nodiscard]] std::string FrameTimeHistogram(std::span<const simulation::FrameRecord> frames);

}  // namespace osteon::app
