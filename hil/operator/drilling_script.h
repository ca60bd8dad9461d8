#pragma once

#include "hil/operator/hand_script.h"

namespace osteon::hil {

/// Parameters for drilling one hole. Depths and heights of the *tip* are measured from the site's centre,
/// which lies on the surface where the drill enters. start_height_m and retract_height_m are heights of the
/// head's centre, as in HandKey.
struct DrillingScriptParams {
  PlainPose X_WC{};             ///< site: centre of the circle where the drill enters, +z out of the bone
  double head_radius_m{0.002};  ///< radius of the ball at the drill's tip, which the hand guides
  double tool_yaw_rad{0.0};
  double seconds{10.0};  ///< >= 0.1
  double start_height_m{0.040};
  double retract_height_m{0.030};
  double depth_m{0.010};  ///< depth down to which the push has its full force; deeper, the force fades
  double push_force_N{60.0};
  double approach_force_N{10.0};
  int pecks{4};  ///< number of pushes, 1 … 50; between them the drill is withdrawn to clear its flutes
  double peck_height_m{0.0005};           ///< height of the withdrawn tip above the surface
  double hand_stiffness_N_per_m{2000.0};  ///< stiffness of the hand that will follow the script
  /// Largest speed of the targets; in a script that is too short for it, the motions are shorter.
  double max_target_m_per_s{0.2};
};

/// Makes a script that drills straight along the site's axis, in pecks of equal depth, and withdraws. Shares
/// of the time: 2 % grasp, 10 % approach until the tip meets the surface, 76 % pecks, 12 % withdrawal. Shares
/// of a peck: 25 % force ramp, 40 % push, 20 % motion out, 15 % motion back to the depth reached so far, at
/// the approach's force. The last peck has only ramp (25 %) and push (75 %); it breaks through if the bone is
/// thinner than depth_m.
///
/// During a push, as in MakeReamingScript, the target lies push_force / stiffness deeper than the peck's
/// depth, so the hand presses with the force limit. Beyond the peck's depth the force fades, which limits how
/// far a hand that breaks through plunges.
/// @throws std::invalid_argument, naming the parameter and what is accepted.
[[nodiscard]] HandScript MakeDrillingScript(const DrillingScriptParams& params);

}  // namespace osteon::hil
