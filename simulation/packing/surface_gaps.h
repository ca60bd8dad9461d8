#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/packing/tangent_balls.h"

namespace osteon::simulation {

/// How far each of many surface samples is from a union of balls that grows, and which ball to add next.
///
/// A binary tree over the samples, which must be sorted along a space-filling curve. Each node knows its
/// samples' box and greatest gap: a new ball visits only where it can make a gap smaller, in the end a few
/// leaves.
class SurfaceGaps {
 public:
  /// @param samples  must outlive this
  SurfaceGaps(std::span<const TangentBall> samples, double first_gap_m);

  /// The ball is part of the union from now on.
  void Add(const Ball& ball);
  /// Distance from sample i to the union; first_gap_m at first.
  [[nodiscard]] float GapAt(std::size_t i) const { return gap_m_[i]; }

 private:
  struct Node {
    Eigen::AlignedBox3f box;  ///< from origin_m_
    float greatest_m{-1.0f};
  };
  void Visit(std::size_t node, const Ball& ball, const Eigen::Vector3f& center);

  static constexpr std::size_t kLeafSamples = 8;
  std::span<const TangentBall> samples_;
  Vector3 origin_m_;
  std::size_t leaves_{1};
  std::vector<Node> nodes_;  ///< node 1 is the root, 2 i and 2 i + 1 are the children of i
  std::vector<float> gap_m_;
};

/// Adds tangent balls one by one, each where the gap now is largest for its tolerance, and returns them in
/// this order: any first part of it is nearly as good a cover as so many balls can be.
///
/// The measure is gap / tolerance · √r: a ball closes a gap g over an area of about 2πgr, so that of two
/// equal gaps the one with the larger ball comes first. A sharp edge, which balls cannot fill, then does not
/// use them up.
/// @param count  balls wanted; 0: until no gap is above its tolerance
[[nodiscard]] std::vector<Ball> CoverSurface(std::span<const TangentBall> samples, std::size_t count);

}  // namespace osteon::simulation
