#pragma once

#include <functional>

#include "simulation/surface/carved_field.h"

namespace osteon::surface {

/// Returns the material at a place of the uncut solid. Called from every thread that extracts.
using MaterialAt = std::function<std::uint8_t(Vec3)>;

struct ExtractOptions {
  /// Places vertices on the rim between old surface and cut. False: on the interpolated field, as elsewhere.
  bool sharp_rims{true};
};

/// Makes the mesh of one brick: the dual surface of the cells -1 … 7.
///
/// Each patch of a cell (dual_cases.h) has one vertex. It lies on the surface, and on the rim where both
/// fields cross in the cell. A rim's vertex is doubled, with one normal for each face. Each cut edge that
/// begins at a node of the brick has a quad. Welded by cell and patch, the chunks of all bricks form a closed
/// manifold mesh for every field. Any number of threads may extract while nobody carves.
/// @param chunk  replaced; its memory is used again
void ExtractChunk(const CarvedField& field, BrickIndex brick, SurfaceChunk& chunk,
                  const ExtractOptions& options = {}, const MaterialAt& material = {});

}  // namespace osteon::surface
