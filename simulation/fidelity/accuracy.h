#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulation/fidelity/carved_shape.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/swept_tool.h"

namespace osteon::simulation {

/// How finely a cut is sampled.
struct AccuracyParams {
  std::vector<double> probe_radii_m{};  ///< radii of the probe balls, none larger than the tool's
  std::size_t surface_cells{
      60'000};  ///< sampling cells along the cut; the standard error falls with the root of their number
  std::size_t probe_samples{6'000};  ///< largest number of places for each probe
  double deepest_gap_m{3e-3};        ///< a probe that meets no bone stops this far below the cut
  std::uint64_t seed{0};             ///< seed of the random samples
  int threads{0};                    ///< number of threads; 0: one per core; the result does not depend on it
};

/// Gap between the exact cut and the remaining bone, measured with a probe ball: the distance that the ball
/// travels from the exact cut along the cut's normal until it touches bone.
struct ProbeGap {
  double radius_m{0.0};
  double mean_m{0.0}, p95_m{0.0}, max_m{0.0};
  std::size_t samples{0};
};

/// Accuracy of a cut against the exact volume that the tool's cutting surface swept.
struct CutAccuracy {
  double cut_area_m2{0.0};       ///< area of the swept volume's surface within the solid
  double depth_error_m{0.0};     ///< bone lost outside the swept volume, over the cut's area
  double depth_error_se_m{0.0};  ///< standard error of this estimate
  double lost_m3{0.0};           ///< bone lost outside the swept volume
  double swept_volume_m3{0.0};   ///< volume of the solid within the swept volume
  double left_volume_m3{0.0};    ///< volume of bone that remains within the swept volume
  double left_depth_m{0.0};      ///< largest depth of remaining bone within the swept volume, 0: none
  std::vector<ProbeGap> probes;  ///< one for each requested radius

  /// Bone left within the swept volume, over the cut's area; 0 if there is no cut.
  [[nodiscard]] double MeanLeft_m() const { return cut_area_m2 > 0.0 ? left_volume_m3 / cut_area_m2 : 0.0; }
};

/// Measures a cut by stratified samples: cells that grow with their distance to the swept volume's surface,
/// two samples each.
///
/// "Lost" is the part of `before` outside the sweep that `after` lacks. A packing is compared with its own
/// uncut state, so holes of the packing do not count as lost. (This favours disjoint packings, a third of
/// which is holes.) For probes, the gap is measured from the exact cut to `after`, so holes count there.
/// @param before, after  the shape before and after the cut
/// @throws std::invalid_argument if a probe's radius is not positive, or nothing was swept.
[[nodiscard]] CutAccuracy MeasureCut(const Solid& solid, const CarvedShape& before, const CarvedShape& after,
                                     const SweptTool& swept, const AccuracyParams& params);

/// Deepest overlap of a ball with the swept volume, computed exactly; 0 if no ball overlaps.
[[nodiscard]] double MaxOverlap(std::span<const Ball> balls, const SweptTool& swept);

}  // namespace osteon::simulation
