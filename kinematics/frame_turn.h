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

/// The rotation Rx(alpha) Rz(theta) from a joint's frame to the previous joint's frame. It needs eight
/// products per vector; a matrix would need nine, and has to be made first. Rotates one vector (Scalar
/// double) or two at once (Pair).
struct FrameTurn {
  double cos_alpha, sin_alpha, cos_theta, sin_theta;

  /// Transforms a vector from the parent's axes to the child's.
  template <class Scalar>
  [[gnu::always_inline]] Triple<Scalar> ToChild(const Triple<Scalar>& v) const {
    const Scalar y = cos_alpha * v.y + sin_alpha * v.z;
    return {cos_theta * v.x + sin_theta * y, cos_theta * y - sin_theta * v.x,
            cos_alpha * v.z - sin_alpha * v.y};
  }

  /// Transforms a vector from the child's axes to the parent's.
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

  /// Transforms the matrix to the parent's axes: R A R^T, one plane rotation after the other.
  [[gnu::always_inline]] void ToParent(const FrameTurn& T) {
    Turn(T.cos_theta, T.sin_theta, xx, yy, xy, xz, yz);
    Turn(T.cos_alpha, T.sin_alpha, yy, zz, yz, xy, xz);
  }

 private:
  // Rotates the matrix in the plane of two axes a, b; c is the third axis.
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
