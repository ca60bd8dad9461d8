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

// Builders for kinds of tools, each from a few catalogue sizes. Lengths are measured from the apex back.

namespace osteon::simulation {

/// The holder between the tool and the robot's flange: a cylinder behind the tool that has mass, but no
/// balls.
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

/// A tool, with properties that Tool does not store: length, outline, and the pieces that bend.
struct BuiltTool {
  Tool tool;
  double length_m{0.0};  ///< from the apex to the holder's back
  /// Outline to which the balls are fitted; null: the balls are the exact shape
  std::shared_ptr<const ToolProfile> profile{};
  /// The pieces that bend between apex and holder (CantileverCompliance); empty for a mesh, whose pieces are
  /// not known.
  std::vector<BeamPiece> beam{};
  double load_point_m{0.0};  ///< distance behind the apex where bone pushes the tool aside: its head's centre
  double head_mass_kg{0.0};  ///< mass of the beam's rigid pieces
};

/// Sizes of a reamer: a dome with teeth on a straight shaft.
///
///     mass = shell (hemisphere, thickness) + shaft (cylinder from the dome's base plane) + holder
struct ReamerParams {
  double diameter_m{0.050};
  double shell_m{0.002};
  double shaft_radius_m{0.008};
  double shaft_length_m{0.130};  ///< from the dome's base plane to the holder
  /// Length of the shaft's part that has balls, starting one diameter behind the apex
  double touching_length_m{0.120};
  double density_kg_per_m3{7900.0};
  HolderParams holder{};
};
/// Makes a reamer.
/// @throws std::invalid_argument naming the size, its value and what is accepted. All builders below throw
///   this, too.
[[nodiscard]] BuiltTool MakeReamer(const ReamerParams& params);

enum class BurrShape : std::uint8_t {
  kRound,         ///< one analytic ball
  kPear,          ///< a ball at the tip and its tangent cone, which narrows towards the neck
  kCylinder,      ///< cylinder with a round end
  kTaper,         ///< a small ball at the tip and its tangent cone, which widens (fissure burr, round end)
  kFlatCylinder,  ///< cylinder with a flat end and a sharp edge: needs the most balls
};

/// Sizes of a burr. Its head cuts; at its back, a cone of 20 degrees leads to the neck. Neck and shank only
/// touch. If the shank is wider than the neck, another cone of 20 degrees joins them.
struct BurrParams {
  BurrShape shape{BurrShape::kRound};
  double diameter_m{0.0023};   ///< diameter of the head
  double head_length_m{0.0};   ///< length of the head up to the cone at its back; not used for a round head
  double tip_diameter_m{0.0};  ///< diameter of the ball at a taper's tip
  double neck_diameter_m{0.0013};
  double neck_length_m{0.004};
  double shank_diameter_m{0.00235};
  double length_m{0.0445};  ///< length of the whole burr
  double density_kg_per_m3{7900.0};
  BallParams balls{};
  HolderParams holder{};
};
[[nodiscard]] BuiltTool MakeBurr(const BurrParams& params);

/// Sizes of a twist drill: a conical point and flutes, which both cut, and a shank of the same diameter,
/// which only touches. The flutes are represented by a full cylinder, because their edges sweep it.
struct TwistDrillParams {
  double diameter_m{0.0032};
  double point_rad{2.0594885173533086};  ///< full angle of the point, 118 deg
  double flute_length_m{0.036};          ///< length of the flutes, including the point
  double length_m{0.065};                ///< length of the whole drill
  double flute_metal_ratio{0.6};         ///< share of the fluted cross-section that is metal
  double flute_gap_m{0.384e-3};  ///< accepted gap at the flutes; BallParams::cutting_gap_m is for the point
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

/// Checks the parameters. @throws std::invalid_argument naming the figure, its value and what is accepted.
void CheckBallsAndHolder(const std::string& name, const BallParams& balls, const HolderParams& holder,
                         double density_kg_per_m3);

/// Makes a tool without mass from balls that FitTool fits. The gaps have a margin for the surface between the
/// samples. The more balls the fit needs, the more samples are taken.
/// @param sample  returns at least `count` samples of the surface
/// @throws std::invalid_argument if the balls do not suffice for the samples' gaps.
[[nodiscard]] Tool FitBalls(const std::string& name, const Solid& solid,
                            const std::function<std::vector<SurfaceSample>(std::size_t count)>& sample,
                            const std::vector<ToolBall>& first, std::size_t max_count);

}  // namespace osteon::simulation
