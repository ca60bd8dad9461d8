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
  /// Joint positions [rad]. Values of a joint that differ by 2 pi are equivalent. Stored is the one within
  /// the limits that is nearest to zero or, if none is within, the one that is least beyond them.
  JointVectorN<6> q{JointVectorN<6>::Zero()};
  double beyond_rad{0.0};  ///< how far the worst joint is outside its limits; 0 if all are within
  int worst_joint{-1};     ///< 0 … 5, the joint with beyond_rad; -1 if all are within
  std::uint8_t beyond{0};  ///< bit i: joint i is outside its limits
  bool exists{false};  ///< false: the wrist cannot be reached in this configuration, and nothing else is set

  [[nodiscard]] bool valid() const noexcept { return exists && beyond == 0; }
};

/// All postures for a pose.
struct OrthoParallelSolutions {
  static constexpr int kConfigurations = 8;

  /// Index: configuration number (OrthoParallelArm::Configuration).
  std::array<OrthoParallelSolution, kConfigurations> configuration;
  /// Distance of the wrist's centre from the nearest reachable point: > 0 too far, < 0 too near, 0
  /// reachable, NaN if the pose is not finite. Exact for b = 0.
  double out_of_reach_m{0.0};

  [[nodiscard]] bool reachable() const noexcept { return out_of_reach_m == 0.0; }
};

/// A six-axis arm with ortho-parallel basis and spherical wrist; closed-form inverse. Allocation-free.
class OrthoParallelArm {
 public:
  static constexpr int kJoints = 6;
  using Joints = JointVectorN<6>;

  /// @throws std::invalid_argument naming the length, the sign or the limit that is out of range.
  explicit OrthoParallelArm(const OrthoParallelParams& params);

  [[nodiscard]] const OrthoParallelParams& params() const noexcept { return params_; }

  /// X_BF at joint positions q [rad].
  [[nodiscard]] Pose FlangePose(const Joints& q) const OSTEON_RT { return chain_.FlangePose(q); }
  /// Geometric Jacobian, in B, of a point of the flange: rows v (3) then w (3). @param p_F  the point in F
  /// [m]
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

  /// Configuration number 0 … 7: bit 0 if the wrist is behind A1 (overhead; bit 0 of KUKA's status S), bit 1
  /// if the forearm bends back (theta3 + atan(a2/c3) < 0), bit 2 if theta5 < 0.
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
  /// singularity. In the flipped wrist theta5 has the opposite sign, and theta4 and theta6 are pi away.
  /// @param seed value of a joint that a singularity leaves free (A1 with the wrist above it, A4 with the
  ///   wrist straight; in the flipped wrist A4 is half a turn away).
  /// Source: Brandstötter et al. 2014 (ortho_parallel_params.h); the complex form and the area product
  /// replace the paper's arccosines, which lose half the digits for a straight arm.
  [[nodiscard]] OrthoParallelSolutions Solve(const Pose& X_BF,
                                             const Joints& seed = Joints::Zero()) const OSTEON_RT;

  /// Finds the joint positions nearest to `seed` (by the sum of squared joint differences) among all valid
  /// solutions and their equivalents (joints shifted by 2 pi) within the limits. False, with q unchanged, if
  /// there are none or the seed is not finite. `q` may be the same object as `seed`.
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
