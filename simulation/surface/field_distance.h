#pragma once

#include <memory>

#include "simulation/surface/carved_field.h"

namespace osteon::surface {

/// What a carved bone was at one time, for threads that do not carve it.
struct CarvedSnapshot {
  std::shared_ptr<const SolidField> solid;  ///< null: nothing is known
  std::shared_ptr<const BrickField> swept;
};

/// Signed distance [mm] of the carved bone at a place; negative in bone, limited to 3 voxels on either side.
///
///     max(solid, swept), each interpolated between its eight nodes: a rim stays sharp
///
/// Off by at most h²/8 (1/R1 + 1/R2) beside a face of radii R1 and R2, for voxels of h. Beyond the grid there
/// is air.
[[nodiscard]] float CarvedDistance(const BrickLayout& layout, const BrickField& solid,
                                   const BrickField& swept, Vec3 p_mm);

/// Whether two carved bones are the same at every node that a brick's chunk depends on. False where they lie
/// in different grids.
[[nodiscard]] bool SameAround(const CarvedField& field, const CarvedSnapshot& other, BrickIndex brick);

}  // namespace osteon::surface
