#pragma once

#include <array>
#include <cstdint>

#include "base/marker.h"
#include "kinematics/ortho_parallel_params.h"
#include "kinematics/serial_chain.h"
#include "kinematics/spatial.h"

namespace osteon::kinematics {

/// One posture for a pose.
struct OrthoParallelSolution {
  /// Joint positions [rad]. A joint has equivalent values 2 pi apart: this is the value within its limits
  /// that is nearest to zero, or, if none is within, the value that is least beyond them.
  JointVectorN<6> q{JointVectorN<6>::Zero()};
  double beyond_rad{0.0};  ///< how far the worst joint is outside its limits; 0 if all are within
  int worst_joint{-1};     ///< 0 … 5, the joint with beyond_rad; -1 if all are within
  std::uint8_t beyond{0};  ///< bit i: joint i is outside its limits
  bool exists{false};      ///< false: this side of the base does not reach the wrist; nothing else is set

  [[nodiscard]] bool valid() const noexcept { return exists && beyond == 0; }
};

/// All postures of a pose.
struct OrthoParallelSolutions {
  static constexpr int kConfigurations = 8;

  /// By configuration number (OrthoParallelArm::Configuration).
  std::array<OrthoParallelSolution, kConfigurations> configuration;
  /// Distance of the wrist's centre from the nearest place that it can reach: > 0 too far, < 0 too near, 0
  /// reachable, NaN if the pose is not finite. Exact for b = 0.
  double out_of_reach_m{0.0};

  [[nodiscard]] bool reachable() const noexcept { return out_of_reach_m == 0.0; }
};

/// A six-axis arm with ortho-parallel basis and spherical wrist; closed-form inverse. Allocation-free.
class OrthoParallelArm {
 public:
  static constexpr int kJoints = 6;
  using Joints = JointVectorN<6>;

  /// @throws std::invalid_argument where a length, a sign or a limit is out of range, naming it.
  explicit OrthoParallelArm(const OrthoParallelParams& params);

  [[nodiscard]] const OrthoParallelParams& params() const noexcept { return params_; }

  /// X_BF at joint positions q [rad].
  [[nodiscard]] Pose FlangePose(const Joints& q) const OSTEON_RT { return chain_.FlangePose(q); }
  /// Geometric Jacobian of the flange's point p_F [m, in F]: rows v (3) then w (3), in B.
  [[nodiscard]] JacobianN<6> JacobianAt(const Joints& q, const Vector3& p_F) const OSTEON_RT;

  /// The flange's pose, and the elbow in B [m], where the axis of A3 crosses the arm's plane.
  struct ArmPoints {
    Pose X_BF;
    Vector3 p_BElbow;
  };
  [[nodiscard]] ArmPoints Points(const Joints& q) const OSTEON_RT {
    const SerialChain<6>::Posture posture = chain_.ComputePosture(q);
    return {.X_BF = posture.X_BF, .p_BElbow = posture.p_BL[2]};
  }

  /// Configuration number 0 … 7: bit 0 if the wrist is behind A1 (overhead, KUKA's S bit 0), bit 1 if the
  /// forearm bends back (theta3 + atan(a2/c3) < 0), bit 2 if theta5 < 0.
  [[nodiscard]] int Configuration(const Joints& q) const OSTEON_RT;

  /// Every posture that puts the flange at X_BF: four postures of the main axes, each with two of the wrist.
  ///
  /// In the plane of the arm the two links are a triangle: with gamma = theta3 + atan(a2/c3), k =
  /// hypot(a2, c3) and the wrist at (x, z) from A2,
  ///
  ///     16 area^2 = ((c2 + k)^2 - s^2) (s^2 - (c2 - k)^2),  s^2 = x^2 + z^2     gives sin(gamma)
  ///     exp(i theta2) = (z + i x) (c2 + k exp(-i gamma)) / s^2
  ///
  /// Sines and cosines come from components as in LbrArm::Solve: the pose is exact to rounding next to a
  /// singularity. The flipped wrist is the other one turned by pi.
  /// @param seed value of a joint that a singularity leaves free (A1 with the wrist above it, A4 with the
  ///   wrist straight; in the flipped wrist A4 is half a turn away).
  /// Source: Brandstötter et al. 2014 (ortho_parallel_params.h); the complex form and the half-angle products
  /// instead of its arccosines, which lose half the digits where the arm is straight.
  [[nodiscard]] OrthoParallelSolutions Solve(const Pose& X_BF,
                                             const Joints& seed = Joints::Zero()) const OSTEON_RT;

  /// Finds the joint positions nearest to `seed` (by the sum of squared joint differences) of all valid
  /// solutions and all their equivalents 2 pi apart that the limits allow. False, with q unchanged, if there
  /// are none or the seed is not finite. `q` may be the same object as `seed`.
  [[nodiscard]] bool Nearest(const OrthoParallelSolutions& solutions, const Joints& seed,
                             Joints& q) const OSTEON_RT;

  /// Nearest(Solve(X_BF, seed), seed, q).
  [[nodiscard]] bool Inverse(const Pose& X_BF, const Joints& seed, Joints& q) const OSTEON_RT;

 private:
  void SetPair(const std::array<double, 6>& theta, OrthoParallelSolution& straight,
               OrthoParallelSolution& flipped) const OSTEON_RT;

  OrthoParallelParams params_;
  SerialChain<6> chain_;
  double fore_m_, fore_rad_;  // k = hypot(a2, c3), atan(a2/c3)
};

}  // namespace osteon::kinematics
