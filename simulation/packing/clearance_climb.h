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

/// Cap: largest allowed radius of a ball, which depends on its centre: r0 + a·d, d being the centre's depth
/// below the cut zone.
struct RadiusCap {
  const CutZone& zone;
  double radius_m{0.0};
  double grade{0.0};

  [[nodiscard]] double At(const Vector3& p_m) const {
    return grade > 0.0 ? radius_m + grade * std::max(0.0, zone.DepthAt(p_m)) : radius_m;
  }
};

/// Climbs to local maxima of the clearance. The clearance of a point is its distance to the surface or to the
/// nearest ball, whichever is smaller.
///
/// Use one object per thread. It keeps the balls of a neighbourhood in a cache between climbs, so no ball may
/// be inserted meanwhile.
class ClearanceClimb {
 public:
  ClearanceClimb(const Solid& solid, const DistanceGrid& depths, const BallGrid& balls, const RadiusCap& cap)
      : solid_(solid), depths_(depths), balls_(balls), cap_(cap) {}

  /// Fills the cache with the balls whose surfaces come nearer than `reach_m` to p, and removes all others.
  void CacheNeighbours(const Vector3& p_m, double reach_m);
  /// The balls that the last CacheNeighbours cached.
  [[nodiscard]] std::span<const Ball> cached() const { return cached_; }

  /// Returns the largest ball around the local maximum at which a climb from p ends. If the clearance reaches
  /// the cap, the climb ends early with a ball of the cap's radius. This ball then settles: it moves until it
  /// touches its three nearest obstacles.
  ///
  /// The ball overlaps no other ball except by rounding. A climb that cannot reach a radius of `min_m` may be
  /// abandoned; the returned radius is then smaller than `min_m`.
  /// @param scale_m  about the expected radius; it determines the length of the first steps
  [[nodiscard]] Ball Climb(const Vector3& p_m, double scale_m, double min_m);

 private:
  struct Plane {
    Vector3 normal;  ///< into the solid
    Vector3 at_m;
  };
  /// Returns the clearance at p, and stores in bounds_ the obstacles that are at most `window_m` farther
  /// away.
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
  std::vector<double> gaps_m_;  ///< distances to the cached balls' surfaces at the point of the last Measure
  std::vector<Plane> planes_;   ///< tangent planes of the surface that were found so far
  std::vector<ClearanceBound> bounds_, last_bounds_;
};

}  // namespace osteon::simulation
