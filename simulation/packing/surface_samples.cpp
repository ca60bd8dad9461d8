#include "simulation/packing/surface_samples.h"

#include <algorithm>
#include <cmath>

#include "base/check_range.h"
#include "base/parallel.h"
#include "simulation/packing/morton.h"

namespace osteon::simulation {
namespace {

constexpr double kOnSurface_m = 1e-7;   // largest distance of a nearest point from the surface
constexpr double kNormalStep_m = 1e-5;  // step of the differences for a normal

// Appends the surface points of one cell. A cell that the surface may cross is divided into eight until its
// edge is at most the spacing. The surface cannot cross a cell whose centre is farther from it than half the
// diagonal.
void Collect(const Solid& solid, const Vector3& middle, double half_m, double spacing_m,
             std::vector<OrientedPoint>& samples) {
  const SurfacePoint nearest = solid.NearestSurface(middle);
  if (std::abs(nearest.distance_m) > std::sqrt(3.0) * half_m) return;
  if (2.0 * half_m > 1.001 * spacing_m) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 side((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? 1 : -1);
      Collect(solid, middle + 0.5 * half_m * side, 0.5 * half_m, spacing_m, samples);
    }
    return;
  }
  // Keep the point only if it is on the surface: outside, a solid may return only a bound of the distance.
  if (std::abs(solid.SignedDistance(nearest.p_m)) > kOnSurface_m) return;
  samples.push_back({.p_m = nearest.p_m, .normal = SurfaceNormal(solid, nearest.p_m)});
}

}  // namespace

Vector3 SurfaceNormal(const Solid& solid, const Vector3& p_m) {
  Vector3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 step = kNormalStep_m * Vector3::Unit(axis);
    gradient[axis] = solid.SignedDistance(p_m + step) - solid.SignedDistance(p_m - step);
  }
  // on an edge whose two sides' normals cancel out, any direction is valid
  return gradient.norm() > 1e-3 * kNormalStep_m ? Vector3(gradient.normalized()) : Vector3(Vector3::UnitZ());
}

std::vector<OrientedPoint> PointsOfSurface(const Solid& solid, double spacing_m) {
  CheckRangeMm("surface samples: spacing", spacing_m, 0.05e-3, 0.020);
  const Eigen::AlignedBox3d box = solid.Bounds();
  const double side_m = box.sizes().maxCoeff();
  CheckRangeMm("surface samples: spacing", spacing_m, side_m / 2000.0, 0.020);

  // start with cells a few levels coarser than the samples, so that there are cells for all threads
  double cell_m = spacing_m;
  while (cell_m < side_m / 8.0) cell_m *= 2.0;
  const Eigen::Vector3i count = (box.sizes() / cell_m).array().floor().cast<int>() + 1;
  const auto cells = static_cast<std::size_t>(count.prod());
  std::vector<std::vector<OrientedPoint>> of_cell(cells);
  ParallelFor(
      cells, 0,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const int at = static_cast<int>(i);
          const Vector3 middle =
              box.min() + cell_m * Vector3(at % count.x() + 0.5, at / count.x() % count.y() + 0.5,
                                           at / count.x() / count.y() + 0.5);
          Collect(solid, middle, 0.5 * cell_m, spacing_m, of_cell[i]);
        }
      },
      1);
  std::vector<OrientedPoint> samples;
  for (const auto& of_one : of_cell) samples.insert(samples.end(), of_one.begin(), of_one.end());
  return samples;
}

SampleIndex::SampleIndex(std::vector<OrientedPoint> samples) : samples_(std::move(samples)) {
  Eigen::AlignedBox3d bounds;
  for (const OrientedPoint& sample : samples_) bounds.extend(sample.p_m);
  if (!samples_.empty())
    SortAlongMortonCurve(samples_, bounds, [](const OrientedPoint& sample) { return sample.p_m; });
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (i % kChunk == 0) boxes_.emplace_back();
    boxes_.back().extend(samples_[i].p_m);
  }
}

std::optional<OrientedPoint> SampleIndex::Nearest(const Vector3& c_m, double limit_m, bool only_ahead) const {
  std::optional<OrientedPoint> nearest;
  double squared_limit = limit_m * limit_m;
  for (std::size_t chunk = 0; chunk < boxes_.size(); ++chunk) {
    if (boxes_[chunk].squaredExteriorDistance(c_m) >= squared_limit) continue;
    const std::size_t end = std::min(samples_.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      const Vector3 offset = samples_[i].p_m - c_m;
      if (offset.squaredNorm() >= squared_limit || (only_ahead && offset.dot(samples_[i].normal) <= 0.0))
        continue;
      squared_limit = offset.squaredNorm();
      nearest = samples_[i];
    }
  }
  return nearest;
}

}  // namespace osteon::simulation
