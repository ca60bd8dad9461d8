#include "report/cell_grid.h"

#include <algorithm>
#include <cmath>

namespace osteon::report {
namespace {
constexpr double kMaxCells = 4e6;  // most cells; if more would be needed, the cells are made larger
}

CellGrid::CellGrid(std::span<const Item> items, double cell_m) {
  if (items.empty()) return;
  min_ = items.front().min;
  Vector3 max = items.front().max;
  for (const Item& item : items) {
    min_ = min_.cwiseMin(item.min);
    max = max.cwiseMax(item.max);
  }
  const Vector3 extent = max - min_;
  cell_m_ = std::max(cell_m, 1e-6);
  while (((extent / cell_m_).array() + 1.0).prod() > kMaxCells) cell_m_ *= 1.3;
  for (int k = 0; k < 3; ++k) size_[k] = static_cast<int>(extent[k] / cell_m_) + 1;

  // two passes over the boxes: count the items of each cell, then fill in the lists
  const std::size_t cells = static_cast<std::size_t>(size_[0]) * size_[1] * size_[2];
  begin_.assign(cells + 1, 0);
  // calls visit(flat index) for every cell that the item's box overlaps
  const auto each_cell = [this](const Item& item, const auto& visit) {
    const Index a = Clamped(item.min), b = Clamped(item.max);
    for (int z = a[2]; z <= b[2]; ++z)
      for (int y = a[1]; y <= b[1]; ++y)
        for (int x = a[0]; x <= b[0]; ++x) visit(Flat({x, y, z}));
  };
  for (const Item& item : items) each_cell(item, [this](std::size_t cell) { ++begin_[cell + 1]; });
  for (std::size_t cell = 0; cell < cells; ++cell) begin_[cell + 1] += begin_[cell];
  items_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < items.size(); ++i)
    each_cell(items[i], [&](std::size_t cell) { items_[next[cell]++] = static_cast<std::uint32_t>(i); });
}

CellGrid::Index CellGrid::At(const Vector3& p) const {
  Index cell{};
  for (int k = 0; k < 3; ++k) {
    const double at = std::floor((p[k] - min_[k]) / cell_m_);
    // clamp, so that a point far outside does not overflow the integer
    cell[k] = static_cast<int>(std::clamp(at, -1e6, 1e6));
  }
  return cell;
}

CellGrid::Index CellGrid::Clamped(const Vector3& p) const {
  Index cell = At(p);
  for (int k = 0; k < 3; ++k) cell[k] = std::clamp(cell[k], 0, size_[k] - 1);
  return cell;
}

bool CellGrid::Contains(const Index& cell) const {
  return cell[0] >= 0 && cell[1] >= 0 && cell[2] >= 0 && cell[0] < size_[0] && cell[1] < size_[1] &&
         cell[2] < size_[2];
}

std::span<const std::uint32_t> CellGrid::operator[](const Index& cell) const {
  if (items_.empty()) return {};
  const std::size_t flat = Flat(cell);
  return {items_.data() + begin_[flat], begin_[flat + 1] - begin_[flat]};
}

}  // namespace osteon::report
