#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulation/packing/clearance_climb.h"

namespace osteon::simulation {

/// Finds the holes of a packing: local maxima of the clearance, as the balls that would fill them.
///
/// One object a thread; nothing may be inserted into the balls while it works.
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

  /// Appends the holes beside a ball that can take `least` or more.
  ///
  /// A ball that is added makes no local maximum but such as touch it: elsewhere the clearance is what it
  /// was. So what this finds for each new ball, with the holes that are left, is all there is. The radius of
  /// the largest ball that touches this one in a given direction and nothing else has a closed form; its
  /// local maxima over a few hundred directions, turned at random, are where climbs begin.
  /// @param most_m  no hole takes more
  void AroundBall(std::size_t index, double least_m, double most_m, std::vector<Ball>& found);

  /// Climbs from p.
  [[nodiscard]] Ball From(const Vector3& p_m, double scale_m, double least_m);

  /// Appends holes in a cube that can take `least` or more. Where it finds none, no ball of kSure times that
  /// radius fits with its centre in the cube.
  void InCube(const Vector3& center_m, double side_m, double least_m, std::vector<Ball>& found);
  static constexpr double kSure = 1.02;

 private:
  static constexpr int kDirections = 160;
  using EachDirection = std::array<double, kDirections>;
  struct Fan;
  struct CubeSearch;

  void BoundByBall(const Ball& ball, const Ball& other);
  void BoundBySurface(const Ball& ball, double most_m);
  /// @returns whether the cap is the bound anywhere
  bool BoundByCap(const Ball& ball, double most_m);
  void Divide(CubeSearch& search, const Vector3& center_m, double side_m, double depth_m, std::size_t first,
              std::size_t last, bool climbed);
  void Report(const Ball& hole, double least_m, std::size_t first, std::vector<Ball>& found) const;

  const Solid& solid_;
  const DistanceGrid& depths_;
  const BallGrid& balls_;
  const RadiusCap& cap_;
  std::uint64_t seed_;
  ClearanceClimb climb_;
  EachDirection x_{}, y_{}, z_{};  ///< the directions
  EachDirection radius_m_{};       ///< of the largest ball that touches in the direction
  EachDirection capped_{};         ///< 1 where that is the cap's
};

}  // namespace osteon::simulation
