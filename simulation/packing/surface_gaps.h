#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/packing/tangent_balls.h"

namespace osteon::simulation {

/// The gaps of many surface samples: their distances from a union of balls that grows ball by ball.
///
/// A binary tree over the samples, which must be sorted along a space-filling curve. Each node stores its
/// samples' box and largest gap. A new ball is compared only with nodes in which it can reduce a gap, so it
/// reaches only a few leaves.
class SurfaceGaps {
 public:
  /// @param samples  must outlive this
  SurfaceGaps(std::span<const TangentBall> samples, double first_gap_m);

  /// Adds a ball to the union.
  void Add(const Ball& ball);
  /// Distance from sample i to the union; first_gap_m as long as there is no ball.
  [[nodiscard]] float GapAt(std::size_t i) const { return gap_m_[i]; }

 private:
  struct Node {
    Eigen::AlignedBox3f box;  ///< relative to origin_m_
    float max_m{-1.0f};       ///< largest gap of the node's samples; negative without samples
  };
  /// Reduces the gaps of the samples below a node to their distances from a ball, if these are smaller.
  /// @param center  centre of the ball, relative to origin_m_
  void Visit(std::size_t node, const Ball& ball, const Eigen::Vector3f& center);

  static constexpr std::size_t kLeafSamples = 8;
  std::span<const TangentBall> samples_;
  Vector3 origin_m_;
  std::size_t leaves_{1};
  std::vector<Node> nodes_;  ///< node 1 is the root, 2 i and 2 i + 1 are the children of i
  std::vector<float> gap_m_;
};

/// Chooses tangent balls one by one, each at the sample whose measure is largest at that time, and returns
/// them in this order. The first n balls cover the surface nearly as well as any n balls can.
///
/// The measure is gap / tolerance · √r, r being the radius of the sample's ball. A ball closes a gap g over
/// an area of about 2πgr, so of two equal gaps, the one with the larger ball comes first. Otherwise sharp
/// edges, which balls cannot fill, would use up all balls.
/// @param count  number of wanted balls; 0: until no gap is above its tolerance
[[nodiscard]] std::vector<Ball> CoverSurface(std::span<const TangentBall> samples, std::size_t count);

}  // namespace osteon::simulation
