#pragma once

#include <array>

#include "base/marker.h"
#include "kinematics/serial_chain.h"

namespace osteon::hil {

/// The mount of the arm. Assumed figures; a steel pedestal is near 5e6 N/m, a cart on locked castors far
/// below.
struct FlexibleMountParams {
  double stiffness_N_per_m{2e6};     ///< along x, y, z of B alike; > 0
  double stiffness_Nm_per_rad{5e5};  ///< about x, y, z alike, at B's origin; > 0
  double damping_ratio{0.05};        ///< of each direction alone, with the arm in its posture at the start
  double mass_kg{20.0};              ///< moving mass of the mount, without the arm's links; > 0
  double inertia_kg_m2{1.0};         ///< about B's origin; > 0
};

/// A base on springs that an arm shakes: small motions d (3 + 3) of B,
///
///     d/dt ((M_mount + M_arm) d' + H) + D d' + K d = W - W_start
///
/// with M_arm the arm's inertia about B's origin in its present posture, H the momentum of the joints'
/// motion, W the wrench of gravity and external loads. The base's acceleration acts on the links like a
/// gravity field. The effects of the base's rotation on the links (Coriolis, centrifugal) are left out, and
/// axes are taken as if B did not rotate. Starts at rest: displacement is zero under the arm's weight at the
/// start.
class FlexibleMount {
 public:
  using Joints = kinematics::JointVectorN<7>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  /// @throws std::invalid_argument naming the parameter.
  FlexibleMount(const FlexibleMountParams& params, const kinematics::ChainParams<7>& chain,
                const Vector3& gravity_B, const Joints& q_start);

  /// Motion of the arm on the mount, and the external wrench on it.
  struct Input {
    const Joints& q;               ///< [rad]
    const Joints& qd;              ///< [rad/s]
    Wrench F_B{};                  ///< its force acts at p_B of the base's frame
    Vector3 p_B{Vector3::Zero()};  ///< [m]
  };
  void Step(const kinematics::SerialChain<7>& chain, const Input& input, double dt_s) OSTEON_RT;

  /// Joint torques [N·m] that the drives must add because the base accelerates.
  [[nodiscard]] Joints Torques(const kinematics::SerialChain<7>& chain, const Joints& q) const OSTEON_RT;

  [[nodiscard]] Pose X_BBnow() const OSTEON_RT;
  [[nodiscard]] const Vector6& displacement() const OSTEON_RT { return d_; }  ///< [m, rad]
  [[nodiscard]] const Vector6& rate() const OSTEON_RT { return rate_; }       ///< [m/s, rad/s]

 private:
  // The arm as one rigid body about B's origin, the momentum of its joints' motion, and the wrench of its
  // weight.
  struct RigidBodySum {
    Matrix6 inertia{Matrix6::Zero()};
    Vector6 momentum{Vector6::Zero()}, weight{Vector6::Zero()};
  };
  [[nodiscard]] RigidBodySum SumLinks(const kinematics::SerialChain<7>& chain, const Joints& q,
                                      const Joints& qd) const OSTEON_RT;

  std::array<kinematics::LinkInertia, 7> links_;
  Vector3 gravity_B_;
  Matrix6 mount_inertia_;
  Vector6 stiffness_, damping_, weight_start_;
  Vector6 d_{Vector6::Zero()}, rate_{Vector6::Zero()}, acceleration_{Vector6::Zero()};
  Vector6 momentum_{Vector6::Zero()};  ///< of base and arm
};

}  // namespace osteon::hil
