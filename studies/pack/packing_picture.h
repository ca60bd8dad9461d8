#pragma once

#include <functional>
#include <optional>
#include <span>

#include "report/depth_buffer.h"
#include "report/png_file.h"
#include "simulation/bone/bone.h"

namespace osteon::studies {

/// The half-space (p - point)·normal > 0 that a picture leaves out, in G, the geometry's frame.
struct CutAway {
  Vector3 point{Vector3::Zero()}, normal{Vector3::UnitZ()};
};

/// The plane in which a packing shows most of its balls: through the packing's middle, normal to its thinnest
/// extent. If the bone has a cut site, the plane passes through the site's axis.
[[nodiscard]] CutAway MiddlePlane(const simulation::Bone& bone);

/// A camera that looks at the plane of a CutAway from the side that is left out, from a little above, with
/// the whole packing in view.
[[nodiscard]] report::Camera PackingCamera(const simulation::Bone& bone, const CutAway& plane, int width,
                                           int height);

/// The colour (sRGB 0 … 1) of ball i at a place on its surface, or in the plane that cuts the ball. Called
/// from several threads.
using BallColor = std::function<Vector3(std::size_t i, const Vector3& p_G)>;

/// Draws a shaded picture of the balls, each exact to the pixel. Parts in the half-space `cut` are left
/// out, and balls that its plane passes through show their inside, flat, with a darker rim.
[[nodiscard]] report::Image RenderPacking(std::span<const simulation::Ball> balls,
                                          const report::Camera& camera, const std::optional<CutAway>& cut,
                                          const BallColor& color, int threads = 0);

/// Viridis, from dark violet (0) to yellow (1); sRGB.
[[nodiscard]] Vector3 Viridis(double share);

}  // namespace osteon::studies
