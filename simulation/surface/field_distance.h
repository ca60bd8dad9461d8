#pragma once

#include <memory>

#include "simulation/surface/carved_field.h"

namespace osteon::surface {

/// The state of a carved bone at one time. Other threads than the carving one can read it.
struct CarvedSnapshot {
  std::shared_ptr<const SolidField> solid;  ///< null: no state is known
  std::shared_ptr<const BrickField> swept;
};

/// Signed distance [mm] of the carved bone at a place; negative in bone, limited to 3 voxels on either side.
///
///     max(solid, swept)      solid: negative in bone; swept: positive where the tool has been
///
/// Both fields are interpolated between the eight nodes around the place before the maximum is taken, so that
/// the rim between their surfaces stays sharp. Near a smooth face with radii of curvature R1 and R2 the error
/// is at most h²/8 (1/R1 + 1/R2), for voxels of edge h. Outside the grid there is air, and the result is 3
/// voxels.
[[nodiscard]] float CarvedDistance(const BrickLayout& layout, const BrickField& solid,
                                   const BrickField& swept, Vec3 p_mm);

/// Whether two carved bones have the same values at all nodes of a brick and its neighbours. If so, their
/// surfaces in this brick are equal. False if they lie in different grids. @pre other.solid is not null
[[nodiscard]] bool SameAround(const CarvedField& field, const CarvedSnapshot& other, BrickIndex brick);

}  // namespace osteon::surface
