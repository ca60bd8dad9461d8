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
};

/// A tool. T has its origin at the apex and +z along the feed; the spindle turns about T's z axis.
///
/// The balls are what meets bone; the first is the head (CuttingHead) where the tool cuts. Mass, centre of
/// mass and inertia are those of the real tool with its holder, which the balls do not show (tool_mass.h).
struct Tool {
  std::string name;
  std::vector<ToolBall> balls;
  double mass_kg{0.0};
  PlainVector3 center_of_mass_m{};  ///< in T
  PlainInertia inertia_kg_m2{};     ///< about the centre of mass, axes of T; zero: a point mass
};

/// Hemispherical reamer: one analytic ball for the head, its apex at T's origin, and a row of balls along -z
/// for the shaft. Its inertia is a point mass's; MakeReamer(ReamerParams) in tool_kinds.h knows better.
/// @param center_of_mass_m  of head and shaft together, in T
/// @throws std::invalid_argument where a size or the mass is not positive, the shaft is wider than the head,
/// or the centre of mass is not finite.
[[nodiscard]] Tool MakeReamer(double head_radius_m, double shaft_radius_m, double shaft_length_m,
                              double mass_kg, const Vector3& center_of_mass_m);

/// The largest cutting ball, null where the tool has none. Of several that are as large to within a
/// thousandth (the row of balls along a drill's flutes), the one that is farthest ahead.
[[nodiscard]] const ToolBall* CuttingHead(const Tool& tool);

/// How far its cutting balls reach from the spindle's axis: half the width of a hole that the tool drills.
[[nodiscard]] double CuttingReach(const Tool& tool);

/// Mean distance from the spindle's axis of a face that the whole tool cuts across, by area:
///
///     r_eff = ∫ r dA / ∫ dA     over the rings that the cutting balls sweep as the spindle turns
///
/// 2/3 of the reach where the tool cuts up to its axis. Zero without a cutting ball.
[[nodiscard]] double EffectiveCuttingRadius(const Tool& tool);

/// Which balls of a tool are meant.
enum class ToolPart : std::uint8_t { kAll, kCutting, kTouching };

/// Box around balls of a tool, in T; empty where there are none.
[[nodiscard]] Eigen::AlignedBox3d ToolBounds(const Tool& tool, ToolPart part = ToolPart::kAll);

}  // namespace osteon::simulation
