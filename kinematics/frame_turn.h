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

/// A symmetric 3x3 matrix of any kind of number.
template <class Scalar>
struct Symmetric {
  Scalar xx{}, yy{}, zz{}, xy{}, xz{}, yz{};

  /// The same in the parent's axes: R A R^T, turned in one plane after the other.
  [[gnu::always_inline]] void ToParent(const FrameTurn& T) {
    Turn(T.cos_theta, T.sin_theta, xx, yy, xy, xz, yz);
    Turn(T.cos_alpha, T.sin_alpha, yy, zz, yz, xy, xz);
  }

 private:
  // In the plane of two axes a, b, the third being c.
  [[gnu::always_inline]] static void Turn(double cos, double sin, Scalar& aa, Scalar& bb, Scalar& ab,
                                          Scalar& ac, Scalar& bc) {
    const double cs = cos * sin, ss = sin * sin;
    const Scalar sum = aa + bb;
    const Scalar shift = ss * (bb - aa) - 2.0 * cs * ab;  // c^2 aa - 2 c s ab + s^2 bb = aa + shift
    ab += cs * (aa - bb) - 2.0 * ss * ab;
    aa += shift;
    bb = sum - aa;
    const Scalar before = ac;
    ac = cos * before - sin * bc;
    bc = sin * before + cos * bc;
  }
};

}  // namespace osteon::kinematics
