#pragma once

#include <array>
#include <cstddef>

#include "base/marker.h"
#include "kinematics/chain_params.h"
#include "kinematics/frame_turn.h"
#include "kinematics/sin_cos.h"

namespace osteon::kinematics {

/// Kinematics and dynamics of a serial arm of N revolute joints, N = 6 or 7.
///
///     ComputePosture  X_B1 ... X_BN, X_BF     poses of the joint frames and of the flange
///     Jacobian        V_BF = J qd             rows v (3) then w (3), in B, of the flange's origin or a point
///     dynamics        tau = M qdd + C qd + g - J^T F_ext  M with the rotors' inertia; friction separate
///
/// The choice of frames makes the computation fast. Besides the link frame L_i of the robot description each
/// joint has a frame K_i with the same origin, z along the joint's axis and x along z_i × z_(i+1), so that
///
///     X_K(i-1)K(i) = Translation(p_i) Rx(alpha_i) Rz(q_i + offset_i)
///
/// for any arm. Such a rotation mixes only two columns at a time, and all constant products are computed
/// once, at construction. No virtual calls, no allocation, no state: one object may serve any number of
/// threads. The same arguments give the same bits. Sources: Craig, Introduction to Robotics (the frames; but
/// each origin stays where the description puts it, so that almost parallel axes lose no accuracy);
/// Featherstone, Rigid Body Dynamics Algorithms, 2008 (RNEA, CRBA, ABA).
template <int N>
class SerialChain {
 public:
  using Joints = JointVectorN<N>;

  /// @param gravity_B  acceleration of free fall, in B [m/s^2]
  /// @throws std::invalid_argument naming the joint, the value found and what is accepted.
  explicit SerialChain(const ChainParams<N>& params, const Vector3& gravity_B = kGravity_W_m_per_s2);

  [[nodiscard]] const ChainParams<N>& params() const noexcept { return params_; }

  /// Axes and origins of all joint frames at one q, in B: the input of the Jacobian functions. Plain values.
  struct Posture {
    std::array<Matrix3, static_cast<std::size_t>(N)> R_BK;  ///< col(2): the joint's axis
    std::array<Vector3, static_cast<std::size_t>(N)> p_BL;  ///< origin of the link frame, on the joint's axis
    Pose X_BF{Pose::Identity()};

    /// Unit axis of joint i, in B.
    [[nodiscard]] auto axis_B(int i) const { return R_BK[static_cast<std::size_t>(i)].col(2); }
  };

  /// Forward kinematics of every joint frame at joint positions q [rad].
  void ComputePosture(const Joints& q, Posture& posture) const OSTEON_RT;
  [[nodiscard]] Posture ComputePosture(const Joints& q) const OSTEON_RT;
  /// X_BF alone: faster than a whole posture.
  [[nodiscard]] Pose FlangePose(const Joints& q) const OSTEON_RT;
  /// Pose X_BL of the link frame that joint i + 1 moves, i = 0 … N-1, as in the robot description.
  [[nodiscard]] Pose LinkPose(const Posture& posture, int i) const OSTEON_RT;

  /// Geometric Jacobian of the flange's origin: V_BF = J qd.
  void Jacobian(const Posture& posture, JacobianN<N>& J) const OSTEON_RT;
  [[nodiscard]] JacobianN<N> Jacobian(const Posture& posture) const OSTEON_RT;
  /// Geometric Jacobian of the point of the flange that is now at p_B.
  [[nodiscard]] JacobianN<N> JacobianAt(const Posture& posture, const Vector3& p_B) const OSTEON_RT;

  // --- dynamics: chain_dynamics.cpp, chain_forward_dynamics.cpp, chain_inertia.cpp; @pre params().has_masses
  // ---

  /// Torques of the drives for a motion: tau = M qdd + C qd + g, without friction [N·m]. By RNEA.
  [[nodiscard]] Joints InverseDynamics(const Joints& q, const Joints& qd, const Joints& qdd) const OSTEON_RT;
  /// Torques of the drives for a motion with an external wrench: M qdd + C qd + g - J^T F_ext. F_ext acts on
  /// the flange at the flange's origin, expressed in B.
  [[nodiscard]] Joints InverseDynamics(const Joints& q, const Joints& qd, const Joints& qdd,
                                       const Wrench& F_ext_B) const OSTEON_RT;
  /// Torques that hold the arm at rest: g.
  [[nodiscard]] Joints Gravity(const Joints& q) const OSTEON_RT;
  /// Centrifugal and Coriolis torques: C qd.
  [[nodiscard]] Joints Coriolis(const Joints& q, const Joints& qd) const OSTEON_RT;
  /// Friction torques of the drives: viscous qd + coulomb tanh(qd / smoothing).
  [[nodiscard]] Joints Friction(const Joints& qd) const OSTEON_RT;

  /// Joint-space inertia M, with the rotors' inertia on its diagonal: symmetric, positive definite. By CRBA.
  [[nodiscard]] JointMatrixN<N> MassMatrix(const Joints& q) const OSTEON_RT;
  /// Joint accelerations qdd [rad/s^2] for given torques: the inverse of InverseDynamics. By ABA.
  [[nodiscard]] Joints ForwardDynamics(const Joints& q, const Joints& qd, const Joints& tau) const OSTEON_RT;
  [[nodiscard]] Joints ForwardDynamics(const Joints& q, const Joints& qd, const Joints& tau,
                                       const Wrench& F_ext_B) const OSTEON_RT;

  /// Mobility J M^-1 J^T of the point of the flange at p_B: the point's acceleration (linear, then angular,
  /// in B) per unit of a wrench at the point. It is finite in every posture. Its inverse is the inertia that
  /// a hand feels at the point.
  [[nodiscard]] Eigen::Matrix<double, 6, 6> Mobility(const Joints& q, const Vector3& p_B) const OSTEON_RT;

 private:
  // Step from frame K(i-1) to K(i). K(0) is fixed to the base: at the base's origin, with z along the first
  // joint's axis.
  struct Step {
    Vector3 p;  // origin of K(i), in K(i-1) [m]
    double cos_alpha{1.0}, sin_alpha{0.0};
    double offset_rad{0.0};
  };

  // Mass properties of link i in K(i), about the frame's origin. Second moments are the integral of r r^T dm,
  // not the inertia.
  struct Body {
    double mass_kg{0.0};
    Vector3 first_moment_kg_m{Vector3::Zero()};
    Matrix3 second_moment_kg_m2{Matrix3::Zero()};
    Matrix3 inertia_kg_m2{Matrix3::Zero()};
  };

  static constexpr std::size_t kPadded = N + N % 2;  // joints, rounded up to pairs

  // Moves a frame along the chain, and calls visit(i, x, y, z, p) with the axes and origin of each K(i), in
  // B. @returns X_BF.
  template <class Visit>
  Pose Walk(const Joints& q, const Visit& visit) const noexcept;
  // Sines and cosines of the angles that turn each K(i): q plus its offset.
  SinCosN<kPadded> SinCosOfTurns(const Joints& q) const noexcept {
    std::array<double, kPadded> angle{};
    for (std::size_t i = 0; i < N; ++i) angle[i] = q[static_cast<int>(i)] + steps_[i].offset_rad;
    return SinCos(angle);
  }
  // J^T F, for the flange's origin.
  Joints TorquesOf(const Posture& posture, const Wrench& F_B) const noexcept;
  // Inverse dynamics (RNEA) without friction, for a base that accelerates by a [m/s^2, in K(0)].
  Joints NewtonEuler(const Joints& q, const Joints& qd, const Joints& qdd, const Vector3& a) const noexcept;
  // Sums the loads on the links from the flange to the base. @returns the drives' torques, with those that
  // accelerate the rotors.
  Joints Gather(const SinCosN<kPadded>& turn,
                const std::array<Triple<Pair>, static_cast<std::size_t>(N)>& loads,
                const Joints& qdd) const noexcept;

  ChainParams<N> params_;
  std::array<Step, static_cast<std::size_t>(N)> steps_;
  std::array<Matrix3, static_cast<std::size_t>(N)> R_LK_;
  Matrix3 R_BK0_;
  Matrix3 R_KF_;  // flange in K(N)
  Vector3 p_KF_;
  std::array<Body, static_cast<std::size_t>(N)> bodies_;
  Vector3 lift_K0_;  // minus the acceleration of free fall, in K(0)
};

}  // namespace osteon::kinematics
