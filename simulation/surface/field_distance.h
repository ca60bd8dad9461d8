#pragma once

#include <memory>

#include "simulation/surface/carved_field.h"

namespace osteon::surface {

/// State of a carved bone at one time, for threads that do not carve it.
struct CarvedSnapshot {
  std::shared_ptr<const SolidField> solid;  ///< null: nothing is known
  std::shared_ptr<const BrickField> swept;
};

/// Signed distance [mm] of the carved bone at a place; negative in bone, limited to 3 voxels on either side.
///
///     max(solid, swept), each interpolated between its eight nodes: a rim stays sharp
///
/// The error is at most h²/8 (1/R1 + 1/R2) beside a face with radii of curvature R1 and R2, for voxels of
/// edge h. Beyond the grid there is air.
[[nodiscard]] float CarvedDistance(const BrickLayout& layout, const BrickField& solid,
                                   const BrickField& swept, Vec3 p_mm);

/// Whether two carved bones are the same at every node that a brick's chunk depends on. False where they lie
/// in different grids.
[[nodiscard]] bool SameAround(const CarvedField& field, const CarvedSnapshot& other, BrickIndex brick);

}  // namespace osteon::surface
