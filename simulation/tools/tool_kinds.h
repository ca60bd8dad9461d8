#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "simulation/tool.h"
#include "simulation/tools/tool_fit.h"
#include "simulation/tools/tool_mass.h"
#include "simulation/tools/tool_profile.h"

// The kinds of tool, each from the few sizes that a catalogue gives. Lengths run from the apex back.

namespace osteon::simulation {

/// What joins a tool to the robot's flange: a cylinder behind it that has mass and touches nothing.
struct HolderParams {
  double radius_m{0.0315};
  double length_m{0.025};
  double density_kg_per_m3{7900.0};
};

/// How the balls of a turned tool are fitted to it: what may be left between its surface and their union.
struct BallParams {
  std::size_t greatest_count{64};
  double cutting_gap_m{0.05e-3};
  double touching_gap_m{0.3e-3};
};

struct BuiltTool {
  Tool tool;
  double length_m{0.0};                          ///< from the apex to the holder's back
  std::shared_ptr<const ToolProfile> profile{};  ///< what the balls were fitted to; null where they are exact
};

/// A dome with teeth on a straight shaft.
///
///     mass = shell (hemisphere, thickness) + shaft (cylinder from the dome's base plane) + holder
struct ReamerParams {
  double diameter_m{0.050};
  double shell_m{0.002};
  double shaft_radius_m{0.008};
  double shaft_length_m{0.130};     ///< from the dome's base plane to the holder
  double touching_length_m{0.120};  ///< of the shaft's balls, from one diameter behind the apex
  double density_kg_per_m3{7900.0};
  HolderParams holder{};
};
/// @throws std::invalid_argument naming the size, its value and what is accepted; so do the others.
[[nodiscard]] BuiltTool MakeReamer(const ReamerParams& params);

enum class BurrShape : std::uint8_t {
  kRound,         ///< one analytic ball
  kPear,          ///< a ball ahead, narrowing to the neck along the tangent cone
  kCylinder,      ///< round end
  kTaper,         ///< a small ball ahead, widening along the tangent cone (fissure burr, round end)
  kFlatCylinder,  ///< flat end, sharp edge: what takes most balls
};

/// Head (cuts), with a cone of 20 degrees at its back down to the neck; neck, another such cone where the
/// shank is wider, shank (they touch).
struct BurrParams {
  BurrShape shape{BurrShape::kRound};
  double diameter_m{0.0023};   ///< of the head
  double head_length_m{0.0};   ///< up to the cone at its back; a round one has its own
  double tip_diameter_m{0.0};  ///< of a taper's ball
  double neck_diameter_m{0.0013};
  double neck_length_m{0.004};
  double shank_diameter_m{0.00235};
  double length_m{0.0445};  ///< of all
  double density_kg_per_m3{7900.0};
  BallParams balls{};
  HolderParams holder{};
};
[[nodiscard]] BuiltTool MakeBurr(const BurrParams& params);

/// A cone of the point's angle, flutes (both cut), and a shank of the same diameter (touches). The flutes are
/// taken as a full cylinder: it is what their edges sweep.
struct TwistDrillParams {
  double diameter_m{0.0032};
  double point_rad{2.0594885173533086};  ///< full angle, 118 deg
  double flute_length_m{0.036};          ///< with the point
  double length_m{0.065};                ///< of all
  double flute_metal_ratio{0.6};         ///< share of the fluted cross-section that is metal
  double flute_gap_m{0.384e-3};          ///< as in BallParams, of the flutes; the point has its cutting_gap_m
  double density_kg_per_m3{7900.0};
  BallParams balls{.greatest_count = 64, .cutting_gap_m = 0.128e-3, .touching_gap_m = 0.8e-3};
  HolderParams holder{};
};
[[nodiscard]] BuiltTool MakeTwistDrill(const TwistDrillParams& params);

/// Any other turned tool: balls fitted to its outline.
/// @param first  balls that it begins with, such as an analytic head
[[nodiscard]] BuiltTool MakeTurnedTool(const std::string& name, std::vector<ProfilePiece> pieces,
                                       double density_kg_per_m3, const BallParams& balls,
                                       const HolderParams& holder, const std::vector<ToolBall>& first = {});

// What the builders share.

/// @throws std::invalid_argument naming the figure, its value and what is accepted.
void CheckBallsAndHolder(const std::string& name, const BallParams& balls, const HolderParams& holder,
                         double density_kg_per_m3);

/// A tool without mass by FitTool, with room for what lies between the samples; more samples where the tool
/// needs more balls.
/// @param sample  gives so many samples of the surface, or some more
/// @throws std::invalid_argument where the balls do not suffice for the samples' gaps.
[[nodiscard]] Tool FitBalls(const std::string& name, const Solid& solid,
                            const std::function<std::vector<SurfaceSample>(std::size_t count)>& sample,
                            const std::vector<ToolBall>& first, std::size_t greatest_count);

}  // namespace osteon::simulation
