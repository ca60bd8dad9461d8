#pragma once

#include <rapidcheck.h>

#include <array>
#include <ostream>

#include "safety/zone.h"
#include "tests/property/loop_oracle.h"

// Generates zones of any shape, side and orientation. A zone's surface is some millimetres from the start of
// a point of the arm. The zones' geometry is computed here too, independently of safety::ZoneBounds.

namespace osteon::property {

/// Integers from which ZoneOf makes one zone. 0 is the simplest value of each.
struct ZoneChoice {
  int shape{0};  ///< safety::ZoneShape
  int side{0};   ///< safety::ZoneSide
  int point{0};  ///< safety::ZonePoint
  int size{0};   ///< 0 … 9: the size is 6 mm × 1.5^size
  /// The point starts offset_mm + 0.5 mm from the surface, on the permitted side; negative: on the forbidden
  /// side.
  int offset_mm{0};
  /// -9 … 9: direction from the zone's centre to the point, in the zone's frame; not used for a half-space.
  std::array<int, 3> toward{};
  std::array<int, 3> turn{};  ///< tenths of a radian about the fixed axes x, y, z, in this order
};
void showValue(const ZoneChoice& zone, std::ostream& out);
/// @param least_mm, most_mm  smallest and largest offset_mm
[[nodiscard]] rc::Gen<ZoneChoice> AnyZone(int least_mm, int most_mm);

/// Makes the zone for an arm whose points are at `start` when it begins.
[[nodiscard]] safety::ZoneParams ZoneOf(const ZoneChoice& choice, const ArmPoints& start);

/// Selects the arm's point that a zone bounds.
[[nodiscard]] const Vector3& PointOf(const ArmPoints& points, safety::ZonePoint point);

/// Distance of p beyond the zone's bound [m]; negative on the permitted side. The signed distance from a box
/// or cylinder is the largest of those from its faces.
[[nodiscard]] double PastBound_m(const safety::ZoneParams& zone, const Vector3& p);

}  // namespace osteon::property
