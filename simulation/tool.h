#pragma once

#include <string>
#include <vector>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// One ball of a tool, in T. Cutting balls remove bone; the others (the shaft) only touch it.
struct ToolBall {
  PlainVector3 center_m;
  double radius_m{0.0};
  bool cutting{true};
};

/// A tool. T has its origin at the apex and +z along the feed; the spindle turns about T's z axis.
struct Tool {
  std::string name;
  std::vector<ToolBall> balls;
  double mass_kg{0.0};
  PlainVector3 center_of_mass_m;  ///< in T
};

/// Hemispherical reamer: one analytic ball for the head, its apex at T's origin, and a row of balls along -z
/// for the shaft.
/// @param center_of_mass_m  of head and shaft together, in T
/// @throws std::invalid_argument where a size or the mass is not positive, the shaft is wider than the head,
/// or the centre of mass is not finite.
[[nodiscard]] Tool MakeReamer(double head_radius_m, double shaft_radius_m, double shaft_length_m,
                              double mass_kg, const Vector3& center_of_mass_m);

}  // namespace osteon::simulation
