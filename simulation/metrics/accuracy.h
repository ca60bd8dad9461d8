#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulation/metrics/carved_shape.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/swept_tool.h"

namespace osteon::simulation {

/// How closely a cut is looked at.
struct AccuracyParams {
  std::vector<double> probe_radii_m{};  ///< of the balls that feel the cut; none larger than the tool's
  std::size_t surface_cells{
      60'000};                       ///< sampling cells along the cut: the standard error falls with its root
  std::size_t probe_samples{6'000};  ///< places that each probe is put to, at most
  double deepest_gap_m{3e-3};        ///< a probe that finds nothing so far below the cut is stopped
  std::uint64_t seed{0};             ///< of the samples
  int threads{0};                    ///< 0: one a core; the result does not depend on it
};

/// What a probe ball feels when it is put on the exact cut: how much farther it goes into the bone, along the
/// cut's normal, before it touches what is left.
struct ProbeGap {
  double radius_m{0.0};
  double mean_m{0.0}, p95_m{0.0}, max_m{0.0};
  std::size_t samples{0};
};

/// A cut against the exact volume that the tool's cutting surface has swept.
struct CutAccuracy {
  double cut_area_m2{0.0};       ///< of the swept volume's surface, within the solid
  double depth_error_m{0.0};     ///< bone lost beyond the swept volume, over the cut's area
  double depth_error_se_m{0.0};  ///< standard error of this estimate
  double lost_m3{0.0};           ///< bone lost beyond the swept volume
  double swept_volume_m3{0.0};   ///< of the solid, within the swept volume
  double left_volume_m3{0.0};    ///< of what is left within the swept volume
  double left_depth_m{0.0};      ///< how deep within the swept volume something was found, 0: nothing
  std::vector<ProbeGap> probes;  ///< one for each radius asked for

  /// What is left within the swept volume, over the cut's area; 0 where there is none.
  [[nodiscard]] double MeanLeft_m() const { return cut_area_m2 > 0.0 ? left_volume_m3 / cut_area_m2 : 0.0; }
};

/// Measures a cut by stratified samples: cells that grow with their distance to the swept volume's surface,
/// two samples each.
///
/// "Lost" is what was part of `before` and is not part of `after`, outside the sweep: a packing is held
/// against its own uncut self, so that holes of the packing count for nothing. (That flatters disjoint
/// packings, a third of which is holes.) A probe meets `after` and the exact cut, holes included.
/// @param before, after  the shape before and after the cut
/// @throws std::invalid_argument where a probe's radius is not positive, or nothing was swept.
[[nodiscard]] CutAccuracy MeasureCut(const Solid& solid, const CarvedShape& before, const CarvedShape& after,
                                     const SweptTool& swept, const AccuracyParams& params);

/// Deepest overlap of a ball with the swept volume, exact; 0 where none overlap.
[[nodiscard]] double GreatestOverlap(std::span<const Ball> balls, const SweptTool& swept);

}  // namespace osteon::simulation
