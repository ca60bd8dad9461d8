#pragma once

#include <cstdint>
#include <vector>

#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Distances into a solid at the nodes of a cubic grid: a quick bound for the distance at any point, which
/// spares most exact queries deep inside, and a first idea of where the solid is thick.
class DistanceGrid {
 public:
  /// @param nodes_along  about so many nodes along the longest side of the solid's bounds
  DistanceGrid(const Solid& solid, int nodes_along, int threads);

  /// At most the distance from p to the surface, and negative where that tells nothing: distances change no
  /// faster than their place.
  [[nodiscard]] double LowerBound(const Vector3& p_m) const;

  /// Nodes inside the solid that lie no nearer to the surface than all 26 around them, in the grid's order.
  [[nodiscard]] std::vector<Vector3> LocalMaxima() const;

  [[nodiscard]] double spacing_m() const { return spacing_m_; }

 private:
  [[nodiscard]] std::size_t At(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * count_[1] + y) * count_[0] + x;
  }
  [[nodiscard]] Vector3 Node(int x, int y, int z) const { return low_m_ + spacing_m_ * Vector3(x, y, z); }

  Vector3 low_m_;
  double spacing_m_;
  std::array<int, 3> count_{};
  std::vector<double> depth_m_;  ///< negated signed distance; -1 where it is surely outside
};

}  // namespace osteon::simulation
