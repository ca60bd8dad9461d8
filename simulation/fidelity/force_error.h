#pragma once

#include <span>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// Force and torque on the hand in one frame, in W. The torque is about T's origin.
struct FeltForce {
  Vector3 f_N{Vector3::Zero()};
  Vector3 t_Nm{Vector3::Zero()};
};

/// Errors of a measured force against the exact force, over a path. The normal is the direction of the force.
/// A frame has no normal if one of the two forces is below a thousandth of the largest exact force; such a
/// frame counts only for the errors of force and torque.
struct ForceErrors {
  double force_rms_N{0.0};
  double force_relative{0.0};  ///< force_rms_N over the rms of the exact force
  double torque_rms_Nm{0.0};
  double normal_rms_deg{0.0}, normal_max_deg{0.0};
  /// Largest change of the error between two consecutive frames, divided by the time between the frames.
  double force_jump_N_per_ms{0.0}, torque_jump_Nm_per_ms{0.0}, normal_jump_deg_per_ms{0.0};
  bool touched{true};  ///< false: the measured force is zero on the whole path, but the exact force is not
};

/// Compares two forces frame by frame.
/// @param measured, exact  forces in the same frames: equally many
/// @param rate_hz  number of frames per second
/// @throws std::invalid_argument if the numbers differ or the rate is not positive.
[[nodiscard]] ForceErrors CompareForces(std::span<const FeltForce> measured, std::span<const FeltForce> exact,
                                        double rate_hz);

}  // namespace osteon::simulation
