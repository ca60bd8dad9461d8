#pragma once

#include <array>

#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

namespace osteon::kinematics {

/// Geometry and limits of a six-axis arm with ortho-parallel basis and spherical wrist (KUKA KR and most
/// other industrial arms): A1 vertical, A2 and A3 parallel to each other and perpendicular to it, A4 A5 A6
/// meet in the wrist. With theta_i = sign_i q_i - offset_i
///
///     X_BF = Rz(theta1) T(a1, b, c1) Ry(theta2) Tz(c2) Ry(theta3) T(a2, 0, c3) Rz(theta4) Ry(theta5)
///            Rz(theta6) Tz(c4)
///
/// Lengths, offsets and signs as in Brandstötter, Angerer, Hofbaur, An Analytical Solution of the Inverse
/// Kinematics Problem of Industrial Serial Manipulators with an Ortho-parallel Basis and a Spherical Wrist,
/// Austrian Robotics Workshop 2014. No defaults: a robot's file gives them.
struct OrthoParallelParams {
  double a1_m{0.0};  ///< distance of A2 in front of A1
  double a2_m{0.0};  ///< offset of A4 from A3 across the forearm; mostly < 0, which puts A4 above A3 if the
                     ///< forearm points forward
  double b_m{0.0};   ///< sideways offset of the arm's plane from A1
  double c1_m{0.0};  ///< height of A2 above the base
  double c2_m{0.0};  ///< A2 to A3, > 0
  double c3_m{0.0};  ///< A3 to the wrist along A4, > 0
  double c4_m{0.0};  ///< wrist to flange
  std::array<double, 6> offset_rad{};
  std::array<double, 6> sign{1.0, 1.0, 1.0, 1.0, 1.0, 1.0};  ///< each 1 or -1
  /// Positions within -2 pi … 2 pi: a joint position may have several equivalent values.
  std::array<JointLimits, 6> limits{};
};

/// Describes the same arm joint by joint: link frames at the joints, turned by the offsets. No masses.
[[nodiscard]] ChainParams<6> ChainFrom(const OrthoParallelParams& params);

/// Derives the seven lengths, offsets and signs from an arm described joint by joint, after checking its axes
/// at zero: A1 is z of B, A2 and A3 lie along y of B (either sign), A4 A5 A6 meet in a point, A4 is
/// perpendicular to A3, A5 to A4 and A6, and the flange looks along A6. Deviations of up to 1e-9 m and 1e-9
/// rad are accepted. If two descriptions of the wrist fit, the one with |theta4| <= 90 deg is returned.
/// @throws std::invalid_argument naming what deviates and by how much.
[[nodiscard]] OrthoParallelParams OrthoParallelParamsFrom(const ChainParams<6>& chain);

}  // namespace osteon::kinematics
