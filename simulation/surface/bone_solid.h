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

/// Makes the field of the union of a bone's balls, for a bone whose solid is not known. Single balls are
/// visible in its surface. The surface is not smoothed, as by rolling a ball over it: this would hide true
/// gaps that are narrower than the rolling ball.
/// @throws std::invalid_argument if there are no balls (MakeLayout)
[[nodiscard]] std::shared_ptr<const SolidField> UnionOfBalls(const simulation::Bone& bone, float voxel_mm);

/// Returns SampleSolid of the solid that a bone was packed from, or UnionOfBalls if the solid is not known.
/// @param solid  null: not known
[[nodiscard]] std::shared_ptr<const SolidField> FieldOfBone(const simulation::Solid* solid,
                                                            const simulation::Bone& bone, float voxel_mm);

}  // namespace osteon::surface
