#pragma once

#include <array>

#include "base/marker.h"
#include "kinematics/serial_chain.h"

namespace osteon::hil {

/// Parameters of the arm's mount. All values are assumed. A steel pedestal has a stiffness near 5e6 N/m, a
/// cart on locked castors a far lower one.
struct FlexibleMountParams {
  double stiffness_N_per_m{2e6};     ///< along each of B's axes x, y, z; > 0
  double stiffness_Nm_per_rad{5e5};  ///< about each of B's axes, at B's origin; > 0
  /// Damping ratio of each direction alone, with the arm in its posture at the start.
  double damping_ratio{0.05};
  double mass_kg{20.0};       ///< moving mass of the mount, without the arm's links; > 0
  double inertia_kg_m2{1.0};  ///< about B's origin; > 0
};

/// A base on springs and dampers that the moving arm shakes. d is the small displacement of B, 3 translations
/// and 3 rotations:
///
///     d/dt ((M_mount + M_arm) d' + H) + D d' + K d = W - W_start
///
/// M_arm is the arm's inertia about B's origin in its present posture, H the momentum of the joints' motion,
/// W the wrench of gravity and external loads, W_start its value at the start. The base's acceleration acts
/// on the links like a gravity field. The effects of the base's rotation on the links (Coriolis, centrifugal)
/// are neglected, and the axes are those of the unrotated B. Starts at rest with zero displacement, because W
/// - W_start excludes the arm's weight at the start.
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
    Wrench F_B{};                  ///< its force acts at the point p_B of frame B
    Vector3 p_B{Vector3::Zero()};  ///< [m]
  };
  void Step(const kinematics::SerialChain<7>& chain, const Input& input, double dt_s) OSTEON_RT;

  /// Joint torques [N·m] that the drives must add because the base accelerates.
  [[nodiscard]] Joints Torques(const kinematics::SerialChain<7>& chain, const Joints& q) const OSTEON_RT;

  [[nodiscard]] Pose X_BBnow() const OSTEON_RT;
  [[nodiscard]] const Vector6& displacement() const OSTEON_RT { return d_; }  ///< [m, rad]
  [[nodiscard]] const Vector6& rate() const OSTEON_RT { return rate_; }       ///< [m/s, rad/s]

 private:
  // Sums over the arm's links: inertia as one rigid body about B's origin, momentum of the joints' motion,
  // and wrench of the weight.
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
  Vector6 momentum_{Vector6::Zero()};  ///< total momentum of base and arm
};

}  // namespace osteon::hil
