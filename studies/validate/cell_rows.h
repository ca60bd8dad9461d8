#pragma once

#include <string>
#include <vector>

#include "studies/validate/validation_rows.h"

// Rows of `osteon validate` that a shipped cell simulates in virtual time: arm, hand, servo loop and cutting
// engine. For each row, a second function whose name ends in Cells returns the cells that the row runs, so
// that they can run at the same time.

namespace osteon::studies {

/// The motion of the hand while it reams.
enum class Technique : std::uint8_t {
  kWhirlwind,  ///< the hand presses while the tilted tool swings around the axis about the head's centre
  kStraight,   ///< the hand presses along the axis: tilt of 0
};

/// Difference [mm] between the diameters of cavity and reamer, mean over both densities of foam.
[[nodiscard]] Simulated DiameterError(ValidationLab& lab, Technique technique);
[[nodiscard]] std::vector<CellTrialParams> DiameterErrorCells(Technique technique, bool quick);

/// Diameter of the cavity of a 61 mm reamer [mm]. @param foam  "foam_10" or "foam_20"
[[nodiscard]] Simulated WideCavity(ValidationLab& lab, const std::string& foam);
[[nodiscard]] std::vector<CellTrialParams> WideCavityCells(const std::string& foam, bool quick);

// Rows that are simulated by the demo's own run in bone. DemoCells returns the cells that these rows run.
[[nodiscard]] std::vector<CellTrialParams> DemoCells(bool quick);
[[nodiscard]] Simulated CentreShift(ValidationLab& lab);    ///< [mm]
[[nodiscard]] Simulated RemovedVolume(ValidationLab& lab);  ///< [mm³]
[[nodiscard]] std::vector<CellTrialParams> FeedPerTurnCells(bool quick);
[[nodiscard]] Simulated FeedPerTurn(ValidationLab& lab);      ///< [µm]
[[nodiscard]] Simulated ForceDifference(ValidationLab& lab);  ///< [%]
[[nodiscard]] Simulated ReamingForce(ValidationLab& lab);     ///< [N]

/// Peak force [N] of the hand on the plate's drill, and on the molar's bur.
[[nodiscard]] Simulated DrillingForce(ValidationLab& lab);
[[nodiscard]] std::vector<CellTrialParams> DrillingForceCells(bool quick);
[[nodiscard]] Simulated BurForce(ValidationLab& lab);
[[nodiscard]] std::vector<CellTrialParams> BurForceCells(bool quick);

/// Largest difference [%] between the drag felt at the demo's handle and the requested drag.
[[nodiscard]] Simulated DragDifference(ValidationLab& lab);

}  // namespace osteon::studies
