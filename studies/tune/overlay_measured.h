#pragma once

#include <memory>
#include <string>
#include <vector>

#include "config/reading/identified_cell.h"
#include "studies/stability/measured_overlay.h"
#include "studies/tune/tune_measured.h"

// Judges the impedance law's gains by the responses of the arm that `osteon identify` measured.

namespace osteon::studies {

/// The measured response of the arm along one axis of the tool.
struct MeasuredAxis {
  std::string axis;
  std::shared_ptr<const MeasuredOverlay> overlay;
};

/// The measured axes of a cell, each at its slowest speed; empty if no response gives x / f.
/// @param loop  the cell's arm, for the directions that were not measured
[[nodiscard]] std::vector<MeasuredAxis> MeasuredAxesOf(const config::IdentifiedCell& identified,
                                                       const OverlayLoopParams& loop);

/// Whether the loop is stable by every measured axis; the wall of `loop` stands across that axis.
/// @param late_s  additional delay of each command beyond the measured one
[[nodiscard]] bool StandsMeasured(const std::vector<MeasuredAxis>& axes, const OverlayLoopParams& loop,
                                  double late_s);

/// A loop to be judged, and its contact.
struct OverlayCase {
  OverlayLoopParams loop;
  TuneContact contact{};
};
/// Computes one margin for each case and axis.
[[nodiscard]] std::vector<TuneMargin> MeasuredMargins(const std::vector<MeasuredAxis>& axes,
                                                      const std::string& gains,
                                                      const std::vector<OverlayCase>& cases, double late_s);

/// The Nyquist curve of the worst of these cases; empty without margins.
[[nodiscard]] std::vector<NyquistPoint> WorstCurve(const std::vector<MeasuredAxis>& axes,
                                                   const TuneMargin& worst,
                                                   const std::vector<OverlayCase>& cases, double late_s);

}  // namespace osteon::studies
