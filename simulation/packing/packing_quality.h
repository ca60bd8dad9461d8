#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

struct QualityParams {
  std::size_t samples{200'000};         ///< approximate number in the solid's volume; 1000 … 100 million
  std::size_t surface_samples{50'000};  ///< approximate number on its surface; 1000 … 10 million
  std::uint64_t seed{1};                ///< selects the samples' random offsets
  int threads{0};                       ///< 0: one per core. The result does not depend on it.
};

/// Number of balls with from <= radius < to.
struct RadiusBin {
  double from_m{0.0}, to_m{0.0};
  std::size_t spheres{0};
};

/// How well balls approximate a solid.
struct PackingQuality {
  std::size_t spheres{0};
  double r_min_m{0.0}, r_max_m{0.0};
  /// Eight bins per octave, [2^(k/8), 2^((k+1)/8)) m, from the smallest ball's radius to the largest's.
  std::vector<RadiusBin> radius_histogram;

  double coverage{0.0};  ///< share of the solid's volume that lies in some ball
  /// Computed as for independent samples; the true error of these stratified samples is smaller
  double coverage_standard_error{0.0};
  std::size_t volume_samples{0};  ///< number of samples inside the solid
  double solid_volume_m3{0.0};    ///< volume of the solid, by these samples

  /// Distance from a point of the surface to the union of the balls, 0 within it.
  double surface_gap_mean_m{0.0}, surface_gap_p95_m{0.0}, surface_gap_max_m{0.0};
  /// Percentiles of that distance over the surface: [0] the smallest gap, [100] the largest.
  std::array<double, 101> surface_gap_percentiles_m{};
  std::size_t surface_samples{0};
  double surface_area_m2{0.0};  ///< area of the surface, by its samples

  /// Largest distance by which a ball reaches out of the solid: radius + signed distance of the centre.
  /// Negative where no ball touches the surface.
  double protrusion_max_m{0.0};
  /// Largest overlap r + r' - |c - c'| over all pairs of balls with radii r, r' and centres c, c'; 0 if no
  /// two overlap.
  double overlap_max_m{0.0};
};

/// Measures a packing against its solid.
///
/// Volume samples: a random point in each cell of a cubic grid. Surface samples: the nearest surface points
/// of those random points that lie within half a cell of the surface. Their density on the surface is
/// uniform, up to a relative error of (cell / radius of curvature)². Some samples beside a sharp edge fall
/// onto the edge itself. The largest protrusion and overlap are over all balls, not over samples. Without
/// balls, coverage is 0, the gaps are infinite and protrusion and overlap are 0.
/// @throws std::invalid_argument naming the parameter or the ball, the value found and what is accepted.
[[nodiscard]] PackingQuality MeasurePacking(const Solid& solid, std::span<const Ball> balls,
                                            const QualityParams& params = {});

}  // namespace osteon::simulation
