#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Spatial index over balls of any sizes, for a point's distance from their union and for the pair that
/// overlaps most.
///
///     octave of radius   [.25, .5) mm          [.5, 1) mm       [1, 2) mm …
///     tree of boxes          /\                    /\               /\          boxes hold centres; each
///     around centres        /\/\                  /\/\             /\/\         stores its largest radius
///     leaves             runs of 8 balls along a Morton curve
///
/// With one tree per octave, a box's distance less its largest radius bounds every ball in it within a factor
/// of two, however unlike the packing's balls are. Searches are branch and bound, so they are exact. Heavy
/// overlap costs only the few boxes that could hold a larger value than the largest so far.
class BallForest {
 public:
  /// Copies the balls. @pre centres are finite, radii finite and positive.
  explicit BallForest(std::span<const Ball> balls);

  /// Distance from p to the union of the balls, 0 inside; `at_most_m` where it is farther, or without balls.
  [[nodiscard]] double Gap(const Vector3& p_m,
                           double at_most_m = std::numeric_limits<double>::infinity()) const;

  /// Largest r + r' - |c - c'| over all pairs; 0 where none overlap.
  [[nodiscard]] double MaxOverlap(int threads) const;

  /// Smallest |c - c'| / max(r, r') between one of the balls and the others; infinite where there is no
  /// other.
  [[nodiscard]] double Separation(const Ball& one_of_them) const;

  /// Largest radius + signed distance of the centre; minus infinity without balls. Relies on exact signed
  /// distances inside the solid: a box deep inside holds no ball that protrudes.
  [[nodiscard]] double MaxProtrusion(const Solid& solid, int threads) const;

 private:
  struct Node {
    std::array<double, 3> low_m, high_m;  ///< box of the centres
    double radius_m;                      ///< the largest
    /// From p to the box; 0 inside it.
    [[nodiscard]] double SquaredDistance(const Vector3& p_m) const;
  };
  /// Level 0 has a node for each run of kLeaf balls; each further level has one for each run of kArity nodes
  /// of the level before.
  struct Tree {
    std::vector<Ball> balls;
    std::vector<std::vector<Node>> levels;
  };
  static constexpr std::size_t kLeaf = 8, kArity = 4;

  /// @param balls  of one octave of radius, sorted along a Morton curve
  static Tree MakeTree(std::vector<Ball> balls);
  /// Calls visit(ball, its index) for balls in nodes that may come nearer to p than limit(node), nearest
  /// first, and stops where visit returns true.
  template <typename Limit, typename Visit>
  static bool Search(const Tree& tree, const Vector3& p_m, const Limit& limit, const Visit& visit);

  std::vector<Tree> trees_;  ///< the octave of the largest balls first
};

}  // namespace osteon::simulation
