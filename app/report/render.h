#pragma once

#include "app/report/bone_shape.h"
#include "app/report/depth_buffer.h"
#include "app/report/png_file.h"

namespace osteon::app {

struct RenderParams {
  int width{860}, height{700};
  double tilt_rad{0.62};           ///< of the view against the cup's axis
  double turn_rad{0.45};           ///< of the view around the cup's axis
  double reach_in_cup_radii{3.2};  ///< what is farther from the cup's centre need not fit into the picture
};

/// A view obliquely into the cup that holds the bone around it.
[[nodiscard]] Camera CupCamera(const simulation::Bone& bone, const RenderParams& params = {});

/// Shaded picture of the balls as bone. The depth buffer's bumps are taken out by fitting a plane to each
/// pixel's neighbourhood, edges kept; light from the upper left with a soft shadow, crevices darker
/// (horizon-based), colour by the material of the nearest mass point. White where there is no bone.
[[nodiscard]] Image RenderBone(const simulation::Bone& bone, std::span<const simulation::Ball> balls,
                               const MaterialMap& materials, const Camera& camera);

}  // namespace osteon::app
