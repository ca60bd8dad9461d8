#pragma once

#include "kinematics/pair.h"
#include "kinematics/spatial.h"

namespace osteon::kinematics {

/// A 3-vector of any kind of number.
template <class Scalar>
struct Triple {
  Scalar x, y, z;

  [[gnu::always_inline]] Triple operator+(const Triple& o) const { return {x + o.x, y + o.y, z + o.z}; }
};

/// The turn Rx(alpha) Rz(theta) from a joint's frame to the one before: eight products a vector instead of
/// nine and a matrix to make. For one vector (Scalar double) or two at once (Pair).
struct FrameTurn {
  double cos_alpha, sin_alpha, cos_theta, sin_theta;

  /// What a vector in the parent's axes is in the child's.
  template <class Scalar>
  [[gnu::always_inline]] Triple<Scalar> ToChild(const Triple<Scalar>& v) const {
    const Scalar y = cos_alpha * v.y + sin_alpha * v.z;
    return {cos_theta * v.x + sin_theta * y, cos_theta * y - sin_theta * v.x,
            cos_alpha * v.z - sin_alpha * v.y};
  }

  /// What a vector in the child's axes is in the parent's.
  template <class Scalar>
  [[gnu::always_inline]] Triple<Scalar> ToParent(const Triple<Scalar>& v) const {
    const Scalar y = sin_theta * v.x + cos_theta * v.y;
    return {cos_theta * v.x - sin_theta * v.y, cos_alpha * y - sin_alpha * v.z,
            sin_alpha * y + cos_alpha * v.z};
  }

  [[gnu::always_inline]] Vector3 ToChild(const Vector3& v) const {
    const Triple<double> turned = ToChild(Triple<double>{v.x(), v.y(), v.z()});
    return {turned.x, turned.y, turned.z};
  }

  [[gnu::always_inline]] Vector3 ToParent(const Vector3& v) const {
    const Triple<double> turned = ToParent(Triple<double>{v.x(), v.y(), v.z()});
    return {turned.x, turned.y, turned.z};
  }
};

}  // namespace osteon::kinematics
