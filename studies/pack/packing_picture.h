#pragma once

#include <functional>
#include <optional>
#include <span>

#include "report/depth_buffer.h"
#include "report/png_file.h"

namespace osteon::app {

/// The half-space that is cut away, (p - point)·normal > 0. In G.
struct CutAway {
  Vector3 point{Vector3::Zero()}, normal{Vector3::UnitZ()};
};

/// The plane that shows most of a packing: through its middle, across its thinnest extent; through the site's
/// axis if there is a site.
[[nodiscard]] CutAway MiddlePlane(const simulation::Bone& bone);

/// A camera that sees that plane from the side that is cut away, from a little above, all of the packing in
/// view.
[[nodiscard]] Camera PackingCamera(const simulation::Bone& bone, const CutAway& plane, int width, int height);

/// The colour (sRGB 0 … 1) of ball i at a place on its surface, or in the plane that cuts the ball. Called
/// from several threads.
using BallColor = std::function<Vector3(std::size_t i, const Vector3& p_G)>;

/// Draws a shaded picture of the balls, each exact to the pixel. Parts in the half-space that is cut away are
/// left out, and balls that the plane passes through show their inside, flat, with a darker rim.
[[nodiscard]] Image RenderPacking(std::span<const simulation::Ball> balls, const Camera& camera,
                                  const std::optional<CutAway>& cut, const BallColor& color, int threads = 0);

/// Viridis, from dark violet (0) to yellow (1); sRGB.
[[nodiscard]] Vector3 Viridis(double share);

}  // namespace osteon::app
