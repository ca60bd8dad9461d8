#pragma once

#include <string>
#include <vector>

#include "procedure/plan/surgical_plan.h"
#include "report/png_file.h"
#include "studies/assess/session_reading.h"

namespace osteon::studies {

/// A picture of the result, with its caption.
struct CavityPicture {
  std::string caption;
  report::Image image;
};

/// Slices through the planned centre: bone left, bone removed as planned, over-reamed, under-reamed, and the
/// planned cavity's outline.
///
/// A cup has a coronal and an axial slice, and a map of the planned hemisphere, seen from its opening. The
/// map shows how much deeper (orange) or shallower (blue) than planned the remaining bone begins. It is an
/// equal-area map with the pole in the middle; superior is up. An opening has two slices along its axis and
/// one across the axis.
[[nodiscard]] std::vector<CavityPicture> CavityPictures(const AssessedSession& session);

/// Deviation from the plan [mm] at which the map's colour is fully saturated.
[[nodiscard]] double DeviationScale_mm(procedure::PlanKind kind);

}  // namespace osteon::studies
