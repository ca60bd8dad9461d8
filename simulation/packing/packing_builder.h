#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/packing/graded_cells.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Largest number of balls of a packing: 7 GB if each ball is stored with its foot on the surface.
inline constexpr std::size_t kMaxBalls = 100'000'000;

/// Fineness of a packing. The defaults give about 30 000 balls in the default acetabulum.
struct PackingParams {
  /// Body-centred lattice: spacing of the finest level, and the smallest depth of each coarser level. Each
  /// level doubles the spacing.
  GradeParams lattice{.finest_m = 1.5e-3, .coarser_from_m = {6.5e-3, 12e-3}};
  double cup_radius_cap_m{3.0e-3};  ///< largest radius of balls that reach up to cup_depth_m below the cup
  double cup_depth_m{4.0e-3};       ///< depth below the cup down to which cup_radius_cap_m applies
  /// Largest radius of all other balls, over the spacing; from 0.56 on, a lattice has no holes
  double radius_over_spacing{1.2};
  /// Growth of the cap with the depth of a ball's centre below the cut zone, 0 … 1. If it has a value, the
  /// cap is cup_radius_cap_m + radius_growth × depth; cup_depth_m and radius_over_spacing are not used.
  std::optional<double> radius_growth;
  double min_radius_m{0.15e-3};  ///< smallest radius of the balls that touch the surface

  /// Largest gap between the surface and the union of the balls, at the surface samples: its value near the
  /// cup, its growth with depth below the finest level, and its upper limit.
  double surface_gap_m{0.04e-3};
  double surface_gap_growth{0.08};
  double max_surface_gap_m{0.5e-3};
  /// Spacing of the surface samples.
  GradeParams samples{.finest_m = 0.25e-3, .coarser_from_m = {5.5e-3, 12e-3}};

  std::size_t count{0};   ///< wanted number of balls; 0: as many as the gap's tolerances need
  std::uint64_t seed{0};  ///< moves the surface samples
  int threads{0};         ///< 0: one per core; the result does not depend on it

  /// Spacing of the lattice at this depth below the cut zone.
  [[nodiscard]] double SpacingAt(double depth_m) const;
  /// Cap: largest radius of a ball whose centre lies at this depth, in a lattice of this spacing.
  [[nodiscard]] double RadiusCapAt(double depth_m, double spacing_m) const;
  /// Largest accepted gap at a surface point of this depth.
  [[nodiscard]] double SurfaceGapAt(double depth_m) const;
};

/// Wanted properties of an overlapping packing. For a property of 0, a value that suits the solid is chosen.
struct OverlapOptions {
  std::size_t count{0};      ///< wanted number of balls; 0: as many as a surface gap of 0.04 mm needs
  double min_radius_m{0.0};  ///< smallest radius
  double max_radius_m{0.0};  ///< r0: cap on the radius at the cut zone; 0: as large as fits
  double grade{0.0};         ///< a: the cap is r0 + a·depth below the cut zone; 0: uniform
  std::uint64_t seed{0};     ///< moves the surface samples
  int threads{0};            ///< 0: one per core; the result does not depend on it
};

/// Parameters for BuildPacking that meet the options on this solid. The spacings of lattice and samples
/// follow from the solid's surface and volume (measured coarsely), the wanted number of balls, and the caps.
/// @throws std::invalid_argument naming the option, its value and what is accepted.
[[nodiscard]] PackingParams OverlapParamsFor(const Solid& solid, const CutZone& zone,
                                             const OverlapOptions& options);

/// Fills a solid with overlapping balls, none of which leaves it.
///
/// 1. Lattice: a ball at each point of a body-centred lattice that is at least 0.9 times the cap from the
///    surface, radius = min(cap, distance to the surface). The spacing doubles at the depths that
///    PackingParams::lattice gives. Balls that a reamer can reach are limited in radius, because a cut
///    removes more of a larger ball.
/// 2. Surface: a lattice leaves scallops at the surface. Each sample of the surface has the largest ball that
///    touches the surface there from inside. These balls are added one by one, each at the sample with the
///    largest gap relative to its tolerance (CoverSurface), until no gap is above its tolerance or the wanted
///    number of balls is reached.
///
/// The result depends on the arguments alone. It is sorted along a Morton curve.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<Ball> BuildPacking(const Solid& solid, const CutZone& zone,
                                             const PackingParams& params);

}  // namespace osteon::simulation
