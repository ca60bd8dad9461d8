#pragma once

#include <functional>

#include "simulation/surface/carved_field.h"

namespace osteon::surface {

/// Returns the material at a place of the uncut solid. Called from every thread that extracts.
using MaterialAt = std::function<std::uint8_t(Vec3)>;

struct ExtractOptions {
  /// true: vertices near a rim between old surface and cut are placed on the rim. false: on the zero of the
  /// interpolated field, as all other vertices.
  bool sharp_rims{true};
};

/// Makes the mesh of one brick: the dual surface of the cells -1 … 7.
///
/// Each patch of a cell (dual_cases.h) has one vertex. The vertex lies on the surface; if both fields are
/// zero in the cell, on the rim between both faces. A vertex on a rim is doubled, with one normal for each
/// face. Each cut edge that begins at a node of the brick has a quad. If vertices of the same cell and patch
/// are welded, the chunks of all bricks form a closed manifold mesh, for every field. Any number of threads
/// may extract while nobody carves.
/// @param chunk  receives the mesh; its memory is reused
void ExtractChunk(const CarvedField& field, BrickIndex brick, SurfaceChunk& chunk,
                  const ExtractOptions& options = {}, const MaterialAt& material = {});

}  // namespace osteon::surface
