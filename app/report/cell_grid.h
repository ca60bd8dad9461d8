#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kinematics/spatial.h"

namespace osteon::app {

/// Boxes of equal cells over a region, each with the list of the items that reach into it. Built once.
class CellGrid {
 public:
  /// An item: a box around it.
  struct Item {
    Vector3 min, max;
  };

  CellGrid() = default;
  /// Cells of edge `cell_m`, or coarser where more than four million would be needed.
  CellGrid(std::span<const Item> items, double cell_m);

  using Index = std::array<int, 3>;
  /// The cell that holds p; clamped to the grid where p is outside.
  [[nodiscard]] Index Clamped(const Vector3& p) const;
  [[nodiscard]] bool Contains(const Index& cell) const;
  /// The cell that holds p, which may lie outside the grid.
  [[nodiscard]] Index At(const Vector3& p) const;
  /// The items that reach into a cell of the grid.
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
  std::vector<std::uint32_t> begin_;  ///< of each cell in items_, and one past the last
  std::vector<std::uint32_t> items_;
};

}  // namespace osteon::app
