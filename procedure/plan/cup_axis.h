#pragma once

#include <cstdint>

#include "kinematics/spatial.h"

// Orientation of an acetabular cup by two angles, in the three definitions that clinical papers use.
//
// The cup axis a points out of the opening. Its components in the pelvic frame N = (lateral, anterior,
// superior) are a_N = (L, A, -I):
//
//   definition      inclination   anteversion   a_N
//   radiographic    atan2(L, I)   asin A        ( sin RI cos RA, sin RA,        -cos RI cos RA )
//   operative       asin L        atan2(A, I)   ( sin OI,        cos OI sin OA, -cos OI cos OA )
//   anatomic        acos I        atan2(A, L)   ( sin AI cos AA, sin AI sin AA, -cos AI )
//
// Source of the definitions: Murray, The definition and measurement of acetabular orientation, J. Bone Joint
// Surg. 75-B, 1993. The formulas for a_N follow from these definitions.

namespace osteon::procedure {

enum class CupDefinition : std::uint8_t { kRadiographic, kOperative, kAnatomic };

/// Returns "radiographic", "operative" or "anatomic".
[[nodiscard]] const char* NameOf(CupDefinition definition);

struct CupAngles {
  double inclination_rad{0.0}, anteversion_rad{0.0};
};

/// Returns the unit vector a_N for two angles.
[[nodiscard]] Vector3 CupAxis_N(CupDefinition definition, const CupAngles& angles);

/// The two angles of an axis; its length does not matter. Inverse of CupAxis_N for inclinations of 0 … 180°
/// (operative: -90 … 90°) and anteversions of -90 … 90° (operative and anatomic: -180 … 180°), except for
/// axes for which a definition has no anteversion: straight down (anatomic), straight lateral (operative).
[[nodiscard]] CupAngles AnglesOf(CupDefinition definition, const Vector3& a_N);

}  // namespace osteon::procedure
