#include "simulation/packing/graded_cells.h"

#include <cmath>

#include "base/check_range.h"
#include "simulation/packing/graded_descent.h"

namespace osteon::simulation {
namespace {

constexpr std::size_t kMaxCells = 100'000'000;  // 4 GB

}  // namespace

void CheckGrade(const std::string& name, const GradeParams& grade, double min_m, double max_m) {
  // so that indices, counted in halves of the finest cells, stay far within 32 bits
  constexpr std::size_t kMaxCoarser = 4;
  CheckRangeMm(name + ": finest side", grade.finest_m, min_m, max_m);
  const std::vector<double>& from = grade.coarser_from_m;
  if (from.size() > kMaxCoarser)
    throw std::invalid_argument(
        fmt::format("{}: found {} coarser levels, accepted 0 … {}", name, from.size(), kMaxCoarser));
  for (std::size_t i = 0; i < from.size(); ++i)
    CheckRangeMm(fmt::format("{}: depth of level {}", name, i + 1), from[i], i > 0 ? from[i - 1] : 0.0, 1.0);
}

std::vector<Cell> GradedRoots(const Solid& solid, const GradeParams& params) {
  // Start with cells larger than the coarsest level's, so that large empty parts cost only one query each.
  const Eigen::AlignedBox3d box = solid.Bounds();
  const double min_side = 0.125 * box.sizes().maxCoeff();
  int top = static_cast<int>(params.coarser_from_m.size());
  while (std::ldexp(params.finest_m, top) < min_side) ++top;
  const double side = std::ldexp(params.finest_m, top);
  std::array<std::int32_t, 3> first{}, last{};
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = static_cast<std::int32_t>(std::floor(box.min()[axis] / side));
    last[axis] = static_cast<std::int32_t>(std::floor(box.max()[axis] / side));
  }
  std::vector<Cell> roots;
  for (std::int32_t z = first[2]; z <= last[2]; ++z)
    for (std::int32_t y = first[1]; y <= last[1]; ++y)
      for (std::int32_t x = first[0]; x <= last[0]; ++x)
        roots.push_back({.index = {x, y, z}, .level = top, .side_m = side, .signed_distance_m = 0.0});
  return roots;
}

std::vector<Cell> DivideGraded(const Solid& solid, const CutZone& zone, const GradeParams& params,
                               CellChoice wanted, int threads) {
  // keeps a leaf if it may hold a part of the solid or, for kSurface, of the surface
  const auto add = [&](Cell cell, std::vector<Cell>& cells) {
    cell.signed_distance_m = solid.SignedDistance(cell.center());
    const double reach = cell.reach_m();
    if (cell.signed_distance_m > reach) return;
    if (wanted == CellChoice::kSurface && cell.signed_distance_m < -reach) return;
    cells.push_back(cell);
  };
  return DescendGraded<Cell>(solid, zone, params, wanted, threads, kMaxCells, add);
}

CellRandom::CellRandom(const Cell& cell, std::uint64_t salt) : state_(salt) {
  for (const std::int32_t i : cell.index) state_ = NextBits() ^ static_cast<std::uint32_t>(i);
  state_ = NextBits() ^ static_cast<std::uint64_t>(cell.level);
}

std::uint64_t CellRandom::NextBits() { return MixBits(state_ += kSplitMixStep); }

Vector3 CellRandom::NextInUnitCube() {
  const double x = Next(), y = Next(), z = Next();
  return {x, y, z};
}

}  // namespace osteon::simulation
