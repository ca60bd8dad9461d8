#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "kinematics/spatial.h"

namespace osteon::hil {

/// State at the end of a phase of a script. Heights are along the site's axis, 0 where the centre of the
/// tool's head meets the site's centre, positive out of the bone.
struct HandKey {
  double height_m{0.0};
  double force_limit_N{0.0};  ///< bound on the force along the cup's axis
  double tilt_rad{0.0};       ///< of the tool's axis away from the cup's
  double grip{1.0};           ///< share of the hand's wrench that reaches the tool, 0 … 1
  double swing_m{0.0};        ///< radius of the circle about the axis that the head's centre follows
  /// Height at which the operator sees that the work is done, and stops pushing; kNever_m: pushes on.
  double done_height_m{kNever_m};
  /// The operator watches the tool that cuts. A coupling's spring lets it stand higher than the head, by this
  /// much per newton of the push.
  double give_m_per_N{0.0};

  static constexpr double kNever_m = -1.0;
};

struct HandPhase {
  std::string name;
  double duration_s{0.0};
  HandKey end;
};

/// The hand's target at one moment.
struct HandTarget {
  Pose X_WT{Pose::Identity()};  ///< toward which the hand pulls the tool
  Twist V_WT;                   ///< of T at that pose, in W
  double height_m{0.0};
  double force_limit_N{0.0};
  double grip{0.0};
  double done_height_m{HandKey::kNever_m};
  double give_m_per_N{0.0};
};

/// A hand's targets over time: phases that blend from key to key.
///
/// In each phase every value of a key follows the quintic s(u) = 10 u^3 - 15 u^4 + 6 u^5 of the phase's
/// elapsed share. Velocity and acceleration are zero at both ends, so targets are twice continuously
/// differentiable in time. The tilt's direction turns at constant speed ("whirlwind") about the centre of the
/// head. This centre follows a circle about the site's axis, or stays on the axis if no key swings:
///
///     R_CT = R_x(pi) R_z(yaw) Exp(tilt(t) (cos p, sin p, 0)),   p = 2 pi t / whirl_period
///     p_C_head = (swing(t) cos q, swing(t) sin q, height(t)),   q = 2 pi t / swing_period
class HandScript {
 public:
  /// @param X_WC the site that is cut: its centre, +z out of the bone; @param head_radius_m of the tool.
  /// @throws std::invalid_argument on a duration, radius or period that is not positive, a grip outside 0 …
  ///   1, or a swing at the start or the end, where motion along the circle would begin or end with a jolt.
  HandScript(const Pose& X_WC, double head_radius_m, double tool_yaw_rad, double whirl_period_s,
             const HandKey& start, std::vector<HandPhase> phases, double swing_period_s = 1.0);

  /// The target at a time since the script began [s]; clamped to the first and the last.
  [[nodiscard]] HandTarget Sample(double time_s) const noexcept;

  /// The phase's name at that time; "done" after the last.
  [[nodiscard]] const char* PhaseName(double time_s) const noexcept;

  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] double head_radius_m() const { return head_radius_m_; }
  [[nodiscard]] const Pose& X_WC() const { return X_WC_; }
  [[nodiscard]] const HandKey& start() const { return start_; }
  [[nodiscard]] const std::vector<HandPhase>& phases() const { return phases_; }

 private:
  Pose X_WC_;
  double head_radius_m_;
  double whirl_rad_per_s_, swing_rad_per_s_;
  bool swings_{false};  // some key has a swing
  HandKey start_;
  std::vector<HandPhase> phases_;
  double duration_s_{0.0};
  Matrix3 R_WT_upright_;  // of the tool along the axis: without tilt, z into the bone
};

/// Parameters for reaming one acetabulum.
struct ReamingScriptParams {
  PlainPose X_WC{};  ///< the cup: centre of its sphere, +z out of the opening
  double head_radius_m{0.025};
  double tool_yaw_rad{0.0};      ///< turns the tool about its axis, e.g. to suit the wrist
  double seconds{10.0};          ///< >= 0.1
  double start_height_m{0.040};  ///< heights as in HandKey
  double retract_height_m{0.030};
  /// The push is at full force down to this far below height 0, then fades.
  double full_force_depth_m{0.010};
  double push_force_N{120.0};
  double approach_force_N{20.0};
  /// Tilt of the whirlwind; 0: straight, pressed along the axis.
  double tilt_rad{10.0 * std::numbers::pi / 180.0};
  double whirl_period_s{2.0};
  double hand_stiffness_N_per_m{2000.0};  ///< of the hand that will follow the script
  double max_target_m_per_s{0.2};         ///< a short script stops short of its targets rather than move
                                          ///< faster
  double max_tilt_rad_per_s{0.5};
};

/// Approach, force ramp, push with whirlwind, unload, retract, scaled to any length. In a script of 10 s: 1 s
/// of approach to height 0, 0.7 s of ramp, 7.1 s of push (the tilt grows and fades in 0.8 s each), 0.4 s of
/// unloading, 0.8 s of retreat. Without a tilt the push is straight: its phases are named "press".
///
/// In the push the target lies below the cup by full_force_depth + push_force / stiffness. The hand's spring
/// then asks for more than the force limit, so the hand presses at that limit. A hand that breaks through
/// stops at the target rather than at the table.
/// @throws std::invalid_argument, naming the parameter and what is accepted.
[[nodiscard]] HandScript MakeReamingScript(const ReamingScriptParams& params);

}  // namespace osteon::hil
