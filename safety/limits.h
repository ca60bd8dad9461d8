#pragma once

#include <algorithm>
#include <cstdint>

#include "base/marker.h"
#include "kinematics/braking_speed.h"
#include "kinematics/force_capability.h"
#include "kinematics/spatial.h"

// Bounds on what the loop renders and commands. A limiter scales a whole wrench or twist and keeps its
// direction; a trip changes nothing and reports that the cell must stop.

namespace osteon::safety {

/// No cell may be configured to render more than this.
inline constexpr double kForceCeiling_N = 200.0;

/// Whether every component is finite.
[[nodiscard]] bool IsFinite(const Vector3& v) OSTEON_RT;
[[nodiscard]] bool IsFinite(const Wrench& F) OSTEON_RT;
[[nodiscard]] bool IsFinite(const Twist& V) OSTEON_RT;

struct LimitedWrench {
  Wrench F;
  double share{1.0};  ///< factor that was applied to the wrench, 0 … 1; 0 if the wrench was not finite
  /// share of the wrench that the arm's joint torques can hold, 0 … 1; `share` is never larger
  double arm_share{1.0};
};

/// Scales the whole wrench so that |f| <= max_force_N and |t| <= max_torque_Nm hold to the last bit:
///
///     s = min(1, max_force_N / |f|, max_torque_Nm / |t|),   F' = s F
///
/// Correct for every finite input up to the largest double. A wrench that is not finite becomes zero.
[[nodiscard]] LimitedWrench ScaleWrench(const Wrench& F, double max_force_N, double max_torque_Nm) OSTEON_RT;

struct WrenchLimitParams {
  double max_force_N{kForceCeiling_N};  ///< > 0; a value above kForceCeiling_N is treated as kForceCeiling_N
  double max_torque_Nm{20.0};           ///< > 0
};

/// Limits the coupling wrench before a law integrates or an arm receives it.
class WrenchLimiter {
 public:
  /// @throws std::invalid_argument if a limit is not positive.
  explicit WrenchLimiter(const WrenchLimitParams& params);

  [[nodiscard]] LimitedWrench Limit(const Wrench& F) const OSTEON_RT;
  /// Limits a wrench also to the share that the arm can hold in its posture:
  ///
  ///     s = min(arm.HoldableShare(F), max_force_N / |f|, max_torque_Nm / |t|),   F' = s F
  ///
  /// @param arm  capability at the point that F acts on, in F's frame
  [[nodiscard]] LimitedWrench Limit(const Wrench& F,
                                    const kinematics::ForceCapability<7>& arm) const OSTEON_RT;
  /// Lowers the force limit to force_N from now on; this replaces an earlier call. A value above the limit of
  /// the parameters has no effect.
  void LowerForceLimit(double force_N) OSTEON_RT { params_.max_force_N = std::min(force_limit_N_, force_N); }
  /// The present force limit: the smallest of the parameter, kForceCeiling_N and LowerForceLimit's value.
  [[nodiscard]] double max_force_N() const OSTEON_RT { return params_.max_force_N; }
  [[nodiscard]] double max_torque_Nm() const OSTEON_RT { return params_.max_torque_Nm; }

 private:
  WrenchLimitParams params_;  // the present limits
  double force_limit_N_;      // force limit before LowerForceLimit
};

/// Trips if the coupling force f grows or changes direction faster than any regular contact allows: 1.5 K
/// v_max, with the stiffness K and the tool's largest speed v_max.
///
///     growth = min over s in [0, 1] of |f - s f_before|,   trip if growth > 1.5 K v_max dt
///
/// A force that decreases along its own line has no growth, however fast it decreases; a force that changes
/// direction or reverses has growth. The factor 1.5 has these parts. If the tool moves by x, its distance
/// from the proxy changes by at most x, so a new contact at v_max raises the spring's force by at most K
/// v_max per second. The coupling's damping may add a share of the spring's force (a quarter by default),
/// which gives 1.25 K v_max. The rest is for rotation. A new frame that moves the proxy by d is faded in
/// within the coupling's return_s, which changes the force by K d dt / return_s per tick.
class WrenchRateTrip {
 public:
  /// @param stiffness_N_per_m  K: stiffness of the stiffest contact that is rendered
  /// @param max_speed_m_per_s  v_max: largest speed of the tool
  /// @throws std::invalid_argument if one of them is not positive.
  WrenchRateTrip(double stiffness_N_per_m, double max_speed_m_per_s);

  /// True if this force must stop the cell. Call once per tick, with the force before the limiter.
  [[nodiscard]] bool Check(const Vector3& f_N, double dt_s) OSTEON_RT;
  /// Forgets the previous force: the next force is compared with zero.
  void Reset() OSTEON_RT {
    before_N_.setZero();
    growth_N_ = 0.0;
  }
  /// Growth found by the last Check; infinite if the force was not finite.
  [[nodiscard]] double growth_N() const OSTEON_RT { return growth_N_; }
  [[nodiscard]] double max_rate_N_per_s() const OSTEON_RT { return max_rate_N_per_s_; }

 private:
  double max_rate_N_per_s_;
  Vector3 before_N_{Vector3::Zero()};
  double growth_N_{0.0};
};

struct SensorForceParams {
  double margin_N{50.0};  ///< tolerance beyond the wrench limit's largest force; > 0
  int ticks{5};           ///< number of consecutive ticks beyond limit + margin that trips; >= 1
};

/// Trips if the hand pushes beyond limit + margin for some ticks in a row.
class SensorForceTrip {
 public:
  /// @throws std::invalid_argument if a value is out of range.
  SensorForceTrip(const SensorForceParams& params, double max_force_N);

  /// True if the cell must stop because of the hand's force. Call once per tick; NaN counts as beyond the
  /// level.
  [[nodiscard]] bool Check(double force_N) OSTEON_RT;
  /// limit + margin [N].
  [[nodiscard]] double level_N() const OSTEON_RT { return level_N_; }

 private:
  double level_N_;
  int ticks_;
  int count_{0};  // number of consecutive ticks beyond level_N_
};

struct TwistLimitParams {
  double max_speed_m_per_s{0.25};  ///< largest speed of the tool's apex; > 0
  double max_turn_rad_per_s{1.5};  ///< > 0
};

struct LimitedTwist {
  Twist V;
  double share{1.0};  ///< factor that was applied, 0 … 1; 0 if the twist was not finite
};

/// Scales the whole twist so that |v| <= max_speed and |w| <= max_turn; a twist that is not finite becomes
/// zero.
[[nodiscard]] LimitedTwist LimitTwist(const Twist& V, const TwistLimitParams& params) OSTEON_RT;

using kinematics::BrakingSpeed;

}  // namespace osteon::safety
