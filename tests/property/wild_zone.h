#pragma once

#include <rapidcheck.h>

#include <array>
#include <ostream>

#include "safety/zone.h"
#include "tests/property/loop_oracle.h"

// Generated zones: any shape, on either side, in any orientation, with the surface some millimetres from the
// start of a point of the arm; and their geometry, computed independently of safety::ZoneBounds.

namespace osteon::property {

/// One zone, each field a choice; 0 is the simplest.
struct ZoneChoice {
  int shape{0};      ///< safety::ZoneShape
  int side{0};       ///< safety::ZoneSide
  int point{0};      ///< safety::ZonePoint
  int size{0};       ///< 0 … 9: from 6 mm, each 1.5 times the one before
  int offset_mm{0};  ///< of the surface beyond where the point begins, and half a millimetre more: negative,
                     ///< and it begins outside
  std::array<int, 3> toward{};  ///< -9 … 9: direction of its centre, in the zone's frame
  std::array<int, 3> turn{};    ///< tenths of a radian about its axes
};
void showValue(const ZoneChoice& zone, std::ostream& out);
/// @param least_mm, most_mm  of offset_mm
[[nodiscard]] rc::Gen<ZoneChoice> AnyZone(int least_mm, int most_mm);

/// Makes the zone for an arm that begins with these points.
[[nodiscard]] safety::ZoneParams ZoneOf(const ZoneChoice& choice, const ArmPoints& start);

/// Selects that point of the arm.
[[nodiscard]] const Vector3& PointOf(const ArmPoints& points, safety::ZonePoint point);

/// Distance of p beyond the zone's bound [m], negative within it: by the face that p is farthest beyond.
[[nodiscard]] double PastBound_m(const safety::ZoneParams& zone, const Vector3& p);

}  // namespace osteon::property
