#pragma once

#include "base/marker.h"
#include "safety/zone.h"

// The guard's own zone test. It shares only the description of a zone (ZoneParams) with safety/zone.h.

namespace osteon::safety {

/// Distance by which a point keeps a zone's bound [m]; negative if the point is past the bound. Based on the
/// signed distance to the set's surface, negative within the set, with the sign turned for a set to keep in.
///
///     half-space   -n·(p - c)                      n points into it
///     sphere       |p - c| - r
///     capsule      distance to the segment c ± h n, less r
///     box          |max(g, 0)| + min(max g_i, 0)   g_i = |e_i·(p - c)| - half_edge_i
///     cylinder     the same with the two gaps to its side and to its ends
///
/// Beyond an edge the distance is Euclidean. NaN for a point that is not finite.
[[nodiscard]] double GuardZoneMargin_m(const ZoneParams& zone, const Vector3& p_WP) OSTEON_RT;

/// @throws std::invalid_argument "guard: zone: …", naming what was found and what is accepted.
void RequireGuardZone(const ZoneParams& zone);

}  // namespace osteon::safety
