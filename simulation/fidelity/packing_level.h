#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/fidelity/removal_error.h"
#include "simulation/solids/cut_zone.h"

// How fine a bone is packed, as one length: the lattice's spacing. All other sizes follow from it.

namespace osteon::simulation {

enum class PackingKind : std::uint8_t {
  kUniform,  ///< the whole bone alike
  kGraded,   ///< fine where it is cut, coarser below
  kSplit,    ///< graded, with few large balls that are split when a tool touches them
};

/// "uniform", "graded", "split".
[[nodiscard]] std::string_view KindName(PackingKind kind);

struct PackingLevel {
  PackingKind kind{PackingKind::kGraded};
  PackingFineness fine;
  double zone_depth_m{0.0};  ///< depth below the cut zone down to which the packing is fine
  double corner_m{0.0};      ///< further depth that is fine: corners of coarser cells reach up to there
};

/// Depth below the scene's zone that the cut reaches: for a cup the depth of its face, for a path the excess
/// of the tool's radius over the zone's.
/// @param zone_radius_m  of a path; 0 for a cup
[[nodiscard]] double ZoneDepthFor(const CutShape& cut, double zone_radius_m);

/// Makes a level from its spacing a.
///
///     uniform, graded    r as asked for, 1.2 a … 2.4 a; half the wall at most
///     split              parents of 0.9 a, 24 children each; the surface's own balls 0.48 a
///     all                gap at the surface 0.027 a (split: 0.06 a)
///     into the bone      fine by a/2 more, or the error steps up by a third where the cells turn coarse
[[nodiscard]] PackingLevel MakeLevel(PackingKind kind, double spacing_m, double radius_over_spacing,
                                     const CutShape& cut, double zone_depth_m);

/// The same level with `factor` times its spacing.
[[nodiscard]] PackingLevel Scaled(const PackingLevel& level, double factor, const CutShape& cut);

/// True where the level's balls are at most half the wall and its lattice has no holes.
[[nodiscard]] bool FitsWall(const PackingLevel& level, const CutShape& cut);

/// True where the closed forms hold for the level: r <= 0.6 R (R/5 in a cut along the surface), a split
/// lattice's spacing <= 0.75 R (and 0.85 of the depth of a cut along the surface), and the level fits the
/// wall.
[[nodiscard]] bool IsInValidRange(const PackingLevel& level, const CutShape& cut);

/// Finds the coarsest level whose predicted removal error is at most `error_m` and for which the closed forms
/// hold, with spacings from 0.02 to 20 mm. Large balls leave a finer face, small balls a finer rim, so radii
/// from 1.2 a to 2.4 a (1.5 a in a cut that leads into the bone) are tried, and the level with the widest
/// spacing is taken.
/// @returns nothing where even the finest level exceeds the error.
[[nodiscard]] std::optional<PackingLevel> CoarsestLevel(PackingKind kind, double error_m, const CutShape& cut,
                                                        double zone_depth_m);

/// Packs a solid with the level's balls. @throws std::invalid_argument as the packings do.
[[nodiscard]] std::vector<Ball> PackLevel(const PackingLevel& level, const Solid& solid, const CutZone& zone);

/// The engine's parameters for a level: without splitting, or with a pool for all balls that the cut touches
/// and half as many more.
[[nodiscard]] CuttingParams CuttingForLevel(const PackingLevel& level, const CutShape& cut,
                                            const CuttingParams& cutting);

/// Expected number of children that a whole cut makes of a level's balls; 0 where none is split.
[[nodiscard]] double ExpectedChildren(const PackingLevel& level, const CutShape& cut);

/// Volume and surface of a solid by depth below a zone, from cells of a sixtieth of its size: to about 5 %.
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
