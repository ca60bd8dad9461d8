#pragma once

#include "hil/operator/hand_script.h"

namespace osteon::hil {

/// Parameters for opening a cavity with a burr, such as the access to a tooth's root canals. Depths of the
/// burr's *apex* are measured from the site's centre, which lies on the surface. start_height_m and
/// retract_height_m are heights of the head's centre, as in HandKey.
struct OpeningScriptParams {
  PlainPose X_WC{};  ///< the site: centre of its circle, +z out of the bone
  double head_radius_m{0.0008};
  double tool_yaw_rad{0.0};
  double seconds{10.0};  ///< >= 0.1
  double start_height_m{0.040};
  double retract_height_m{0.030};
  double site_radius_m{0.0016};  ///< the burr's edge widens the opening to this circle
  double depth_m{0.004};         ///< depth down to which the push has its full force; deeper, the force fades
  double push_force_N{4.0};      ///< along the axis
  double approach_force_N{1.5};
  double loop_period_s{0.8};
  int turns{3};                           ///< number of steps in which the loops widen and deepen, 1 … 50
  double hand_stiffness_N_per_m{2000.0};  ///< stiffness of the hand that will follow the script
  /// Largest speed of the targets; in a script that is too short for it, the motions are shorter.
  double max_target_m_per_s{0.2};
};

/// Makes a script that moves the burr down, then sideways in loops that widen while they deepen, then along
/// the widest circle at full depth, and out. Shares of the time: 2 % grasp, 13 % approach until the burr
/// meets the surface, 15 % straight in, 40 % widening and deepening in steps, 12 % along the circle, 8 % to
/// the axis, 10 % out.
///
/// Along the axis the hand pushes as in MakeReamingScript. Across the axis the hand's spring pulls the burr
/// toward the target, so the sideways force is the stiffness times the distance that is not yet cut, at most
/// stiffness × (site radius - head radius). A loop is never faster than max_target_m_per_s.
/// @throws std::invalid_argument, naming the parameter and what is accepted.
[[nodiscard]] HandScript MakeOpeningScript(const OpeningScriptParams& params);

}  // namespace osteon::hil
