#pragma once

#include <span>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// What a frame gave the hand, in W; torque about T's origin.
struct FeltForce {
  Vector3 f_N{Vector3::Zero()};
  Vector3 t_Nm{Vector3::Zero()};
};

/// How far a felt force is off the exact one, over a path. The normal is the force's direction; frames where
/// either force is below a thousandth of the exact ones' greatest have none and count for force and torque
/// alone.
struct ForceErrors {
  double force_rms_N{0.0};
  double force_relative{0.0};  ///< force_rms_N over the rms of the exact force
  double torque_rms_Nm{0.0};
  double normal_rms_deg{0.0}, normal_max_deg{0.0};
  /// Greatest change from a frame to the next, beyond the exact one's own, by the time between them.
  double force_jump_N_per_ms{0.0}, torque_jump_Nm_per_ms{0.0}, normal_jump_deg_per_ms{0.0};
  bool touched{true};  ///< false: no force where there should have been one, all along
};

/// @param measured,exact  the same frames, of the same number
/// @param rate_hz  of the frames
/// @throws std::invalid_argument where the numbers differ or the rate is not positive.
[[nodiscard]] ForceErrors CompareForces(std::span<const FeltForce> measured, std::span<const FeltForce> exact,
                                        double rate_hz);

/// Work along a path of tool poses, as the coupling does it on the tool: positive is energy that the hand
/// gets back.
///
///     W = sum (f_k + f_k+1)/2 · (p_k+1 - p_k) + (t_k + t_k+1)/2 · log(R_k+1 R_k^T)
struct PathWork {
  double given_J{0.0};  ///< by the coupling to the hand: the sum of the positive parts
  double taken_J{0.0};  ///< by the coupling from the hand: the sum of the negative ones, as a positive number
  /// Of a closed cycle: above zero where it made energy.
  [[nodiscard]] double net_J() const { return given_J - taken_J; }
};

/// @throws std::invalid_argument where the numbers differ.
[[nodiscard]] PathWork WorkAlong(std::span<const Pose> X_WT, std::span<const FeltForce> felt);

}  // namespace osteon::simulation
