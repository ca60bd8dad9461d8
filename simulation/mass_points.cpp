#include "simulation/mass_points.h"

#include "simulation/check_range.h"
#include "simulation/morton.h"

namespace osteon::simulation {
namespace {

constexpr std::uint64_t kPointSalt = 16;

/// Element i of the R3 sequence in the unit cube (Roberts, "The unreasonable effectiveness of quasirandom
/// sequences", 2018). Given to cells in the octree's order, it spreads the points of each group of neighbours
/// over the depth of a cell: thin shells are then sampled about twice as well as with independent jitter (1
/// mm shells of the cup: rms .34 against .61 %).
Vector3 QuasiRandom(std::size_t i) {
  const double n = static_cast<double>(i);
  Vector3 u(0.8191725133961645 * n, 0.6710436067037893 * n, 0.5497004779019703 * n);
  u.array() -= u.array().floor();
  return u;
}

/// Adds the cell's point, if any of its samples is bone. `place` is the cell's in the octree's order.
void AddPoint(const Solid& solid, const Cell& cell, std::size_t place, int n,
              std::vector<MassPoint>& points) {
  const double volume = cell.side_m * cell.side_m * cell.side_m;
  Vector3 chosen = cell.least_corner() + cell.side_m * QuasiRandom(place);
  const int samples = n * n * n;
  int inside = samples;
  if (cell.signed_distance_m > -cell.reach_m()) {
    CellRandom random(cell, kPointSalt);
    inside = 0;
    for (int i = 0; i < samples; ++i) {
      const Vector3 in_grid = Vector3(i % n, i / n % n, i / (n * n)) + random.NextInUnitCube();
      const Vector3 p = cell.least_corner() + cell.side_m / n * in_grid;
      if (solid.SignedDistance(p) >= 0.0) continue;
      // each of the samples inside is equally likely to stay (reservoir of one)
      ++inside;
      if (random.Next() * inside < 1.0) chosen = p;
    }
  }
  if (inside == 0) return;
  points.push_back(
      {.p_m = chosen, .volume_m3 = volume * inside / samples, .material = solid.MaterialAt(chosen)});
}

}  // namespace

std::vector<MassPoint> BuildMassPoints(const Solid& solid, const CutZone& zone,
                                       const MassPointParams& params) {
  CheckGrade("mass points: cells", params.cells, 0.1e-3, 0.050);
  if (params.samples_along_axis < 2 || params.samples_along_axis > 16)
    throw std::invalid_argument(fmt::format("mass points: samples along an axis: found {}, accepted 2 … 16",
                                            params.samples_along_axis));
  const std::vector<Cell> cells = DivideGraded(solid, zone, params.cells, CellsWanted::kSolid);
  std::vector<MassPoint> points;
  points.reserve(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    AddPoint(solid, cells[i], i, params.samples_along_axis, points);
  SortAlongMortonCurve(points, solid.Bounds(), [](const MassPoint& point) { return Vector3(point.p_m); });
  return points;
}

}  // namespace osteon::simulation
