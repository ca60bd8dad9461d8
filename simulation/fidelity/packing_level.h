#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/fidelity/removal_error.h"
#include "simulation/solids/cut_zone.h"

// Levels of fineness of a packing. A level is given by one length, the spacing of the lattice; all other
// sizes of the packing follow from it.

namespace osteon::simulation {

enum class PackingKind : std::uint8_t {
  kUniform,  ///< the same fineness in the whole bone
  kGraded,   ///< fine where it is cut, coarser below
  kSplit,    ///< graded, and made of few large balls, each of which is split when a tool touches it
};

/// "uniform", "graded", "split".
[[nodiscard]] std::string_view KindName(PackingKind kind);

struct PackingLevel {
  PackingKind kind{PackingKind::kGraded};
  PackingFineness fine;
  double zone_depth_m{0.0};  ///< depth below the cut zone down to which the packing is fine
  double corner_m{0.0};      ///< additional depth that is packed finely, because corners of the coarser cells
                             ///< below reach up into it
};

/// Depth below the scene's cut zone that the cut reaches. For a cup: the depth of the cut's face. For a path:
/// the tool's radius less the zone's radius, at least 0.
/// @param zone_radius_m  radius of a path's zone; 0 for a cup
[[nodiscard]] double ZoneDepthFor(const CutShape& cut, double zone_radius_m);

/// Makes a level from the lattice's spacing a. r is the radius of its balls:
///
///     uniform, graded    r = radius_over_spacing a, clamped to 1.2 a … 2.4 a; at most half the wall
///     split              r = 0.9 a, 24 children for each ball; balls at the surface have 0.48 a
///
/// The gap at the surface is 0.027 a (split: 0.06 a). For uniform and graded cuts into the bone, the packing
/// is fine a/2 deeper: otherwise the error would rise by a third where the cells become coarser.
[[nodiscard]] PackingLevel MakeLevel(PackingKind kind, double spacing_m, double radius_over_spacing,
                                     const CutShape& cut, double zone_depth_m);

/// A level like this one, with a spacing that is `factor` times as wide.
[[nodiscard]] PackingLevel Scaled(const PackingLevel& level, double factor, const CutShape& cut);

/// True if the radius of the level's balls is at most half the wall's thickness, and its lattice has no
/// holes.
[[nodiscard]] bool FitsWall(const PackingLevel& level, const CutShape& cut);

/// True if the closed forms (removal_error.h) hold for the level. r is the balls' radius, R the tool's
/// radius. Uniform and graded: r <= 0.6 R, or R/5 in a cut along the surface. Split: spacing <= 0.75 R, and
/// in a cut along the surface also <= 0.85 of the cut's depth. Every level must fit the wall (FitsWall).
[[nodiscard]] bool IsInValidRange(const PackingLevel& level, const CutShape& cut);

/// Finds the coarsest level whose predicted removal error is at most `error_m` and for which the closed forms
/// hold. Spacings a from 0.02 to 20 mm are searched. Large balls leave a smoother face, small balls a cleaner
/// rim. So radii from 1.2 a to 2.4 a (1.5 a in a cut that leads into the bone) are tried, and the level with
/// the widest spacing is taken.
/// @returns nothing if even the finest level exceeds the error.
[[nodiscard]] std::optional<PackingLevel> CoarsestLevel(PackingKind kind, double error_m, const CutShape& cut,
                                                        double zone_depth_m);

/// Packs a solid with the level's balls. @throws std::invalid_argument as the packings do.
[[nodiscard]] std::vector<Ball> PackLevel(const PackingLevel& level, const Solid& solid, const CutZone& zone);

/// The engine's parameters for a level. For a split level, the pool has blocks for 1.5 times the balls that
/// the cut is expected to touch; for other levels, splitting is off.
[[nodiscard]] CuttingParams CuttingForLevel(const PackingLevel& level, const CutShape& cut,
                                            const CuttingParams& cutting);

/// Expected number of children that are made of a level's balls during the whole cut; 0 if the level is not a
/// split one.
[[nodiscard]] double ExpectedChildren(const PackingLevel& level, const CutShape& cut);

/// Volume and surface of a solid as a function of the depth below a zone, accurate to about 5 %. The solid is
/// divided into cells of a sixtieth of its longest side.
class DepthVolumes {
 public:
  DepthVolumes(const Solid& solid, const CutZone& zone);
  /// Expected number of PackLevel's balls, to within 50 %.
  [[nodiscard]] double ExpectedBalls(const PackingLevel& level) const;
  [[nodiscard]] double volume_m3() const;

 private:
  // Depth below the zone, distance inside the surface, and the volume and surface that the cell stands for.
  struct Cell {
    double depth_m, inside_m, volume_m3, area_m2;
  };
  std::vector<Cell> cells_;
};

}  // namespace osteon::simulation
