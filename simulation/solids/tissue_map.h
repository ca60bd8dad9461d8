#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "simulation/bone/bone.h"

namespace osteon::simulation {

/// A layer of tissue below a shell's surface.
struct TissueLayer {
  MaterialIndex material{0};
  double thickness_m{0.0};
};

/// One class of bone by its density: bone below this density that is not in an earlier class.
struct DensityClass {
  double below_kg_per_m3{std::numeric_limits<double>::infinity()};
  MaterialIndex material{0};
};

/// Density of bone as an image along the inward normal, as from a CT profile or a graded foam.
///
///     rows      depth below the shell's surface: row 0 at the surface, each further one row_step_m deeper
///     columns   place along `axis`: the first column at height first_column_m, the last at last_column_m,
///               evenly between; one column alone is the density everywhere
///
/// The density is bilinear between samples, and constant before the first and behind the last column. The
/// image ends at the depth of its last row, (rows - 1) row_step_m. `classes` map the density to a material.
struct DensityImage {
  int rows{0}, columns{0};
  double row_step_m{0.0};
  std::vector<float> density_kg_per_m3;            ///< rows × columns, row by row
  PlainVector3 axis{Vector3::UnitZ()};             ///< unit, in G
  double first_column_m{0.0}, last_column_m{0.0};  ///< heights along the axis, from G's origin
  std::vector<DensityClass> classes;               ///< ascending; the last one includes all higher densities

  [[nodiscard]] double DepthOfLastRow_m() const { return (rows - 1) * row_step_m; }
  /// At this depth below the surface and this height along the axis.
  [[nodiscard]] double DensityAt(double depth_m, double height_m) const;
  [[nodiscard]] MaterialIndex MaterialAt(double depth_m, double height_m) const;
};

/// Tissue within one shell of a mesh. Inwards from its surface: the layers, then the image, then the core.
/// The image's row 0 lies at the surface as well, so layers cover its beginning.
struct ShellTissue {
  std::vector<TissueLayer> layers;
  MaterialIndex core{0};
  std::optional<DensityImage> image;

  /// True where everything is `core`, so that no depth is needed.
  [[nodiscard]] bool IsUniform() const { return layers.empty() && !image; }
  /// @param depth_m below the shell's surface  @param p_m the place, in G
  [[nodiscard]] MaterialIndex MaterialAt(double depth_m, const Vector3& p_m) const;
};

/// The lining of a cup: other layers where the surface of the outermost shell lies within `lining_radii` cup
/// radii of the cup's centre, not above its opening, and faces the centre.
struct LiningTissue {
  CutSite cup;
  double lining_radii{1.25};
  std::vector<TissueLayer> layers;
  MaterialIndex core{0};

  /// @param p_m nearest point of the surface  @param normal outward there, of any length
  [[nodiscard]] bool Covers(const Vector3& p_m, const Vector3& normal) const;
  [[nodiscard]] MaterialIndex MaterialAt(double depth_m) const;
};

/// Material at each place of a solid that a mesh bounds.
struct TissueMap {
  /// [0] is the tissue within the solid's outer surface, followed by one for each region
  /// (LoadedMesh::regions), in their order; the last one is used for regions without their own.
  std::vector<ShellTissue> shells{ShellTissue{}};
  std::optional<LiningTissue> lining;
};

/// @throws std::invalid_argument naming the part, its value and what is accepted: thicknesses of 0 … 100 mm,
///   materials below `material_count`, one shell and more, an image whose size, steps, densities and classes
///   fit together, lining_radii of 1 … 2.
void CheckTissueMap(const TissueMap& map, std::size_t material_count);

}  // namespace osteon::simulation
