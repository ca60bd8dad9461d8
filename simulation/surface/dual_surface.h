#pragma once

#include <functional>

#include "simulation/surface/carved_field.h"

namespace osteon::surface {

/// Material at a place of the uncut solid. Called from several threads where several extract.
using MaterialAt = std::function<std::uint8_t(Vec3)>;

struct ExtractOptions {
  bool sharp_rims{true};  ///< vertices on the rim between old surface and cut; else on the nearer of the two
};

/// Makes the mesh of one brick: the dual surface of the cells -1 … 7.
///
/// Each patch of a cell (dual_cases.h) has one vertex, on the field; where both fields cross in the cell, on
/// the rim. A rim's vertex is doubled, with one normal for each face. Each cut edge that begins at a node of
/// the brick has a quad. Chunks of all bricks, welded by cell and patch, are closed and manifold for every
/// field. Any number of threads may extract while nobody carves.
/// @param chunk  replaced; its memory is used again
void ExtractChunk(const CarvedField& field, BrickIndex brick, SurfaceChunk& chunk,
                  const ExtractOptions& options = {}, const MaterialAt& material = {});

}  // namespace osteon::surface
