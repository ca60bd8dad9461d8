#pragma once

#include <array>

#include <Eigen/Geometry>

#include "base/marker.h"

// Spatial types, and the letters of the frames. The notation is Drake's monogram notation: X_AB is the pose
// of frame B in frame A, p_AB_C the position from A's origin to B's expressed in C, so X_AC = X_AB * X_BC
// checks by matching letters.
//
//   W  world                     T  tool: origin at the apex, +z the feed direction
//   B  robot base                D  desired tool pose
//   F  flange                    P  proxy: the tool's collision-free pose
//   S  force sensor              G  packing (the bone)
//   H  handle                    C  cup: origin at the centre of its sphere, +z out of the opening
//
// SI throughout: metres, radians, seconds, newtons, newton metres, kilograms.

namespace osteon {

// Almost every source file includes this header, so an Eigen expression here would be compiled some seventy
// times. The inline functions therefore access single coefficients only. Functions that need Eigen
// expressions are in spatial.cpp.

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Pose = Eigen::Isometry3d;

/// Velocity of a frame.
struct Twist {
  Vector3 v{0.0, 0.0, 0.0};  ///< linear [m/s]
  Vector3 w{0.0, 0.0, 0.0};  ///< angular [rad/s]
};

/// Force and torque on a frame's origin.
struct Wrench {
  Vector3 f{0.0, 0.0, 0.0};  ///< force [N]
  Vector3 t{0.0, 0.0, 0.0};  ///< torque [N·m]
};

/// A Vector3 that is trivially copyable (Eigen's is not), for data that crosses a thread or goes to disk.
struct PlainVector3 {
  double x{0.0}, y{0.0}, z{0.0};

  PlainVector3() = default;
  PlainVector3(double x_in, double y_in, double z_in) : x(x_in), y(y_in), z(z_in) {}
  template <class Derived>
  PlainVector3(const Eigen::MatrixBase<Derived>& v)
      : x(v(0)), y(v(1)), z(v(2)) {}              // NOLINT: conversion is the point
  operator Vector3() const { return {x, y, z}; }  // NOLINT
};

/// A Pose that is trivially copyable; R is stored row by row.
struct PlainPose {
  std::array<double, 9> R{1, 0, 0, 0, 1, 0, 0, 0, 1};
  PlainVector3 p;

  PlainPose() = default;
  PlainPose(const Pose& X) : p(X(0, 3), X(1, 3), X(2, 3)) {  // NOLINT: conversion is the point
    for (int i = 0; i < 9; ++i) R[static_cast<std::size_t>(i)] = X(i / 3, i % 3);
  }
  operator Pose() const {  // NOLINT
    Pose X;
    for (int i = 0; i < 9; ++i) X(i / 3, i % 3) = R[static_cast<std::size_t>(i)];
    X(0, 3) = p.x, X(1, 3) = p.y, X(2, 3) = p.z;
    X.makeAffine();
    return X;
  }
};

/// A symmetric Matrix3 that is trivially copyable, such as an inertia [kg·m²]: the elements of the matrix, so
/// that xy is minus the product of inertia.
struct PlainInertia {
  double xx{0.0}, yy{0.0}, zz{0.0}, xy{0.0}, xz{0.0}, yz{0.0};

  PlainInertia() = default;
  PlainInertia(const Matrix3& I)  // NOLINT: conversion is the point
      : xx(I(0, 0)), yy(I(1, 1)), zz(I(2, 2)), xy(I(0, 1)), xz(I(0, 2)), yz(I(1, 2)) {}
  operator Matrix3() const {  // NOLINT
    Matrix3 I;
    I(0, 0) = xx, I(0, 1) = xy, I(0, 2) = xz;
    I(1, 0) = xy, I(1, 1) = yy, I(1, 2) = yz;
    I(2, 0) = xz, I(2, 1) = yz, I(2, 2) = zz;
    return I;
  }
};

/// A Wrench that is trivially copyable.
struct PlainWrench {
  PlainVector3 f, t;

  PlainWrench() = default;
  PlainWrench(const Wrench& F) : f(F.f), t(F.t) {}      // NOLINT: conversion is the point
  operator Wrench() const { return {.f = f, .t = t}; }  // NOLINT
};

/// Rotation vector (axis times angle, |.| <= pi) of a rotation matrix. At an angle of pi the sign is
/// arbitrary.
[[nodiscard]] Vector3 LogRotation(const Matrix3& R) OSTEON_RT;

/// Rotation matrix of a rotation vector; the identity for zero.
[[nodiscard]] Matrix3 ExpRotation(const Vector3& r) OSTEON_RT;

/// Angle of a rotation matrix [rad], 0 … pi.
[[nodiscard]] double RotationAngle(const Matrix3& R) OSTEON_RT;

/// The smallest rotation that turns the +z axis into a direction; for -z, half a turn about x. `axis` need
/// not be a unit vector; it must not be zero.
[[nodiscard]] Matrix3 RotationFromZTo(const Vector3& axis);

}  // namespace osteon
