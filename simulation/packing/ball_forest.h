#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Spatial index over balls of very different radii. It finds the distance of a point from their union, and
/// the largest overlap of two balls.
///
///     octave of radius   [.25, .5) mm          [.5, 1) mm       [1, 2) mm …
///     tree of boxes          /\                    /\               /\          boxes hold centres; each
///     around centres        /\/\                  /\/\             /\/\         stores its largest radius
///     leaves             runs of 8 balls along a Morton curve
///
/// The distance from a point to a box, less the box's largest radius, is a lower bound of the distance to
/// every ball in the box. With one tree per octave, the radii in a box differ by a factor of at most two, so
/// the bound is close for any packing. Searches are branch and bound, so results are exact. Even if balls
/// overlap heavily, a search visits only the few boxes that can still improve the result.
class BallForest {
 public:
  /// Copies the balls. @pre centres are finite, radii finite and positive.
  explicit BallForest(std::span<const Ball> balls);

  /// Distance from p to the union of the balls, 0 inside; `at_most_m` if the union is farther away or there
  /// are no balls.
  [[nodiscard]] double Gap(const Vector3& p_m,
                           double at_most_m = std::numeric_limits<double>::infinity()) const;

  /// Largest overlap r + r' - |c - c'| over all pairs of balls with radii r, r' and centres c, c'; 0 if no
  /// two overlap.
  [[nodiscard]] double MaxOverlap(int threads) const;

  /// Smallest ratio |c - c'| / max(r, r') between the given ball and any other one; infinite if there is no
  /// other.
  [[nodiscard]] double Separation(const Ball& one_of_them) const;

  /// Largest protrusion: radius + signed distance of the centre, which is above 0 if a ball protrudes; minus
  /// infinity without balls. The solid's signed distances must be exact inside, because boxes deep inside are
  /// skipped.
  [[nodiscard]] double MaxProtrusion(const Solid& solid, int threads) const;

 private:
  struct Node {
    std::array<double, 3> low_m, high_m;  ///< corners of the box around the balls' centres
    double radius_m;                      ///< largest radius of the balls below this node
    /// Squared distance from p to the box; 0 inside.
    [[nodiscard]] double SquaredDistance(const Vector3& p_m) const;
  };
  /// Level 0 has a node for each run of kLeaf balls; each further level has one for each run of kArity nodes
  /// of the level before.
  struct Tree {
    std::vector<Ball> balls;
    std::vector<std::vector<Node>> levels;
  };
  static constexpr std::size_t kLeaf = 8, kArity = 4;

  /// @param balls  balls of one octave of radii, sorted along a Morton curve
  static Tree MakeTree(std::vector<Ball> balls);
  /// Calls visit(ball, its index) for balls in nodes that may come nearer to p than limit(node), nearest
  /// nodes first, and stops if a visit returns true.
  template <typename Limit, typename Visit>
  static bool Search(const Tree& tree, const Vector3& p_m, const Limit& limit, const Visit& visit);

  std::vector<Tree> trees_;  ///< the octave of the largest balls first
};

}  // namespace osteon::simulation
