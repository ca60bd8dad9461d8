#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "kinematics/spatial.h"

namespace osteon::hil {

/// State at the end of a phase of a script. Heights are those of the tool head's centre above the site's
/// centre, along the site's axis, positive out of the bone.
struct HandKey {
  double height_m{0.0};
  double force_limit_N{0.0};  ///< bound on the force along the site's axis
  double tilt_rad{0.0};       ///< angle between the tool's axis and the site's axis
  double grip{1.0};           ///< share of the hand's wrench that reaches the tool, 0 … 1
  double swing_m{0.0};        ///< radius of the circle about the site's axis that the head's centre follows
  /// Height at which the operator sees that the work is done and stops pushing; kNever_m: the operator never
  /// stops.
  double done_height_m{kNever_m};
  /// The operator watches the simulated tool, which cuts. Because of the coupling's spring it is higher than
  /// the head of the real tool, by this much per newton of push.
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
  Pose X_WT{Pose::Identity()};  ///< pose toward which the hand pulls the tool
  Twist V_WT;                   ///< velocity of T at that pose, in W
  double height_m{0.0};
  double force_limit_N{0.0};
  double grip{0.0};
  double done_height_m{HandKey::kNever_m};
  double give_m_per_N{0.0};
};

/// A hand's targets over time. They consist of phases, each of which blends from one key to the next.
///
/// In each phase every value of a key follows the quintic s(u) = 10 u^3 - 15 u^4 + 6 u^5, u the elapsed share
/// of the phase. Velocity and acceleration are zero at both ends, so targets are twice continuously
/// differentiable in time. The tilt's direction turns at constant speed ("whirlwind") about the centre of the
/// head. This centre follows a circle about the site's axis, or stays on the axis if no key swings:
///
///     R_CT = R_x(pi) R_z(yaw) Exp(tilt(t) (cos p, sin p, 0)),   p = 2 pi t / whirl_period
///     p_C_head = (swing(t) cos q, swing(t) sin q, height(t)),   q = 2 pi t / swing_period
class HandScript {
 public:
  /// @param X_WC the site that is cut: origin at its centre, +z out of the bone; @param head_radius_m radius
  /// of the tool's head
  /// @throws std::invalid_argument on a duration, radius or period that is not positive, a grip outside 0 …
  ///   1, or a swing at the start or the end of the script (motion along the circle would begin or end with a
  ///   jolt).
  HandScript(const Pose& X_WC, double head_radius_m, double tool_yaw_rad, double whirl_period_s,
             const HandKey& start, std::vector<HandPhase> phases, double swing_period_s = 1.0);

  /// The target at a time since the script began [s]; before and after the script, the first and the last
  /// target.
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
  Matrix3 R_WT_upright_;  // orientation of the tool without tilt: z along the site's axis, into the bone
};

/// Parameters for reaming one acetabulum.
struct ReamingScriptParams {
  PlainPose X_WC{};  ///< the cup: centre of its sphere, +z out of the opening
  double head_radius_m{0.025};
  /// Rotation of the tool about its axis, e.g. for a better posture of the arm's wrist.
  double tool_yaw_rad{0.0};
  double seconds{10.0};          ///< >= 0.1
  double start_height_m{0.040};  ///< heights as in HandKey
  double retract_height_m{0.030};
  /// Depth below height 0 down to which the push has its full force; deeper, the force fades.
  double full_force_depth_m{0.010};
  double push_force_N{120.0};
  double approach_force_N{20.0};
  /// Tilt of the tool while its direction circles about the axis (whirlwind); 0: the tool is pressed straight
  /// along the axis.
  double tilt_rad{10.0 * std::numbers::pi / 180.0};
  double whirl_period_s{2.0};
  double hand_stiffness_N_per_m{2000.0};  ///< stiffness of the hand that will follow the script
  /// Largest speed of the targets; in a script that is too short for it, the motions are shorter.
  double max_target_m_per_s{0.2};
  double max_tilt_rad_per_s{0.5};
};

/// Makes a script with approach, force ramp, push with whirlwind, unloading and retreat. The phases are
/// scaled to the script's length. A script of 10 s has 1 s of grasp and approach to height 0, 0.7 s of
/// ramp, 7.1 s of push (the tilt grows and fades in 0.8 s each), 0.4 s of unloading and 0.8 s of retreat.
/// Without a tilt the phases of the push are named "press".
///
/// During the push the target lies full_force_depth + push_force / stiffness below height 0. Above the depth
/// of full force, the hand's spring exceeds the force limit, so the hand presses with that limit. A hand that
/// breaks through stops at the target.
/// @throws std::invalid_argument, naming the parameter and what is accepted.
[[nodiscard]] HandScript MakeReamingScript(const ReamingScriptParams& params);

}  // namespace osteon::hil
