#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kinematics/spatial.h"

namespace osteon::report {

/// A grid of equal cells over a region. Each cell lists the items whose bounding boxes overlap it. Built
/// once.
class CellGrid {
 public:
  /// An item's bounding box.
  struct Item {
    Vector3 min, max;
  };

  CellGrid() = default;
  /// Makes cells of edge `cell_m`, or larger ones if more than four million would be needed.
  CellGrid(std::span<const Item> items, double cell_m);

  using Index = std::array<int, 3>;
  /// The cell that contains p; if p is outside, the nearest cell of the grid.
  [[nodiscard]] Index Clamped(const Vector3& p) const;
  [[nodiscard]] bool Contains(const Index& cell) const;
  /// The cell that contains p; may lie outside the grid.
  [[nodiscard]] Index At(const Vector3& p) const;
  /// The items of a cell of the grid.
  [[nodiscard]] std::span<const std::uint32_t> operator[](const Index& cell) const;

  [[nodiscard]] bool empty() const { return items_.empty(); }
  [[nodiscard]] const Vector3& min() const { return min_; }
  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] const Index& size() const { return size_; }

 private:
  [[nodiscard]] std::size_t Flat(const Index& cell) const {
    return (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(cell[1])) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(cell[0]);
  }

  Vector3 min_{Vector3::Zero()};
  double cell_m_{1.0};
  Index size_{1, 1, 1};
  std::vector<std::uint32_t> begin_;  ///< start of each cell's list in items_, and one past the last
  std::vector<std::uint32_t> items_;  ///< indices of the items, cell by cell
};

}  // namespace osteon::report
