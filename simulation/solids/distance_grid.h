#pragma once

#include <cstdint>
#include <vector>

#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Distances into a solid at the nodes of a cubic grid. They give a fast lower bound of the distance at any
/// point, which saves most exact queries deep inside. Their local maxima show where the solid is thick.
class DistanceGrid {
 public:
  /// @param nodes_along  approximate number of nodes along the longest side of the solid's bounds
  DistanceGrid(const Solid& solid, int nodes_along, int threads);

  /// Lower bound of the depth of p, its distance from the surface: the depth of the nearest node, less the
  /// distance to this node. Negative if the grid gives no bound.
  [[nodiscard]] double LowerBound(const Vector3& p_m) const;

  /// Nodes inside the solid that are at least as far from the surface as all 26 neighbouring nodes, in the
  /// grid's order.
  [[nodiscard]] std::vector<Vector3> LocalMaxima() const;

  [[nodiscard]] double spacing_m() const { return spacing_m_; }

 private:
  /// Index of a node in depth_m_.
  [[nodiscard]] std::size_t At(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * count_[1] + y) * count_[0] + x;
  }
  /// Place of a node, in G.
  [[nodiscard]] Vector3 Node(int x, int y, int z) const { return low_m_ + spacing_m_ * Vector3(x, y, z); }

  Vector3 low_m_;
  double spacing_m_;
  std::array<int, 3> count_{};
  std::vector<double> depth_m_;  ///< negated signed distance of each node; -1: the node is certainly outside
};

}  // namespace osteon::simulation
