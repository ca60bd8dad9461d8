#pragma once

#include <array>
#include <cstdint>

#include "base/marker.h"
#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

// One tick of motion: from the tool's wanted twist to joint velocities that every joint can follow.
//
//     J = U diag(sigma) V^T,   a_k = u_k·V_BT          the twist along the six directions of J
//     task  t = sum y_k v_k,   y_k = a_k / sigma_k     damped where sigma_k vanishes, and only along that u_k
//     qd = s t + r n                                   n the null space (7 joints), s one factor for the task
//     qd = qd_before + alpha (qd - qd_before)          the accelerations
//
// No joint is ever clipped alone: that would turn the tool's direction.

namespace osteon::kinematics {

template <int N>
struct JacobianSvd;

/// The limit that reduced the motion; of several, the one that reduced it the most.
enum class MotionLimit : std::uint8_t {
  kNone,
  kSingularity,   ///< the tool lost its motion along a direction that the arm is about to lose
  kPosition,      ///< a joint brakes before its position limit: the whole twist is slower
  kVelocity,      ///< a joint is at its velocity limit: the whole twist is slower
  kAcceleration,  ///< a joint is at its acceleration limit: the twist's change is smaller
};

/// Name of a limit, for tables.
[[nodiscard]] const char* Name(MotionLimit limit) noexcept;

template <int N>
struct DifferentialInverseParams {
  std::array<JointLimits, static_cast<std::size_t>(N)> limits{};
  double position_margin_rad{0.0174532925199433};  ///< distance kept from the position limits (1 deg); >= 0
  double speed_share{0.9};                         ///< usable share of the velocity limits, (0, 1]
  /// Usable share of the acceleration limits for a change, > 0. Braking before a limit or the end of the
  /// reach uses the limits themselves.
  double acceleration_share{1.0};
  double turning_length_m{0.3};  ///< a rotation of 1 rad weighs as much as this translation; > 0
  /// Singular values below this count as vanishing where the reach ends (|c_k| from 0.05 m/rad on). For an
  /// iiwa 0.07 m is an elbow bent by less than about 27 deg: the last 25 mm of its reach.
  double singular_zone_m{0.07};
  /// Lambda at sigma = 0 where no motion along the direction brings it back (a straight wrist); singular
  /// values below four times this count as vanishing there. Small, because the tool's path is kept outside;
  /// 0.002 m is a wrist within about 2 deg of straight. > 0.
  double min_damping_m{0.002};
  /// Joint angle from the singular posture at which a motion toward the end of the reach stops; >= 0. A
  /// thousandth of a radian at an iiwa's elbow is 0.1 um of reach.
  double singular_margin_rad{2e-3};
  /// Share of the joints' speed that a vanishing direction may use, (0, 1]: the rest is for the others.
  double singular_speed_share{0.5};
  double null_speed_rad_per_s{0.5};  ///< limit of the wanted null motion (norm over the joints); >= 0
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
  /// null_acceleration_share. Only its null-space part is used, so a gradient will do. No effect for 6
  /// joints.
  JointVectorN<N> qd_null{JointVectorN<N>::Zero()};
  double dt_s{0.001};               ///< > 0
  bool ignore_acceleration{false};  ///< true: the velocity changes at once, without acceleration limits
  /// MotionOutput::U of the previous tick, or any orthogonal matrix: the closer to this tick's U, the faster.
  Eigen::Matrix<double, 6, 6> U_before{Eigen::Matrix<double, 6, 6>::Identity()};
};

template <int N>
struct MotionOutput {
  JointVectorN<N> qd{JointVectorN<N>::Zero()};  ///< [rad/s], to be held for the tick
  Twist V_BT;                                   ///< resulting mean velocity of the tool over the tick, in B
  double share{1.0};         ///< s: share of the task that position and velocity limits left, 0 … 1
  double change_share{1.0};  ///< alpha: share of the change that acceleration limits left, 0 … 1
  double lost_m_per_s{0.0};  ///< length of the task that was lost in vanishing directions
  double sigma_min_m{0.0};   ///< smallest singular value, rotations weighted by the turning length
  double damping_m{0.0};     ///< the largest lambda of a_k sigma / (sigma^2 + lambda^2)
  JointVectorN<N> sigma_gradient_m{JointVectorN<N>::Zero()};  ///< gradient of sigma_min by q [m/rad]
  JointVectorN<N> null_direction{JointVectorN<N>::Zero()};    ///< n, unit, either sign; zero for 6 joints
  MotionLimit limit{MotionLimit::kNone};
  int joint{-1};      ///< the joint that set the limit, 0 … N-1; -1: none
  bool finite{true};  ///< false: the input was not finite, and qd is zero
  Eigen::Matrix<double, 6, 6> U{Eigen::Matrix<double, 6, 6>::Identity()};  ///< J's left directions
};

/// Differential inverse kinematics for arms of 6 or 7 joints, with limits. Stateless: the caller keeps the
/// velocity of the tick before.
///
/// **Singular directions.** Where sigma_k is in its zone, the joint speed y_k along v_k is bounded instead of
/// growing as 1/sigma_k: damped least squares on the vanishing direction alone, with the least lambda that
/// keeps the bound, lambda^2 = sigma_k (|a_k / y_k| - sigma_k). The bound is
///
///     |y_k| <= (joint speed along v_k) / w          w = 1 - (sigma_k / zone)^2: no bound at the zone's edge
///     |y_k| <= braking speed over sigma_k / |c_k|   where y_k makes sigma_k smaller: the reach ends smoothly
///     |y_k - y_k before| <= (joint acceleration along v_k) dt / w
///
/// with c_k = d sigma_k / d y_k. Where y_k makes sigma_k larger (the way back), the second order is included,
/// sigma y dt + c (y dt)^2 / 2 = a dt, which is finite at sigma = 0. An arm that was pushed straight
/// therefore comes back at once; plain damping would hold it for as long as it was pushed.
///
/// **Limits.** s is the largest share of the task for which some null motion keeps every joint within its
/// speed and, toward a position limit at distance d,
///
///     |qd_i| <= d / (tau + dt)      tau = max over all joints of speed / acceleration
///
/// This is always slow enough to brake, one tick's motion included, and makes all joints slow down together,
/// so that the last joint with a limit does not stop the others short. r is then the wanted null motion, or
/// the nearest to it that allows s: the null motion yields to the task and never takes from it. Its speed in
/// doing so is limited, so that it comes to rest where no posture relieves the limiting joint better.
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
  // A direction whose singular value is in the zone, and the motion that the twist asks along it.
  struct SingularDirection {
    const JointVectorN<N>& v;  // unit, in joint space
    double sigma_m{0.0}, curvature_m{0.0};
    double a_m_per_s{0.0};      // component of the twist along it
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
    JointVectorN<N> low, high;                                              ///< <= 0, >= 0 [rad/s]
    std::array<bool, static_cast<std::size_t>(N)> low_brakes, high_brakes;  ///< set by the position limit
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
