#pragma once

#include "hil/operator/hand_script.h"

namespace osteon::hil {

/// Parameters for opening a cavity with a burr, such as the access to a tooth's root canals. Depths of the
/// burr's *apex* count from the site's centre, which lies on the surface. Start and retreat are heights as in
/// HandKey.
struct OpeningScriptParams {
  PlainPose X_WC{};  ///< the site: centre of its circle, +z out of the bone
  double head_radius_m{0.0008};
  double tool_yaw_rad{0.0};
  double seconds{10.0};  ///< >= 0.1
  double start_height_m{0.040};
  double retract_height_m{0.030};
  double site_radius_m{0.0016};  ///< the burr's edge widens the opening to this circle
  double depth_m{0.004};         ///< the push is at full force down to here, then fades
  double push_force_N{4.0};      ///< along the axis
  double approach_force_N{1.5};
  double loop_period_s{0.8};
  int turns{3};                           ///< 1 … 50 steps in which the loops widen and deepen
  double hand_stiffness_N_per_m{2000.0};  ///< of the hand that will follow the script
  double max_target_m_per_s{0.2};         ///< a short script stops short of its targets rather than move
                                          ///< faster
};

/// Down, then sideways in loops that widen while they deepen, a last pass along the circle at full depth, and
/// out. Shares of the time: 2 % grasp, 13 % approach until the burr meets the surface, 15 % straight in, 40 %
/// widening and deepening in steps, 12 % along the circle, 8 % to the axis, 10 % out.
///
/// Along the axis the push is as in MakeReamingScript. Across it the hand leads the burr with its spring, so
/// the sideways force is stiffness times the distance not yet cut, at most stiffness × (site radius - head
/// radius). A loop is never faster than max_target_m_per_s.
/// @throws std::invalid_argument, naming the parameter and what is accepted.
[[nodiscard]] HandScript MakeOpeningScript(const OpeningScriptParams& params);

}  // namespace osteon::hil
