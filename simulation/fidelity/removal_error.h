#pragma once

// Closed forms for the error that a packing of overlapping balls causes in a cut. A ball that the tool has
// cut touches the face of the cut at one point. Between these points bone is missing:
//
//     gap at a distance x from the nearest point    x²/2 (1/r' + 1/R)
//     mean over a plane with s points per area      k/s (1/r' + 1/R),   k = 1/(2 π) = 0.159 for random points
//     points per area                               s = n × thickness of the layer of touched centres
//                                                   n = 2/a³ in a body-centred lattice
//
// r' is a ball's radius after the cut, R the tool's radius, a the lattice's spacing, n the number of centres
// per volume. Source of the form: docs/planning.md and the design's experiments on overlapping packings. The
// constants are fitted, and tests compare them with carved packings.

namespace osteon::simulation {

/// Shape of a cut, as the closed forms need it.
struct CutShape {
  double tool_radius_m{0.025};
  /// True: the face lies along the surface, `depth_m` below it (a reamed cup). False: the face leads into the
  /// bone (a hole, a trench).
  bool along_surface{false};
  double depth_m{0.0};
  /// Length of the edge at which the cut meets the bone's surface, divided by the cut's area.
  double rim_per_area_1_per_m{0.0};
  double area_m2{0.0};  ///< of the cut
  double wall_m{0.0};   ///< thinnest wall of the bone that is cut; 0: thick
};

/// Fineness of a packing in the region that is cut.
struct PackingFineness {
  double spacing_m{1.5e-3};       ///< of the body-centred lattice
  double radius_m{1.8e-3};        ///< largest radius of balls that the cut can reach
  double surface_gap_m{0.04e-3};  ///< largest gap between surface and balls before the cut
  int children{0};                ///< number of children of a split ball; 0: balls are not split, but shrink
};

/// The two parts of the mean depth of bone that is lost beyond the tool's sweep [m].
struct RemovalError {
  double face_m{0.0};  ///< between the points that touch the face
  double rim_m{0.0};   ///< at the edge, where balls of the surface are cut from the side
  [[nodiscard]] double total_m() const { return face_m + rim_m; }
};

/// Predicts the removal error. The prediction lies 45 % below to 20 % above the error of carved packings, as
/// long as the balls' radius is at most 0.6 R, the spacing of split balls at most 0.75 R, and no radius above
/// half the wall.
[[nodiscard]] RemovalError PredictRemovalError(const PackingFineness& fine, const CutShape& cut);

/// Number of points per area [1/m²] at which balls touch the face of a cut: how finely the packing resolves
/// the cut.
[[nodiscard]] double TangentDensity(const PackingFineness& fine, const CutShape& cut);

/// Mean depth to which a probe ball sinks into the face of a cut, where it rests on three of the face's s
/// points per area. The probe cannot fall through, because a lattice of radius 0.56 a and more has no holes.
///
///     k/s / (probe + r')
[[nodiscard]] double PredictLeak(const PackingFineness& fine, const CutShape& cut, double probe_radius_m);

/// Cogging of a ball of radius R that slides over an uncut face: its rms tangential force, divided by the
/// normal force. The ball's centre moves over caps of radius R + r that are l apart, with slopes up to
/// (l/2)/(R + r).
///
///     l / (√12 (R + r)),   l the mean distance of the surface's balls
[[nodiscard]] double PredictCogging(const PackingFineness& fine, double tool_radius_m);

}  // namespace osteon::simulation
