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
/// A cup has a coronal and an axial slice, and a map of the planned hemisphere, seen from its opening: how
/// much deeper (orange) or shallower (blue) than planned the bone begins. The map shows equal areas equally
/// large, with the pole in the middle and superior up. An opening has two slices along its axis and one
/// across it.
[[nodiscard]] std::vector<CavityPicture> CavityPictures(const AssessedSession& session);

/// The deviation from the plan that gets the full colour [mm].
[[nodiscard]] double DeviationScale_mm(procedure::PlanKind kind);

}  // namespace osteon::studies
