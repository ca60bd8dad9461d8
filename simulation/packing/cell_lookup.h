#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "simulation/packing/graded_cells.h"

namespace osteon::simulation {

/// Finds the cells of a graded division that lie at a place. Each level has a dense table of bricks of 8
/// cells per side; only bricks that contain a cell are stored.
class CellLookup {
 public:
  explicit CellLookup(const std::vector<Cell>& cells) {
    for (std::uint32_t i = 0; i < cells.size(); ++i) {
      const Cell& cell = cells[i];
      if (cell.level >= static_cast<int>(levels_.size())) levels_.resize(cell.level + 1);
      Level& level = levels_[cell.level];
      level.side_m = cell.side_m;
      for (int axis = 0; axis < 3; ++axis) {
        level.first[axis] = std::min(level.first[axis], cell.index[axis] >> kBits);
        level.last[axis] = std::max(level.last[axis], cell.index[axis] >> kBits);
      }
    }
    for (Level& level : levels_)
      if (level.side_m > 0.0)
        level.bricks.resize(static_cast<std::size_t>(level.Size(0)) * level.Size(1) * level.Size(2), kNone);
    for (std::uint32_t i = 0; i < cells.size(); ++i) {
      Level& level = levels_[cells[i].level];
      const auto& at = cells[i].index;
      std::uint32_t& brick = level.bricks[level.BrickAt(at[0] >> kBits, at[1] >> kBits, at[2] >> kBits)];
      if (brick == kNone) {
        brick = static_cast<std::uint32_t>(level.cells.size());
        level.cells.emplace_back().fill(kNone);
      }
      level.cells[brick][InBrick(at[0], at[1], at[2])] = i;
    }
  }

  [[nodiscard]] int levels() const { return static_cast<int>(levels_.size()); }
  /// Side of a level's cells; 0 if the level has no cells.
  [[nodiscard]] double side_m(int level) const { return levels_[level].side_m; }

  /// Calls visit(index of the cell) for each of a level's cells that meets the box.
  template <typename Visit>
  void ForEachIn(int level_index, const Vector3& low_m, const Vector3& high_m, const Visit& visit) const {
    const Level& level = levels_[level_index];
    if (level.bricks.empty()) return;
    std::array<std::int32_t, 3> low{}, high{};
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::max(static_cast<std::int32_t>(std::floor(low_m[axis] / level.side_m)),
                           level.first[axis] << kBits);
      high[axis] = std::min(static_cast<std::int32_t>(std::floor(high_m[axis] / level.side_m)),
                            (level.last[axis] << kBits) + kMask);
    }
    for (std::int32_t bz = low[2] >> kBits; bz <= high[2] >> kBits; ++bz)
      for (std::int32_t by = low[1] >> kBits; by <= high[1] >> kBits; ++by)
        for (std::int32_t bx = low[0] >> kBits; bx <= high[0] >> kBits; ++bx) {
          const std::uint32_t brick = level.bricks[level.BrickAt(bx, by, bz)];
          if (brick == kNone) continue;
          const auto from = [&](int axis, std::int32_t b) { return std::max(low[axis], b << kBits); };
          const auto to = [&](int axis, std::int32_t b) {
            return std::min(high[axis], (b << kBits) + kMask);
          };
          for (std::int32_t z = from(2, bz); z <= to(2, bz); ++z)
            for (std::int32_t y = from(1, by); y <= to(1, by); ++y)
              for (std::int32_t x = from(0, bx); x <= to(0, bx); ++x) {
                const std::uint32_t cell = level.cells[brick][InBrick(x, y, z)];
                if (cell != kNone) visit(cell);
              }
        }
  }

 private:
  /// kBits: number of low bits of a cell's index along one axis that give its place within the brick.
  static constexpr int kBits = 3, kMask = (1 << kBits) - 1;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  /// Index of a cell within its brick.
  /// @param x, y, z  indices of the cell
  static std::size_t InBrick(std::int32_t x, std::int32_t y, std::int32_t z) {
    return static_cast<std::size_t>(((z & kMask) << kBits | (y & kMask)) << kBits | (x & kMask));
  }

  struct Level {
    double side_m{0.0};
    /// Lowest and highest indices of stored bricks
    std::array<std::int32_t, 3> first{kFar, kFar, kFar}, last{-kFar, -kFar, -kFar};
    std::vector<std::uint32_t> bricks;  ///< for each brick (BrickAt): its index in `cells`; kNone: no cell
    /// For each stored brick, the indices of its cells in the order of InBrick; kNone: no cell.
    std::vector<std::array<std::uint32_t, 1 << (3 * kBits)>> cells;
    static constexpr std::int32_t kFar = std::numeric_limits<std::int32_t>::max();

    /// Number of bricks in the table along an axis.
    [[nodiscard]] std::int32_t Size(int axis) const { return last[axis] - first[axis] + 1; }
    /// Index of a brick in `bricks`.
    /// @param x, y, z  indices of the brick
    [[nodiscard]] std::size_t BrickAt(std::int32_t x, std::int32_t y, std::int32_t z) const {
      return (static_cast<std::size_t>(z - first[2]) * Size(1) + (y - first[1])) * Size(0) + (x - first[0]);
    }
  };
  std::vector<Level> levels_;
};

}  // namespace osteon::simulation
