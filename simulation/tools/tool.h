#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// One ball of a tool, in T. Cutting balls remove bone; the others (the shaft) only touch it.
struct ToolBall {
  PlainVector3 center_m;
  double radius_m{0.0};
  bool cutting{true};
  /// For a cutting ball: number of edges that pass each place of its surface in one turn (a twist drill:
  /// two). 0: not known; the edges' own work is then part of the specific cutting energy.
  std::uint8_t edges{0};
};

/// A tool. T has its origin at the apex and +z along the feed; the spindle turns about T's z axis.
///
/// Only the balls touch bone. The head of a tool is its largest cutting ball (CuttingHead). Mass, centre of
/// mass and inertia are those of the real tool with its holder, which the balls do not include (tool_mass.h).
struct Tool {
  std::string name;
  std::vector<ToolBall> balls;
  double mass_kg{0.0};
  PlainVector3 center_of_mass_m{};  ///< in T
  PlainInertia inertia_kg_m2{};     ///< about the centre of mass, axes of T; zero: a point mass
};

/// Makes a hemispherical reamer: one analytic ball for the head, its apex at T's origin, and a row of balls
/// along -z for the shaft. Its inertia is that of a point mass; MakeReamer(ReamerParams) in tool_kinds.h
/// computes it from the shape.
/// @param center_of_mass_m  centre of mass of head and shaft together, in T
/// @throws std::invalid_argument if a size or the mass is not positive, the shaft is wider than the head, or
///   the centre of mass is not finite.
[[nodiscard]] Tool MakeReamer(double head_radius_m, double shaft_radius_m, double shaft_length_m,
                              double mass_kg, const Vector3& center_of_mass_m);

/// The largest cutting ball; null if no ball cuts. Of balls whose radii differ by less than a thousandth (as
/// in the row along a drill's flutes), the foremost one.
[[nodiscard]] const ToolBall* CuttingHead(const Tool& tool);

/// The largest number of edges of any cutting ball; 0 if it is not known.
[[nodiscard]] int CuttingEdges(const Tool& tool);

/// Largest distance of the cutting balls' surfaces from the spindle's axis: half the width of a hole that the
/// tool drills.
[[nodiscard]] double CuttingReach(const Tool& tool);

}  // namespace osteon::simulation
