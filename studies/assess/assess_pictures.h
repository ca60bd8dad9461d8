#pragma once

#include "procedure/plan/pelvic_frame.h"
#include "report/png_file.h"
#include "studies/assess/session_reading.h"

namespace osteon::studies {

/// Slice of the bone through the planned centre, spanned by two directions in G: bone left, bone removed as
/// planned, over-reamed, under-reamed, and the planned cavity's outline.
[[nodiscard]] report::Image SliceImage(const AssessedSession& session, const Vector3& right,
                                       const Vector3& up);

/// How much deeper (red) or shallower (blue) than planned the bone begins, over the planned hemisphere, seen
/// from its opening: the pole in the middle, equal areas; superior is up.
[[nodiscard]] report::Image DeviationImage(const AssessedSession& session);

/// The deviation at the ends of its colours [mm].
inline constexpr double kDeviationScale_mm = 2.0;

}  // namespace osteon::studies
