#pragma once

#include <span>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// Force and torque on the hand in a frame, in W; torque about T's origin.
struct FeltForce {
  Vector3 f_N{Vector3::Zero()};
  Vector3 t_Nm{Vector3::Zero()};
};

/// Errors of a felt force against the exact one, over a path. The normal is the force's direction. Frames in
/// which either force is below a thousandth of the largest exact force have no normal and count only for
/// force and torque.
struct ForceErrors {
  double force_rms_N{0.0};
  double force_relative{0.0};  ///< force_rms_N over the rms of the exact force
  double torque_rms_Nm{0.0};
  double normal_rms_deg{0.0}, normal_max_deg{0.0};
  /// Largest change between two frames beyond the exact force's own change, divided by the time between them.
  double force_jump_N_per_ms{0.0}, torque_jump_Nm_per_ms{0.0}, normal_jump_deg_per_ms{0.0};
  bool touched{true};  ///< false: no force on the whole path, although there should be one
};

/// Compares two forces frame by frame.
/// @param measured,exact  the same frames, of the same number
/// @param rate_hz  of the frames
/// @throws std::invalid_argument where the numbers differ or the rate is not positive.
[[nodiscard]] ForceErrors CompareForces(std::span<const FeltForce> measured, std::span<const FeltForce> exact,
                                        double rate_hz);

}  // namespace osteon::simulation
