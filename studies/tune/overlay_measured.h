#pragma once

#include <memory>
#include <string>
#include <vector>

#include "config/reading/identified_cell.h"
#include "studies/stability/measured_overlay.h"
#include "studies/tune/tune_measured.h"

// Judges the gains of the impedance law by the arm's response, as `osteon identify` measured it.

namespace osteon::studies {

/// The measured response of the arm along one axis of the tool.
struct MeasuredAxis {
  std::string axis;
  std::shared_ptr<const MeasuredOverlay> overlay;
};

/// The measured axes of a cell, each at its slowest speed; empty if no response gives x / f (motion over
/// force).
/// @param loop  the cell's loop; its simulated arm describes the axes that were not measured
[[nodiscard]] std::vector<MeasuredAxis> MeasuredAxesOf(const config::IdentifiedCell& identified,
                                                       const OverlayLoopParams& loop);

/// Whether the loop is stable with the response of every measured axis. The wall of `loop` is perpendicular
/// to that axis.
/// @param late_s  additional delay of each command beyond the measured delay
[[nodiscard]] bool IsStableAsMeasured(const std::vector<MeasuredAxis>& axes, const OverlayLoopParams& loop,
                                      double late_s);

/// A loop to be judged, and the name of its contact.
struct OverlayCase {
  OverlayLoopParams loop;
  TuneContact contact{};
};
/// Computes one margin for each case and axis.
[[nodiscard]] std::vector<TuneMargin> MeasuredMargins(const std::vector<MeasuredAxis>& axes,
                                                      const std::string& gains,
                                                      const std::vector<OverlayCase>& cases, double late_s);

/// The Nyquist curve of the case to which the worst margin belongs; empty without margins.
[[nodiscard]] std::vector<NyquistPoint> WorstCurve(const std::vector<MeasuredAxis>& axes,
                                                   const TuneMargin& worst,
                                                   const std::vector<OverlayCase>& cases, double late_s);

}  // namespace osteon::studies
