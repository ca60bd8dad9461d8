#pragma once

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "base/parallel.h"
#include "simulation/packing/graded_cells.h"

namespace osteon::simulation {

/// Descends the octree of a graded division depth first, on `threads` threads, and collects the items of its
/// leaves.
///
/// `add_leaf(cell, items)` is called for each leaf that is left after parents away from the wanted part were
/// skipped. It appends the leaf's items to `items`; the leaf's signed distance is not computed yet. Each part
/// of the tree has its own `items`, empty at the start. The parts do not depend on the number of threads, so
/// the items and their order do not either.
/// @throws std::invalid_argument if there would be more than `max_items` items.
template <typename Item, typename AddLeaf>
[[nodiscard]] std::vector<Item> DescendGraded(const Solid& solid, const CutZone& zone,
                                              const GradeParams& params, CellChoice wanted, int threads,
                                              std::size_t max_items, const AddLeaf& add_leaf) {
  struct Descent {
    const Solid& solid;
    const CutZone& zone;
    const GradeParams& params;
    CellChoice wanted;
    std::size_t max_items;
    const AddLeaf& add_leaf;
    std::atomic<std::size_t> total{0};

    /// True if the cell is small enough for the depth of its centre.
    [[nodiscard]] bool IsLeaf(const Cell& cell) const {
      const int top = static_cast<int>(params.coarser_from_m.size());
      if (cell.level > top) return false;
      return cell.level == 0 || zone.DepthAt(cell.center()) >= params.coarser_from_m[cell.level - 1];
    }

    /// Adds the items of a leaf. Divides any other cell, unless it lies outside the wanted part.
    void Visit(const Cell& cell, std::vector<Item>& items) {
      if (IsLeaf(cell)) {
        add_leaf(cell, items);
        if (items.size() + total > max_items)
          throw std::invalid_argument(fmt::format(
              "bone: found more than {} cells at {:g} mm, accepted fewer: take a larger spacing or "
              "a smaller solid",
              max_items, params.finest_m * 1e3));
        return;
      }
      const double distance = solid.SignedDistance(cell.center()), reach = cell.reach_m();
      if (distance > reach || (wanted == CellChoice::kSurface && distance < -reach)) return;
      for (int octant = 0; octant < 8; ++octant) {
        Cell child{
            .index = {}, .level = cell.level - 1, .side_m = 0.5 * cell.side_m, .signed_distance_m = 0.0};
        for (int axis = 0; axis < 3; ++axis)
          child.index[axis] = 2 * cell.index[axis] + ((octant >> axis) & 1);
        Visit(child, items);
      }
    }
  } descent{.solid = solid,
            .zone = zone,
            .params = params,
            .wanted = wanted,
            .max_items = max_items,
            .add_leaf = add_leaf};

  const std::vector<Cell> roots = GradedRoots(solid, params);
  std::vector<std::vector<Item>> parts(roots.size());
  ParallelFor(
      roots.size(), threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          descent.Visit(roots[i], parts[i]);
          descent.total += parts[i].size();
        }
      },
      1);
  std::vector<Item> items;
  items.reserve(descent.total);
  for (std::vector<Item>& part : parts) {
    items.insert(items.end(), part.begin(), part.end());
    part = {};
  }
  return items;
}

}  // namespace osteon::simulation
