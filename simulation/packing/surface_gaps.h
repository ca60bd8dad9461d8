#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/packing/tangent_balls.h"

namespace osteon::simulation {

/// Distance of many surface samples from a growing union of balls, and the choice of the next ball.
///
/// A binary tree over the samples, which must be sorted along a space-filling curve. Each node stores its
/// samples' box and largest gap. A new ball visits only nodes in which it can reduce a gap, in the end a few
/// leaves.
class SurfaceGaps {
 public:
  /// @param samples  must outlive this
  SurfaceGaps(std::span<const TangentBall> samples, double first_gap_m);

  /// Adds a ball to the union.
  void Add(const Ball& ball);
  /// Distance from sample i to the union; first_gap_m at the start.
  [[nodiscard]] float GapAt(std::size_t i) const { return gap_m_[i]; }

 private:
  struct Node {
    Eigen::AlignedBox3f box;  ///< relative to origin_m_
    float max_m{-1.0f};       ///< largest gap of its samples; negative without samples
  };
  /// Reduces the gaps below a node by a ball. @param center  of the ball, relative to origin_m_
  void Visit(std::size_t node, const Ball& ball, const Eigen::Vector3f& center);

  static constexpr std::size_t kLeafSamples = 8;
  std::span<const TangentBall> samples_;
  Vector3 origin_m_;
  std::size_t leaves_{1};
  std::vector<Node> nodes_;  ///< node 1 is the root, 2 i and 2 i + 1 are the children of i
  std::vector<float> gap_m_;
};

/// Adds tangent balls one by one, each at the sample whose gap is then largest relative to its tolerance, and
/// returns them in this order. The first n of them cover the surface nearly as well as n balls can.
///
/// The measure is gap / tolerance · √r: a ball closes a gap g over an area of about 2πgr, so of two equal
/// gaps the one with the larger ball comes first. Sharp edges, which balls cannot fill, then do not use up
/// all balls.
/// @param count  balls wanted; 0: until no gap is above its tolerance
[[nodiscard]] std::vector<Ball> CoverSurface(std::span<const TangentBall> samples, std::size_t count);

}  // namespace osteon::simulation
