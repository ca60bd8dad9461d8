#pragma once

#include "base/marker.h"
#include "safety/zone.h"

// The guard's own zone test. It shares no code with safety/zone.h except the description of a zone
// (ZoneParams).

namespace osteon::safety {

/// Distance [m] of a point p from a zone's bound, on the allowed side; negative if the point violates the
/// zone. For a zone to keep out of, it is the signed distance to the set's surface, which is negative inside
/// the set:
///
///     half-space   -n·(p - c)                      n: unit normal into the set
///     sphere       |p - c| - r
///     capsule      distance to the segment c ± h n, less r
///     box          |max(g, 0)| + min(max g_i, 0)   g_i = |e_i·(p - c)| - half_edge_i
///     cylinder     as for the box, with the gap to the side and the gap to the ends
///
/// c is the centre, or a point of the half-space's face. For a zone to keep in, the sign is reversed. Outside
/// an edge the distance is Euclidean. NaN for a point that is not finite.
[[nodiscard]] double GuardZoneMargin_m(const ZoneParams& zone, const Vector3& p_WP) OSTEON_RT;

/// Checks a zone's parameters. @throws std::invalid_argument "guard: zone: …", naming what was found and what
/// is accepted.
void RequireGuardZone(const ZoneParams& zone);

}  // namespace osteon::safety
