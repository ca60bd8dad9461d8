#pragma once

#include "report/bone_shape.h"
#include "report/depth_buffer.h"
#include "report/png_file.h"

namespace osteon::report {

/// Size of a picture [px] and direction of view.
struct RenderParams {
  int width{860}, height{700};
  double tilt_rad{0.62};  ///< angle between the line of sight and the cup's axis
  double turn_rad{0.45};  ///< rotation of the line of sight about the cup's axis
  /// parts of the bone that are farther from the cup's centre may lie outside the picture
  double reach_in_cup_radii{3.2};
};

/// Makes a camera that looks obliquely into the cup, with the bone around it in view.
[[nodiscard]] Camera CupCamera(const simulation::Bone& bone, const RenderParams& params = {});

/// Draws a shaded picture of a bone's surface. Light comes from the upper left with soft shadows, crevices
/// are darker (horizon-based ambient occlusion), and the colour is that of the material just below the
/// surface. The picture is white if there is no surface.
/// @param bone  gives the position of the site and the colours of the materials
[[nodiscard]] Image RenderBone(const simulation::Bone& bone, const BoneMesh& mesh,
                               const MaterialMap& materials, const Camera& camera);

}  // namespace osteon::report
