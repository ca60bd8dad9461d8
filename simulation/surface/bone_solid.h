#pragma once

#include <memory>

#include "simulation/bone/bone.h"
#include "simulation/solids/solid.h"
#include "simulation/surface/dual_surface.h"
#include "simulation/surface/solid_field.h"

namespace osteon::surface {

/// Samples the solid that a bone was packed from, on a grid over its bounds.
[[nodiscard]] std::shared_ptr<const SolidField> SampleSolid(const simulation::Solid& solid, float voxel_mm);

/// Returns the solid's tissue as a function of the place, for ExtractChunk. A mesh with layers takes about a
/// microsecond per vertex.
[[nodiscard]] MaterialAt TissueOf(std::shared_ptr<const simulation::Solid> solid);

/// Makes the union of a bone's balls, if the solid that they were packed from is not known. Single balls are
/// visible in this surface. Smoothing it, as by a ball rolled over it, would also hide true gaps that are
/// narrower than that ball.
/// @throws std::invalid_argument if there are no balls (MakeLayout)
[[nodiscard]] std::shared_ptr<const SolidField> UnionOfBalls(const simulation::Bone& bone, float voxel_mm);

/// SampleSolid of the solid that a bone was packed from; UnionOfBalls where it is not known.
/// @param solid  null: not known
[[nodiscard]] std::shared_ptr<const SolidField> FieldOfBone(const simulation::Solid* solid,
                                                            const simulation::Bone& bone, float voxel_mm);

}  // namespace osteon::surface
