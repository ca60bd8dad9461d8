#pragma once

#include <array>
#include <span>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/methods/live_tree.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Converts mass points to balls of radius 0, for a LiveTree.
[[nodiscard]] std::vector<Ball> AsBalls(std::span<const MassPoint> points);
/// Material of the mass point nearest to p; 0 if there is none within a metre.
/// @param tree  over these points
[[nodiscard]] MaterialIndex NearestMaterial(std::span<const MassPoint> points, const LiveTree& tree,
                                            const Vector3& p_m);

/// The bone for the methods with balls, in G: balls that shrink, mass points that are cleared, and a search
/// tree for each.
class BallBone {
 public:
  /// @param solid  gives the density of each ball; null: each ball has the density of the nearest mass point
  BallBone(const Bone& bone, const Solid* solid);

  /// The present state of a ball; radius 0: the ball is gone.
  struct LiveBall {
    Vector3 center_m;
    double radius_m;
    double density_kg_per_m3;
  };

  [[nodiscard]] const std::vector<LiveBall>& balls() const { return balls_; }
  /// The remaining balls.
  [[nodiscard]] std::vector<Ball> Left() const;

  /// Calls visit(index, ball) for each remaining ball that may come nearer than `reach_m` to the segment from
  /// a to b.
  template <typename Visit>
  void ForEachBallNear(const Vector3& a, const Vector3& b, double reach_m, const Visit& visit) const {
    ball_tree_.ForEachNear(0.5 * (a + b), reach_m + 0.5 * (b - a).norm(), 0.0,
                           [&](std::uint32_t i) { visit(i, balls_[i]); });
  }

  /// Calls visit(point) for each remaining mass point with a distance from p between inner_m and outer_m, and
  /// for some other points.
  template <typename Visit>
  void ForEachPointInShell(const Vector3& p_m, double inner_m, double outer_m, const Visit& visit) const {
    point_tree_.ForEachNear(p_m, outer_m, inner_m, [&](std::uint32_t i) { visit(points_[i]); });
  }

  /// Sets a ball's centre and radius. Radius 0 removes the ball.
  void Replace(std::uint32_t index, const Vector3& center_m, double radius_m);
  /// Removes a capsule from the bone: shrinks all balls that it touches by the corrected equation 5
  /// (ShrinkBall), and clears the mass points in it.
  void Cut(const Vector3& a, const Vector3& b, double radius_m,
           std::array<double, kMaxMaterials>& removed_m3);
  /// Clears the mass points in a capsule, and adds their volumes to removed_m3.
  void ClearPoints(const Vector3& a, const Vector3& b, double radius_m,
                   std::array<double, kMaxMaterials>& removed_m3);

  /// Writes balls and cleared points into a state; Load reads them back.
  void Save(CarvedState& state) const;
  /// @throws std::invalid_argument if the state belongs to another bone.
  void Load(const CarvedState& state);

 private:
  std::vector<LiveBall> balls_;
  std::vector<MassPoint> points_;
  std::vector<std::uint8_t> cleared_;
  LiveTree ball_tree_, point_tree_;
};

}  // namespace osteon::simulation
