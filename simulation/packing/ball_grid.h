#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/bone/bone.h"

namespace osteon::simulation {

/// Spatial index over balls of very different radii. It finds the balls near a point.
///
/// One uniform grid for each octave of radii stores each ball once, in the cell of its centre. A cell is as
/// wide as two of its octave's largest balls. A grid keeps only occupied cells (a hash table with linear
/// probing), so that ten million balls take about 600 MB.
///
/// Any number of threads may read while none inserts. The results and their order depend only on the order of
/// the insertions.
class BallGrid {
 public:
  /// @param origin_m  a point near the balls: cells are counted from here, up to 2^20 in each direction
  explicit BallGrid(const Vector3& origin_m) : origin_m_(origin_m) {}

  void Insert(const Ball& ball);
  [[nodiscard]] const std::vector<Ball>& balls() const { return balls_; }

  /// Appends to `found` the balls whose surfaces come nearer than `reach_m` to p, and those that contain p.
  void Gather(const Vector3& p_m, double reach_m, std::vector<Ball>& found) const;

  /// Distance from p to the nearest surface of a ball, negative inside a ball; at most `reach_m`.
  [[nodiscard]] double Clearance(const Vector3& p_m, double reach_m) const;

 private:
  /// Balls with radii in [2^(exponent-1), 2^exponent).
  struct Octave {
    int exponent{0};
    double cell_m{0.0};
    /// Key of the cell in each slot, kNoKey: free; the size is a power of two
    std::vector<std::uint64_t> keys;
    std::vector<std::uint32_t> heads;  ///< last inserted ball of the cell in each slot
    std::size_t cells{0};
    std::vector<std::uint32_t> balls;  ///< all balls of the octave
  };
  static constexpr std::uint64_t kNoKey = ~std::uint64_t{0};
  static constexpr std::uint32_t kNoBall = ~std::uint32_t{0};
  /// If an octave has at most so many balls, a search tests all of them and does not use the cells.
  static constexpr std::size_t kFewBalls = 48;

  /// Indices of the cell of this octave that contains p.
  [[nodiscard]] std::array<std::int64_t, 3> CellOf(const Octave& octave, const Vector3& p_m) const;
  /// Packs a cell's three indices into one number, 21 bits each.
  [[nodiscard]] static std::uint64_t Key(std::int64_t x, std::int64_t y, std::int64_t z);
  /// Slot of the key in the hash table; if the key is not there, the free slot where it belongs.
  [[nodiscard]] static std::size_t Slot(const Octave& octave, std::uint64_t key);
  /// Doubles the hash table.
  static void Grow(Octave& octave);
  /// Calls visit(ball, signed distance from p to its surface) for balls whose surfaces come nearer than
  /// `reach_m`, and for those that contain p.
  template <typename Visit>
  void VisitNear(const Vector3& p_m, double reach_m, const Visit& visit) const;

  Vector3 origin_m_;
  std::vector<Ball> balls_;
  std::vector<std::uint32_t> next_;  ///< for each ball, the ball of its cell that was inserted before
  std::vector<Octave> octaves_;      ///< in descending order of radii
};

}  // namespace osteon::simulation
