#pragma once

#include "control/rt/marker.h"
#include "safety/zone.h"

// The guard's own test of a zone. Of safety/zone.h it takes what a zone is (ZoneParams), and calls nothing.

namespace osteon::safety {

/// How far inside of a zone's bound a point is [m]: negative where it is past it, and then by how far. A
/// signed distance function: to a set's surface, negative within the set; its sign turned where the set is
/// kept in.
///
///     half-space   -n·(p - c)                      n points into it
///     sphere       |p - c| - r
///     capsule      distance to the segment c ± h n, less r
///     box          |max(g, 0)| + min(max g_i, 0)   g_i = |e_i·(p - c)| - half_edge_i
///     cylinder     the same of the two gaps to its side and to its ends
///
/// Beyond an edge it is Euclid's distance. NaN for a point that is not finite.
[[nodiscard]] double GuardZoneMargin_m(const ZoneParams& zone, const Vector3& p_WP) OSTEON_RT;

/// @throws std::invalid_argument "guard: zone: …", naming what was found and what is accepted.
void RequireGuardZone(const ZoneParams& zone);

}  // namespace osteon::safety
