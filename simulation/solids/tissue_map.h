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

/// A class of bone by its density. A class contains the bone below this density that is in no earlier class.
struct DensityClass {
  double below_kg_per_m3{std::numeric_limits<double>::infinity()};
  MaterialIndex material{0};
};

/// Density of bone as an image along the inward normal, as from a CT profile or a graded foam.
///
///     rows      depth below the shell's surface: row 0 at the surface, each further one row_step_m deeper
///     columns   place along `axis`: the first column at height first_column_m, the last at last_column_m,
///               evenly between; a single column applies everywhere
///
/// The density is interpolated bilinearly between samples, and constant beyond the first and the last column.
/// The image ends at the depth of its last row, (rows - 1) row_step_m. `classes` maps a density to a
/// material.
struct DensityImage {
  int rows{0}, columns{0};
  double row_step_m{0.0};
  std::vector<float> density_kg_per_m3;            ///< rows × columns, row by row
  PlainVector3 axis{Vector3::UnitZ()};             ///< unit, in G
  double first_column_m{0.0}, last_column_m{0.0};  ///< heights along the axis, from G's origin
  std::vector<DensityClass> classes;               ///< ascending; the last one includes all higher densities

  [[nodiscard]] double DepthOfLastRow_m() const { return (rows - 1) * row_step_m; }
  /// Density at this depth below the surface and this height along the axis.
  [[nodiscard]] double DensityAt(double depth_m, double height_m) const;
  [[nodiscard]] MaterialIndex MaterialAt(double depth_m, double height_m) const;
};

/// Tissue within one shell of a mesh. From the surface inwards: the layers, then the image, then the core.
/// Row 0 of the image lies at the surface, not below the layers, so the layers replace the image's first
/// rows.
struct ShellTissue {
  std::vector<TissueLayer> layers;
  MaterialIndex core{0};
  std::optional<DensityImage> image;

  /// True if all tissue is `core`, so that no depth is needed.
  [[nodiscard]] bool IsUniform() const { return layers.empty() && !image; }
  /// Material at a place. @param depth_m  depth below the shell's surface  @param p_m  the place, in G
  [[nodiscard]] MaterialIndex MaterialAt(double depth_m, const Vector3& p_m) const;
};

/// The lining of a cup: layers that replace the shell's own on a part of the outermost shell. This part lies
/// within `lining_radii` times the cup's radius of the cup's centre, not above the cup's opening, and faces
/// the centre.
struct LiningTissue {
  CutSite cup;
  double lining_radii{1.25};
  std::vector<TissueLayer> layers;
  MaterialIndex core{0};

  /// Whether the lining covers a surface point.
  /// @param p_m  the point  @param normal  outward normal there, of any length
  [[nodiscard]] bool Covers(const Vector3& p_m, const Vector3& normal) const;
  [[nodiscard]] MaterialIndex MaterialAt(double depth_m) const;
};

/// Material at each place of a solid that a mesh bounds.
struct TissueMap {
  /// Element 0 is the tissue within the solid's outer surface. The following elements are those of the
  /// regions (LoadedMesh::regions), in their order. The last element is used for all regions beyond the list.
  std::vector<ShellTissue> shells{ShellTissue{}};
  std::optional<LiningTissue> lining;
};

/// @throws std::invalid_argument naming the part, its value and what is accepted: thicknesses of 0 … 100 mm,
///   materials below `material_count`, at least one shell, an image whose size, steps, densities and classes
///   fit together, lining_radii of 1 … 2.
void CheckTissueMap(const TissueMap& map, std::size_t material_count);

}  // namespace osteon::simulation
