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
  double share{1.0};      ///< passed share of the wrench, 0 … 1; 0 if the wrench was not finite
  double arm_share{1.0};  ///< share of it that the arm's torques can hold, 0 … 1; share is at most this
};

/// Scales the whole wrench so that |f| <= max_force_N and |t| <= max_torque_Nm hold to the last bit:
///
///     s = min(1, max_force_N / |f|, max_torque_Nm / |t|),   F' = s F
///
/// Correct for every finite input up to the largest double. A wrench that is not finite becomes zero.
[[nodiscard]] LimitedWrench ScaleWrench(const Wrench& F, double max_force_N, double max_torque_Nm) OSTEON_RT;

struct WrenchLimitParams {
  double max_force_N{kForceCeiling_N};  ///< > 0; a value above kForceCeiling_N counts as that
  double max_torque_Nm{20.0};           ///< > 0
};

/// Limits the coupling wrench before a law integrates or an arm receives it.
class WrenchLimiter {
 public:
  /// @throws std::invalid_argument where a limit is not positive.
  explicit WrenchLimiter(const WrenchLimitParams& params);

  [[nodiscard]] LimitedWrench Limit(const Wrench& F) const OSTEON_RT;
  /// Limits a wrench also to the share that the arm can hold in its posture:
  ///
  ///     s = min(arm.HoldableShare(F), max_force_N / |f|, max_torque_Nm / |t|),   F' = s F
  ///
  /// @param arm  capability at the point that F acts on, in F's frame
  [[nodiscard]] LimitedWrench Limit(const Wrench& F,
                                    const kinematics::ForceCapability<7>& arm) const OSTEON_RT;
  /// Caps the force limit from now on, instead of an earlier cap. A cap above the parameter has no effect.
  void LowerForceLimit(double force_N) OSTEON_RT { params_.max_force_N = std::min(force_limit_N_, force_N); }
  /// The limit in force: the smallest of the parameter, kForceCeiling_N and the cap.
  [[nodiscard]] double max_force_N() const OSTEON_RT { return params_.max_force_N; }
  [[nodiscard]] double max_torque_Nm() const OSTEON_RT { return params_.max_torque_Nm; }

 private:
  WrenchLimitParams params_;  // the limits in force
  double force_limit_N_;      // without a cap
};

/// Trips if the coupling force grows or turns faster than in any legitimate contact: above 1.5 K v_max.
///
///     growth = min over s in [0, 1] of |f - s f_before|,   trip where growth > 1.5 K v_max dt
///
/// A force that falls along its own line has no growth, however fast it falls; a force that turns or reverses
/// has. The displacement of a constrained proxy is 1-Lipschitz in the tool's position, so a fresh contact at
/// v_max raises the spring's force by at most K v_max. The coupling's damping may add at most a share of the
/// spring's force (a quarter by default), which gives 1.25 K v_max. The rest of the 1.5 is for rotation. A
/// frame that moves the proxy by d is handed over within return_s of the coupling: K d dt / return_s per
/// tick.
class WrenchRateTrip {
 public:
  /// @param stiffness_N_per_m  K, of the stiffest contact that is rendered
  /// @param max_speed_m_per_s  v_max, of the tool.
  /// @throws std::invalid_argument where one is not positive.
  WrenchRateTrip(double stiffness_N_per_m, double max_speed_m_per_s);

  /// True if this force must stop the cell. Call once per tick, with the force before the limiter.
  [[nodiscard]] bool Check(const Vector3& f_N, double dt_s) OSTEON_RT;
  /// Forgets the previous force; the next one counts from zero.
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
  double margin_N{50.0};  ///< tolerance beyond the wrench limit's force; > 0
  int ticks{5};           ///< ticks in a row beyond it until the trip; >= 1
};

/// Trips if the hand pushes beyond limit + margin for some ticks in a row.
class SensorForceTrip {
 public:
  /// @throws std::invalid_argument where a value is out of range.
  SensorForceTrip(const SensorForceParams& params, double max_force_N);

  /// True if the hand must stop the cell. Call once per tick; NaN counts as beyond.
  [[nodiscard]] bool Check(double force_N) OSTEON_RT;
  /// limit + margin [N].
  [[nodiscard]] double level_N() const OSTEON_RT { return level_N_; }

 private:
  double level_N_;
  int ticks_;
  int count_{0};  // ticks in a row beyond level_N_
};

struct TwistLimitParams {
  double max_speed_m_per_s{0.25};  ///< of the tool's apex; > 0
  double max_turn_rad_per_s{1.5};  ///< > 0
};

struct LimitedTwist {
  Twist V;
  double share{1.0};  ///< 0 … 1; 0 if the twist was not finite
};

/// Scales the whole twist so that |v| <= max_speed and |w| <= max_turn; zero for one that is not finite.
[[nodiscard]] LimitedTwist LimitTwist(const Twist& V, const TwistLimitParams& params) OSTEON_RT;

using kinematics::BrakingSpeed;

}  // namespace osteon::safety
