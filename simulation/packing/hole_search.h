#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulation/packing/clearance_climb.h"

namespace osteon::simulation {

/// Finds the holes of a packing: balls that fit at local maxima of the clearance (ClearanceClimb).
///
/// Use one object per thread. No ball may be inserted during a search.
class HoleSearch {
 public:
  HoleSearch(const Solid& solid, const DistanceGrid& depths, const BallGrid& balls, const RadiusCap& cap,
             std::uint64_t seed)
      : solid_(solid),
        depths_(depths),
        balls_(balls),
        cap_(cap),
        seed_(seed),
        climb_(solid, depths, balls, cap) {}

  /// Appends to `found` the holes beside a ball that have room for a radius of at least `min_m`.
  ///
  /// A new ball creates only local maxima that touch it, because the clearance elsewhere is unchanged. The
  /// holes beside each new ball and the holes that were left before are therefore all holes. The largest ball
  /// that touches the new ball in a given direction and overlaps no other has a radius in closed form. This
  /// radius is computed for a few hundred directions, turned at random; climbs start at its local maxima.
  /// @param max_m  upper limit of a hole's radius
  void AroundBall(std::size_t index, double min_m, double max_m, std::vector<Ball>& found);

  /// Returns the hole at which a climb from p ends. @param scale_m, min_m  see ClearanceClimb::Climb
  [[nodiscard]] Ball From(const Vector3& p_m, double scale_m, double min_m);

  /// Appends to `found` holes in a cube that have room for a radius of at least `min_m`. If none is found, no
  /// ball with kSure times this radius fits with its centre in the cube.
  void InCube(const Vector3& center_m, double side_m, double min_m, std::vector<Ball>& found);
  static constexpr double kSure = 1.02;

 private:
  static constexpr int kDirections = 160;
  using EachDirection = std::array<double, kDirections>;
  struct CubeSearch;

  /// Reduces radius_m_ so that a ball that touches `ball` does not overlap `other`.
  void BoundByBall(const Ball& ball, const Ball& other);
  /// Reduces radius_m_ so that a ball that touches `ball` stays nearly within the solid.
  void BoundBySurface(const Ball& ball, double max_m);
  /// Reduces radius_m_ to the cap, and sets capped_ for the directions in which this was necessary.
  /// @returns whether the cap limits the radius in any direction
  bool BoundByCap(const Ball& ball, double max_m);
  /// Searches a cube. If a hole can be neither found nor excluded, searches its eighths.
  void Divide(CubeSearch& search, const Vector3& center_m, double side_m, double depth_m, std::size_t first,
              std::size_t last, bool climbed);
  void AppendHole(const Ball& hole, double min_m, std::size_t first, std::vector<Ball>& found) const;

  const Solid& solid_;
  const DistanceGrid& depths_;
  const BallGrid& balls_;
  const RadiusCap& cap_;
  std::uint64_t seed_;
  ClearanceClimb climb_;
  EachDirection x_{}, y_{}, z_{};  ///< the directions
  EachDirection radius_m_{};       ///< radius of the largest ball that touches in each direction
  EachDirection capped_{};         ///< 1: the cap limits the radius in this direction
};

}  // namespace osteon::simulation
