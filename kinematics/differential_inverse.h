#pragma once

#include <array>
#include <cstdint>

#include "base/marker.h"
#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

// Converts the tool's wanted twist of one tick to joint velocities that every joint can follow.
//
//     J = U diag(sigma) V^T,   a_k = u_k·V_BT          component of the twist along left singular vector u_k
//     task  t = sum y_k v_k,   y_k = a_k / sigma_k     damped along each u_k whose sigma_k is near 0
//     qd = s t + r n                                   n null direction (7 joints), s one factor for the task
//     qd = qd_before + alpha (qd - qd_before)          alpha one factor for the acceleration limits
//
// No joint is ever clipped alone: that would turn the tool's direction.

namespace osteon::kinematics {

template <int N>
struct JacobianSvd;

/// The limit that reduced the motion. If several did, the one that reduced it the most.
enum class MotionLimit : std::uint8_t {
  kNone,
  kSingularity,   ///< motion was lost along a direction in which a singular arm cannot move
  kPosition,      ///< a joint brakes before its position limit, which slows the whole twist
  kVelocity,      ///< a joint is at its velocity limit, which slows the whole twist
  kAcceleration,  ///< a joint is at its acceleration limit, which reduces the change of the twist
};

/// Name of a limit, for tables.
[[nodiscard]] const char* Name(MotionLimit limit) noexcept;

template <int N>
struct DifferentialInverseParams {
  std::array<JointLimits, static_cast<std::size_t>(N)> limits{};
  double position_margin_rad{0.0174532925199433};  ///< distance kept from the position limits (1 deg); >= 0
  double speed_share{0.9};                         ///< usable share of the velocity limits, (0, 1]
  /// Usable share of the acceleration limits for a change of velocity, > 0. Braking before a position limit
  /// or the end of the reach uses the full acceleration limits.
  double acceleration_share{1.0};
  double turning_length_m{0.3};  ///< a rotation of 1 rad is weighted like a translation of this length; > 0
  /// Singular values below this are treated as near-singular if the arm approaches the end of its reach
  /// (|c_k| of at least 0.05 m/rad). For an iiwa, 0.07 m corresponds to an elbow bent by less than about 27
  /// deg, the last 25 mm of its reach.
  double singular_zone_m{0.07};
  /// Damping lambda at sigma = 0 for directions with c_k near 0, along which no motion makes sigma larger (a
  /// straight wrist). For them, singular values below four times this are treated as near-singular. The value
  /// is small, because tool paths avoid such postures: 0.002 m means a wrist within about 2 deg of straight.
  /// > 0.
  double min_damping_m{0.002};
  /// Distance in joint angle from the singular posture at which a motion toward the end of the reach stops;
  /// >= 0. For an iiwa's elbow, 0.001 rad corresponds to 0.1 um of reach.
  double singular_margin_rad{2e-3};
  /// Share of the joints' speed limits that motion along a near-singular direction may use, (0, 1]. The rest
  /// remains for the other directions.
  double singular_speed_share{0.5};
  double null_speed_rad_per_s{0.5};  ///< speed limit of the wanted null motion (norm over the joints); >= 0
  /// Share of the joints' acceleration that a change of the wanted null motion may use, (0, 1]: prevents
  /// jumps when an objective appears or ends.
  double null_acceleration_share{0.5};
};

template <int N>
struct MotionInput {
  JacobianN<N> J{JacobianN<N>::Zero()};  ///< Jacobian of the tool's origin, in B: V_BT = J qd
  Twist V_BT;                            ///< wanted mean velocity of the tool over the tick, in B
  JointVectorN<N> q{JointVectorN<N>::Zero()};
  JointVectorN<N> qd_before{JointVectorN<N>::Zero()};  ///< joint velocity in the previous tick [rad/s]
  double share_before{1.0};                            ///< MotionOutput::share of the previous tick
  /// Joint velocity that the null motion should follow [rad/s], within the limits of null_speed_rad_per_s and
  /// null_acceleration_share. Only its null-space part is used, so it may be the gradient of an objective. No
  /// effect for 6 joints.
  JointVectorN<N> qd_null{JointVectorN<N>::Zero()};
  double dt_s{0.001};               ///< > 0
  bool ignore_acceleration{false};  ///< true: the velocity changes at once, without acceleration limits
  /// MotionOutput::U of the previous tick, or any orthogonal matrix. The decomposition is faster the closer
  /// this is to the present U.
  Eigen::Matrix<double, 6, 6> U_before{Eigen::Matrix<double, 6, 6>::Identity()};
};

template <int N>
struct MotionOutput {
  JointVectorN<N> qd{JointVectorN<N>::Zero()};  ///< [rad/s], joint velocity to command for the whole tick
  Twist V_BT;                                   ///< resulting mean velocity of the tool over the tick, in B
  double share{1.0};         ///< s: factor on the task by position and velocity limits, 0 … 1
  double change_share{1.0};  ///< alpha: factor on the change of velocity by acceleration limits, 0 … 1
  double lost_m_per_s{0.0};  ///< speed of the tool that was lost along near-singular directions
  double sigma_min_m{0.0};   ///< smallest singular value of J, with rotations weighted by the turning length
  /// largest lambda of all directions, with y_k = a_k sigma_k / (sigma_k^2 + lambda^2)
  double damping_m{0.0};
  /// gradient of sigma_min with respect to q [m/rad]
  JointVectorN<N> sigma_gradient_m{JointVectorN<N>::Zero()};
  JointVectorN<N> null_direction{JointVectorN<N>::Zero()};  ///< n, unit, either sign; zero for 6 joints
  MotionLimit limit{MotionLimit::kNone};
  int joint{-1};      ///< the joint that set the limit, 0 … N-1; -1: none
  bool finite{true};  ///< false: the input was not finite, and qd is zero
  Eigen::Matrix<double, 6, 6> U{Eigen::Matrix<double, 6, 6>::Identity()};  ///< left singular vectors of J
};

/// Differential inverse kinematics for arms of 6 or 7 joints, with limits. Stateless: the caller stores the
/// velocity of the previous tick.
///
/// **Singular directions.** If sigma_k is below its zone's width, the joint speed y_k along v_k is bounded
/// instead of growing as 1/sigma_k. This is damped least squares along that direction alone, with the
/// smallest lambda that keeps the bound, lambda^2 = sigma_k (|a_k / y_k| - sigma_k). The bound is
///
///     |y_k| <= (joint speed along v_k) / w          w = 1 - (sigma_k / zone)^2: no bound at the zone's edge
///     |y_k| <= braking speed over sigma_k / |c_k|   if y_k makes sigma_k smaller: the reach ends smoothly
///     |y_k - y_k before| <= (joint acceleration along v_k) dt / w
///
/// with c_k = d sigma_k / d y_k; "before" is the value in the previous tick. If y_k makes sigma_k larger
/// (motion away from the singular posture), the second order is included, sigma y dt + c (y dt)^2 / 2 = a dt,
/// which is finite at sigma = 0. An arm that was pushed straight therefore comes back at once. Plain damping
/// would keep it straight for as long as it had been pushed.
///
/// **Limits.** s is the largest share of the task for which some null motion r keeps every joint within its
/// speed limit and, toward a position limit at distance d, within
///
///     |qd_i| <= d / (tau + dt)      tau = max over all joints of speed / acceleration
///
/// This is always slow enough to brake, one tick's motion included. Because tau is the same for all joints,
/// they slow down together, and no joint stops the others suddenly. r is the wanted null motion, or the value
/// nearest to it that allows s, so the null motion never reduces the task. The speed with which r yields to
/// the task is limited, so that the arm comes to rest in the posture that relieves the limiting joint best.
/// Position takes precedence over acceleration if both cannot be kept.
///
/// Sources: Nakamura and Hanafusa, Inverse Kinematic Solutions With Singularity Robustness, ASME J. Dyn. Sys.
/// 108, 1986; Maciejewski and Klein, Numerical Filtering for the Operation of Robotic Manipulators Through
/// Kinematically Singular Configurations, J. Robotic Systems 5, 1988; Flacco, De Luca, Khatib, Control of
/// Redundant Robots Under Hard Joint Constraints: Saturation in the Null Space, IEEE Trans. Robotics 31,
/// 2015.
template <int N>
class DifferentialInverse {
 public:
  /// @throws std::invalid_argument naming joint or parameter, what was found and what is accepted.
  explicit DifferentialInverse(const DifferentialInverseParams<N>& params);

  [[nodiscard]] const DifferentialInverseParams<N>& params() const noexcept { return params_; }

  [[nodiscard]] MotionOutput<N> Step(const MotionInput<N>& in) const OSTEON_RT;

 private:
  struct DampedSpeed {
    double speed, lambda;  // [rad/s], damping [m]
  };
  // A direction whose singular value is below singular_zone_m, and the motion along it that the twist asks
  // for.
  struct SingularDirection {
    const JointVectorN<N>& v;  // unit, in joint space
    double sigma_m{0.0}, curvature_m{0.0};
    double a_m_per_s{0.0};      // component of the twist along this direction
    double twist_m_per_s{0.0};  // length of the whole twist
  };
  [[nodiscard]] DampedSpeed ComputeDampedSpeed(const SingularDirection& direction,
                                               const MotionInput<N>& in) const OSTEON_RT;
  [[nodiscard]] JointVectorN<N> DampedTask(const MotionInput<N>& in, const JacobianSvd<N>& svd,
                                           const Eigen::Matrix<double, 6, 1>& V_scaled,
                                           MotionOutput<N>& out) const OSTEON_RT;
  [[nodiscard]] double LimitedNullSpeed(const JointVectorN<N>& n, const MotionInput<N>& in) const OSTEON_RT;
  // The joint speeds that each joint's position and speed limits allow in this tick.
  struct Box {
    JointVectorN<N> low, high;  ///< <= 0, >= 0 [rad/s]
    /// the bound is set by the position limit
    std::array<bool, static_cast<std::size_t>(N)> low_brakes, high_brakes;
  };
  [[nodiscard]] Box ComputeSpeedBox(const JointVectorN<N>& q, double dt_s) const OSTEON_RT;
  [[nodiscard]] double MaxNullMotion(const Box& box, const JointVectorN<N>& task, const JointVectorN<N>& n,
                                     double r_wanted) const OSTEON_RT;
  void ScaleIntoBox(const Box& box, const JointVectorN<N>& task, const JointVectorN<N>& n, double r_wanted,
                    MotionOutput<N>& out) const OSTEON_RT;
  void LimitChange(const Box& box, const JointVectorN<N>& qd_before, double dt_s,
                   MotionOutput<N>& out) const OSTEON_RT;

  DifferentialInverseParams<N> params_;
  JointVectorN<N> speed_rad_per_s_, acceleration_rad_per_s2_, low_rad_, high_rad_;
  double braking_time_s_{0.0};
};

extern template class DifferentialInverse<6>;
extern template class DifferentialInverse<7>;

}  // namespace osteon::kinematics
