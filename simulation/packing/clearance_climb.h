#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "simulation/packing/ball_grid.h"
#include "simulation/packing/ridge_walk.h"
#include "simulation/solids/cut_zone.h"
#include "simulation/solids/distance_grid.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Largest allowed radius of a ball by the place of its centre: r0 + a·d, d the depth below the cut zone.
struct RadiusCap {
  const CutZone& zone;
  double radius_m{0.0};
  double grade{0.0};

  [[nodiscard]] double At(const Vector3& p_m) const {
    return grade > 0.0 ? radius_m + grade * std::max(0.0, zone.DepthAt(p_m)) : radius_m;
  }
};

/// Climbs to local maxima of the clearance: the distance to the surface or to the nearest ball, whichever is
/// less.
///
/// Use one object per thread. It caches a neighbourhood's balls between climbs, so nothing may be inserted
/// into the balls meanwhile.
class ClearanceClimb {
 public:
  ClearanceClimb(const Solid& solid, const DistanceGrid& depths, const BallGrid& balls, const RadiusCap& cap)
      : solid_(solid), depths_(depths), balls_(balls), cap_(cap) {}

  /// Caches the balls whose surfaces come nearer than `reach_m` to p, and forgets all others.
  void CacheNeighbours(const Vector3& p_m, double reach_m);
  /// The balls that the last CacheNeighbours cached.
  [[nodiscard]] std::span<const Ball> cached() const { return cached_; }

  /// Returns the largest ball around the local maximum at which a climb from p ends. Where the clearance
  /// exceeds the cap, the climb ends as soon as the ball has room, and the ball settles: it comes to rest
  /// against its three nearest neighbours.
  ///
  /// The ball overlaps nothing by more than rounding. A climb that cannot reach `min_m` may be abandoned; the
  /// result's radius is then smaller.
  /// @param scale_m  about the expected radius: the first steps' length
  [[nodiscard]] Ball Climb(const Vector3& p_m, double scale_m, double min_m);

 private:
  struct Plane {
    Vector3 normal;  ///< into the solid
    Vector3 at_m;
  };
  /// The clearance at p; stores the obstacles at most `window_m` farther in bounds_.
  double Measure(const Vector3& p_m, double window_m);
  /// Adds the planes_ nearer to p than `within_m` to bounds_.
  void AddPlanes(const Vector3& p_m, double clearance_m, double within_m);
  /// Moves a ball of the cap's radius until it touches its three nearest obstacles.
  [[nodiscard]] Ball Settle(const Vector3& p_m, double clearance_m);

  const Solid& solid_;
  const DistanceGrid& depths_;
  const BallGrid& balls_;
  const RadiusCap& cap_;

  Vector3 cached_from_m_{Vector3::Zero()};
  double cached_reach_m_{0.0};
  std::vector<Ball> cached_;
  std::vector<double> gaps_m_;  ///< to the cached balls, at the place of the last Measure
  std::vector<Plane> planes_;   ///< tangent planes of the surface that were met so far
  std::vector<ClearanceBound> bounds_, last_bounds_;
};

}  // namespace osteon::simulation
