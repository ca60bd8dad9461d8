#pragma once

#include <functional>
#include <optional>
#include <span>

#include "report/depth_buffer.h"
#include "report/png_file.h"
#include "simulation/bone/bone.h"

namespace osteon::studies {

/// The half-space (p - point)·normal > 0 that a picture leaves out, in the bone's frame G.
struct CutAway {
  Vector3 point{Vector3::Zero()}, normal{Vector3::UnitZ()};
};

/// The plane in which a packing shows most of its balls. It passes through the packing's middle, normal to
/// the thinnest extent. If the bone has a cut site, it passes through the site's axis.
[[nodiscard]] CutAway MiddlePlane(const simulation::Bone& bone);

/// A camera that looks at the plane of a CutAway from the half-space that is left out, from a little above.
/// The whole packing is in view.
[[nodiscard]] report::Camera PackingCamera(const simulation::Bone& bone, const CutAway& plane, int width,
                                           int height);

/// The colour (sRGB, 0 … 1) of ball i at a place on its surface or on its cut face. Called from several
/// threads.
using BallColor = std::function<Vector3(std::size_t i, const Vector3& p_G)>;

/// Draws a shaded picture of the balls, each exact to the pixel. Everything in the half-space `cut` is left
/// out. A ball that the plane cuts shows a flat face with a darker rim.
[[nodiscard]] report::Image RenderPacking(std::span<const simulation::Ball> balls,
                                          const report::Camera& camera, const std::optional<CutAway>& cut,
                                          const BallColor& color, int threads = 0);

/// Viridis, from dark violet (0) to yellow (1); sRGB.
[[nodiscard]] Vector3 Viridis(double share);

}  // namespace osteon::studies
