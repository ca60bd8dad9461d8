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
/// planned cavity's outline. Of a cup coronal and axial, and how much deeper (orange) or shallower (blue)
/// than planned the bone begins, over the planned hemisphere, seen from its opening: the pole in the middle,
/// equal areas, superior up. Of an opening two along its axis and one across it.
[[nodiscard]] std::vector<CavityPicture> CavityPictures(const AssessedSession& session);

/// The deviation at the ends of the colours [mm].
[[nodiscard]] double DeviationScale_mm(procedure::PlanKind kind);

}  // namespace osteon::studies
