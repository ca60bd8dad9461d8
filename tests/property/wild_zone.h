#pragma once

#include <rapidcheck.h>

#include <array>
#include <ostream>

#include "safety/zone.h"
#include "tests/property/loop_oracle.h"

// Zones in the generator's hands: any shape, on either side, turned anyhow, with its surface some millimetres
// from where a point of the arm begins; and their geometry, known apart from safety::ZoneBounds.

namespace osteon::property {

/// One zone, each field a choice; 0 is the plainest.
struct ZoneChoice {
  int shape{0};      ///< safety::ZoneShape
  int side{0};       ///< safety::ZoneSide
  int point{0};      ///< safety::ZonePoint
  int size{0};       ///< 0 … 9: from 6 mm, each .5 times larger
  int offset_mm{0};  ///< of the surface beyond where the point begins, and half a millimetre more: negative,
                     ///< and it begins outside
  std::array<int, 3> toward{};  ///< -9 … 9: which way of the zone's frame its centre is
  std::array<int, 3> turn{};    ///< tenths of a radian about its axes
};
void showValue(const ZoneChoice& zone, std::ostream& out);
/// @param least_mm, most_mm  of offset_mm
[[nodiscard]] rc::Gen<ZoneChoice> AnyZone(int least_mm, int most_mm);

/// The zone of an arm that begins at these points.
[[nodiscard]] safety::ZoneParams ZoneOf(const ZoneChoice& choice, const ArmPoints& start);

/// That point of the arm.
[[nodiscard]] const Vector3& PointOf(const ArmPoints& points, safety::ZonePoint point);

/// How far p is past the zone's bound [m], negative where it keeps to it: by the face that it is past the
/// most.
[[nodiscard]] double PastBound_m(const safety::ZoneParams& zone, const Vector3& p);

}  // namespace osteon::property
