#pragma once

#include "kinematics/spatial.h"

namespace osteon::kinematics {

/// The turn Rx(alpha) Rz(theta) from a joint's frame to the one before: eight products a vector instead of
/// nine and a matrix to make.
struct FrameTurn {
  double cos_alpha, sin_alpha, cos_theta, sin_theta;

  /// What a vector in the parent's axes is in the child's.
  [[gnu::always_inline]] Vector3 ToChild(const Vector3& v) const {
    const double y = cos_alpha * v.y() + sin_alpha * v.z();
    return {cos_theta * v.x() + sin_theta * y, cos_theta * y - sin_theta * v.x(),
            cos_alpha * v.z() - sin_alpha * v.y()};
  }

  /// What a vector in the child's axes is in the parent's.
  [[gnu::always_inline]] Vector3 ToParent(const Vector3& v) const {
    const double y = sin_theta * v.x() + cos_theta * v.y();
    return {cos_theta * v.x() - sin_theta * v.y(), cos_alpha * y - sin_alpha * v.z(),
            sin_alpha * y + cos_alpha * v.z()};
  }
};

}  // namespace osteon::kinematics
