#pragma once

#include <string>
#include <vector>

namespace osteon::config {

/// A division of space that grows coarser with depth below the cup.
struct GradeConfig {
  double finest_m{0.0};
  std::vector<double>
      coarser_from_m;  ///< depth from which the spacing may double, and double again; ascending
};

/// A generated acetabulum: a block of bone with a hemispherical cup in its top face, as balls and mass
/// points.
struct SceneConfig {
  std::string name;
  // shape
  double width_m{0.0}, height_m{0.0};  ///< of the block
  double cup_radius_m{0.0};
  double cartilage_m{0.0}, subchondral_m{0.0};  ///< thickness of the layers below the cup
  // packing
  GradeConfig lattice;
  double cup_radius_cap_m{0.0};  ///< of the balls that reach up to cup_depth_m below the cup
  double cup_depth_m{0.0};
  double radius_over_spacing{0.0};  ///< caps the radius of the others
  double least_radius_m{0.0};
  double surface_gap_m{0.0};       ///< greatest gap between the surface and the balls' union near the cup,
  double surface_gap_growth{0.0};  ///< how it grows with depth,
  double greatest_surface_gap_m{0.0};  ///< and where that ends
  GradeConfig samples;                 ///< of the surface, where the gap is checked
  // mass points
  GradeConfig mass_points;
  int samples_along_axis{0};  ///< of a cell that the surface passes through
};

}  // namespace osteon::config
