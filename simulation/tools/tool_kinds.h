#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "simulation/tools/tool.h"
#include "simulation/tools/tool_compliance.h"
#include "simulation/tools/tool_fit.h"
#include "simulation/tools/tool_mass.h"
#include "simulation/tools/tool_profile.h"

// The kinds of tool, each from a few catalogue sizes. Lengths run from the apex back.

namespace osteon::simulation {

/// Part between the tool and the robot's flange: a cylinder behind the tool that has mass and touches
/// nothing.
struct HolderParams {
  double radius_m{0.0315};
  double length_m{0.025};
  double density_kg_per_m3{7900.0};
};

/// Limits for fitting balls to a turned tool: number of balls, and gaps between its surface and their union.
struct BallParams {
  std::size_t max_count{64};
  double cutting_gap_m{0.05e-3};
  double touching_gap_m{0.3e-3};
};

/// A tool, and what only its builder knows: length, outline, and the pieces that bend.
struct BuiltTool {
  Tool tool;
  double length_m{0.0};                          ///< from the apex to the holder's back
  std::shared_ptr<const ToolProfile> profile{};  ///< outline that the balls are fitted to; null: exact balls
  /// The pieces that bend between apex and holder (CantileverCompliance); empty for a mesh, whose pieces are
  /// not known.
  std::vector<BeamPiece> beam{};
  double load_point_m{0.0};  ///< distance behind the apex where bone pushes the tool aside: its head's centre
  double head_mass_kg{0.0};  ///< of the beam's rigid pieces
};

/// A dome with teeth on a straight shaft.
///
///     mass = shell (hemisphere, thickness) + shaft (cylinder from the dome's base plane) + holder
struct ReamerParams {
  double diameter_m{0.050};
  double shell_m{0.002};
  double shaft_radius_m{0.008};
  double shaft_length_m{0.130};     ///< from the dome's base plane to the holder
  double touching_length_m{0.120};  ///< length of the part with balls, from one diameter behind the apex
  double density_kg_per_m3{7900.0};
  HolderParams holder{};
};
/// Makes a reamer.
/// @throws std::invalid_argument naming the size, its value and what is accepted; so do the other kinds.
[[nodiscard]] BuiltTool MakeReamer(const ReamerParams& params);

enum class BurrShape : std::uint8_t {
  kRound,         ///< one analytic ball
  kPear,          ///< a ball at the tip, narrowing to the neck along the tangent cone
  kCylinder,      ///< round end
  kTaper,         ///< a small ball at the tip, widening along the tangent cone (fissure burr, round end)
  kFlatCylinder,  ///< flat end, sharp edge: needs the most balls
};

/// A burr's head cuts and has a cone of 20 degrees at its back down to the neck. Neck and shank only touch;
/// where the shank is wider than the neck, another such cone joins them.
struct BurrParams {
  BurrShape shape{BurrShape::kRound};
  double diameter_m{0.0023};   ///< of the head
  double head_length_m{0.0};   ///< up to the cone at its back; not used for a round head
  double tip_diameter_m{0.0};  ///< of a taper's ball
  double neck_diameter_m{0.0013};
  double neck_length_m{0.004};
  double shank_diameter_m{0.00235};
  double length_m{0.0445};  ///< of the whole burr
  double density_kg_per_m3{7900.0};
  BallParams balls{};
  HolderParams holder{};
};
[[nodiscard]] BuiltTool MakeBurr(const BurrParams& params);

/// A cone of the point's angle and flutes (both cut), and a shank of the same diameter (touches). The flutes
/// count as a full cylinder, because their edges sweep it.
struct TwistDrillParams {
  double diameter_m{0.0032};
  double point_rad{2.0594885173533086};  ///< full angle, 118 deg
  double flute_length_m{0.036};          ///< point included
  double length_m{0.065};                ///< of the whole drill
  double flute_metal_ratio{0.6};         ///< share of the fluted cross-section that is metal
  double flute_gap_m{0.384e-3};          ///< as in BallParams, for the flutes; cutting_gap_m is for the point
  double density_kg_per_m3{7900.0};
  BallParams balls{.max_count = 64, .cutting_gap_m = 0.128e-3, .touching_gap_m = 0.8e-3};
  HolderParams holder{};
};
[[nodiscard]] BuiltTool MakeTwistDrill(const TwistDrillParams& params);

/// Makes any other turned tool: balls fitted to its outline.
/// @param first  balls that the tool begins with, such as an analytic head
[[nodiscard]] BuiltTool MakeTurnedTool(const std::string& name, std::vector<ProfilePiece> pieces,
                                       double density_kg_per_m3, const BallParams& balls,
                                       const HolderParams& holder, const std::vector<ToolBall>& first = {});

// Functions that the builders share.

/// @throws std::invalid_argument naming the figure, its value and what is accepted.
void CheckBallsAndHolder(const std::string& name, const BallParams& balls, const HolderParams& holder,
                         double density_kg_per_m3);

/// Makes a tool without mass by FitTool, with a margin for the surface between the samples. The number of
/// samples grows with that of the balls.
/// @param sample  returns at least `count` samples of the surface
/// @throws std::invalid_argument where the balls do not suffice for the samples' gaps.
[[nodiscard]] Tool FitBalls(const std::string& name, const Solid& solid,
                            const std::function<std::vector<SurfaceSample>(std::size_t count)>& sample,
                            const std::vector<ToolBall>& first, std::size_t max_count);

}  // namespace osteon::simulation
