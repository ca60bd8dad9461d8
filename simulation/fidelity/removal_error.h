#pragma once

// Closed forms for the error that a packing of overlapping balls causes in a cut. Each ball that the tool's
// face has passed touches the face at one point afterwards; bone is missing between these points:
//
//     gap at a distance x from the nearest point    x²/2 (1/r' + 1/R)
//     mean over a plane with s points to the area   k/s (1/r' + 1/R),   k = 1/(2 π) = 0.159 at random
//     points to the area                            s = n (a layer of centres)
//                                                   n = 2/a³ of a body-centred lattice
//
// r' is the radius that a ball has left, R the tool's radius. Source of the form: docs/planning.md and the
// design's experiments on overlapping packings. The constants are fitted, and tests compare them with carved
// packings.

namespace osteon::simulation {

/// Shape of a cut, as the closed forms need it.
struct CutShape {
  double tool_radius_m{0.025};
  /// True: the face lies along the surface, `depth_m` below it (a reamed cup). False: the face leads into the
  /// bone (a hole, a trench).
  bool along_surface{false};
  double depth_m{0.0};
  /// Length of the edge where the cut leaves the bone, over the cut's area.
  double rim_per_area_1_per_m{0.0};
  double area_m2{0.0};  ///< of the cut
  double wall_m{0.0};   ///< thinnest wall of the bone that is cut; 0: thick
};

/// Fineness of a packing where it is cut.
struct PackingFineness {
  double spacing_m{1.5e-3};       ///< of the body-centred lattice
  double radius_m{1.8e-3};        ///< largest radius of balls that the cut can reach
  double surface_gap_m{0.04e-3};  ///< largest gap between surface and balls before the cut
  int children{0};  ///< number of children of a ball that is split when touched; 0: balls shrink whole
};

/// Parts of the mean depth that is lost beyond the sweep [m].
struct RemovalError {
  double face_m{0.0};  ///< between the points that touch the face
  double rim_m{0.0};   ///< at the edge, where balls of the surface are cut from the side
  [[nodiscard]] double total_m() const { return face_m + rim_m; }
};

/// Predicts the removal error, within -45 … +20 % while radius <= 0.6 R, split balls' spacing <= 0.75 R, and
/// no ball is larger than half the wall.
[[nodiscard]] RemovalError PredictRemovalError(const PackingFineness& fine, const CutShape& cut);

/// Number of points per area that a cut leaves, 1/m²: how finely balls resolve it.
[[nodiscard]] double TangentDensity(const PackingFineness& fine, const CutShape& cut);

/// Mean depth to which a ball of this radius sinks between the points left on a cut, where it rests on three.
/// No ball leaks through: a lattice has no holes from radius 0.56 a on.
///
///     k/s / (probe + r')
[[nodiscard]] double PredictLeak(const PackingFineness& fine, const CutShape& cut, double probe_radius_m);

/// Effective tangential over normal force of a ball of radius R that slides over an uncut face (cogging). Its
/// centre moves over caps of radius R + r that are l apart, with slopes up to (l/2)/(R + r).
///
///     l / (√12 (R + r)),   l the mean distance of the surface's balls
[[nodiscard]] double PredictCogging(const PackingFineness& fine, double tool_radius_m);

}  // namespace osteon::simulation
