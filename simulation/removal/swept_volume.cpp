#include "simulation/removal/swept_volume.h"

#include <atomic>
#include <cstdint>

#include "base/parallel.h"

namespace osteon::simulation {
namespace {

constexpr int kBlock = 8;  // cells along the edge of a block, which may be decided as a whole

}  // namespace

double SweptVolume(const Solid& solid, const SweptTool& swept, double cell_m, int threads) {
  const Eigen::AlignedBox3d cells = swept.Bounds().intersection(solid.Bounds());
  if (swept.empty() || cells.isEmpty()) return 0.0;
  const Eigen::Vector3i count = (cells.sizes() / cell_m).array().ceil().max(1.0).cast<int>();
  const Vector3 step = cells.sizes().array() / count.cast<double>().array();
  // Between two points, a signed distance changes by at most the distance of the points. If a block's centre
  // is farther than reach_m outside the sweep, no cell of the block is swept. If it is farther than reach_m
  // inside the sweep or the solid, all its cells lie inside.
  const Eigen::Vector3i blocks = (count + Eigen::Vector3i::Constant(kBlock - 1)) / kBlock;
  const double reach_m = 0.5 * (kBlock - 1) * step.norm() * (1.0 + 1e-9);
  const auto block_count = static_cast<std::size_t>(blocks.x()) * static_cast<std::size_t>(blocks.y()) *
                           static_cast<std::size_t>(blocks.z());
  std::atomic<std::int64_t> inside{0};
  ParallelFor(
      block_count, threads,
      [&](std::size_t begin, std::size_t end) {
        std::int64_t found = 0;
        for (std::size_t block = begin; block < end; ++block) {
          const auto plane = static_cast<std::size_t>(blocks.x()) * static_cast<std::size_t>(blocks.y());
          const Eigen::Vector3i first =
              kBlock * Eigen::Vector3i(static_cast<int>(block % static_cast<std::size_t>(blocks.x())),
                                       static_cast<int>(block % plane / static_cast<std::size_t>(blocks.x())),
                                       static_cast<int>(block / plane));
          const Eigen::Vector3i last = (first + Eigen::Vector3i::Constant(kBlock)).cwiseMin(count);
          const Vector3 middle =
              cells.min() + step.cwiseProduct(first.cast<double>() + Vector3::Constant(0.5 * kBlock));
          const double to_sweep_m = swept.SignedDistance(middle);
          if (to_sweep_m > reach_m) continue;
          const double to_solid_m = solid.SignedDistance(middle);
          const bool all_swept = to_sweep_m < -reach_m, all_solid = to_solid_m < -reach_m;
          for (int k = first.z(); k < last.z(); ++k)
            for (int j = first.y(); j < last.y(); ++j)
              for (int i = first.x(); i < last.x(); ++i) {
                const Vector3 p = cells.min() + step.cwiseProduct(Vector3(i + 0.5, j + 0.5, k + 0.5));
                if ((all_swept || swept.SignedDistance(p) < 0.0) &&
                    (all_solid || solid.SignedDistance(p) < 0.0))
                  ++found;
              }
        }
        inside += found;
      },
      8);
  return static_cast<double>(inside.load()) * step.prod();
}

}  // namespace osteon::simulation
