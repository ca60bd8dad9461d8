#pragma once

#include "hil/operator/hand_script.h"

namespace osteon::hil {

/// Parameters for drilling one hole. Depths and heights of the *tip* count from the site's centre, which lies
/// on the surface where the drill enters. Start and retreat are heights as in HandKey.
struct DrillingScriptParams {
  PlainPose X_WC{};             ///< the entry: centre of its circle, +z out of the bone
  double head_radius_m{0.002};  ///< of the ball at the drill's tip, which the hand guides
  double tool_yaw_rad{0.0};
  double seconds{10.0};  ///< >= 0.1
  double start_height_m{0.040};
  double retract_height_m{0.030};
  double depth_m{0.010};  ///< the push is at full force down to here, then fades
  double push_force_N{60.0};
  double approach_force_N{10.0};
  int pecks{4};                  ///< 1 … 50 pushes; between them the drill is withdrawn to clear its flutes
  double peck_height_m{0.0005};  ///< of the tip above the surface when withdrawn
  double hand_stiffness_N_per_m{2000.0};  ///< of the hand that will follow the script
  double max_target_m_per_s{0.2};         ///< a short script stops short of its targets rather than move
                                          ///< faster
};

/// Straight in along the site's axis, in pecks of equal depth, through, and out. Shares of the time: 2 %
/// grasp, 10 % approach until the tip meets the surface, 76 % pecks, 12 % withdrawal. Shares of a peck: a
/// quarter to ramp the force up, two fifths push, one fifth out, the rest back to the depth of the peck
/// before, at the approach's force. (The last peck, which breaks through if the bone is thinner than the
/// depth, pushes to its end.)
///
/// The push is as in MakeReamingScript: the target lies push_force / stiffness deeper than the peck's depth,
/// so the hand presses at the force limit. Beyond that depth the force fades, which bounds the plunge of a
/// hand that breaks through.
/// @throws std::invalid_argument, naming the parameter and what is accepted.
[[nodiscard]] HandScript MakeDrillingScript(const DrillingScriptParams& params);

}  // namespace osteon::hil
