#pragma once

#include <array>

#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

namespace osteon::kinematics {

/// Geometry and limits of a KUKA LBR: spherical shoulder, revolute elbow, spherical wrist, no lateral
/// offsets. No defaults: a robot's file gives the values (LbrParamsFrom).
///
///     X_BF = Rz(q1) Tz(d_bs) Ry(q2) Rz(q3) Tz(d_se) R-y(q4) Rz(q5) Tz(d_ew) Ry(q6) Rz(q7) Tz(d_wf)
struct LbrParams {
  double base_to_shoulder_m{0.0};   ///< d_bs, any sign
  double shoulder_to_elbow_m{0.0};  ///< d_se, > 0
  double elbow_to_wrist_m{0.0};     ///< d_ew, > 0
  double wrist_to_flange_m{0.0};    ///< d_wf, any sign
  /// A1 … A7; positions within -pi … pi, so that every posture has one representation.
  std::array<JointLimits, 7> limits{};
};

/// Derives the four lengths from an arm described joint by joint, after checking that its axes are an LBR's:
/// at zero all axes lie along z, y, z, -y, z, y, z of B; A1 A2 A3 meet in the shoulder, A5 A6 A7 in the
/// wrist; shoulder, elbow and wrist lie on z of B, and the flange is aligned with B on that line. Deviations
/// of up to 1e-9 m and 1e-9 rad are accepted; the closed-form inverse then has this accuracy.
/// @throws std::invalid_argument naming the joint, what deviates and by how much.
[[nodiscard]] LbrParams LbrParamsFrom(const ChainParams<7>& chain);

/// Describes the same arm joint by joint: link frames on the line from base to flange, all aligned at zero.
/// No masses.
[[nodiscard]] ChainParams<7> ChainFrom(const LbrParams& params);

}  // namespace osteon::kinematics
