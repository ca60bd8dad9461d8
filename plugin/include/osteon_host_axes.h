// osteon_host_axes.h: conversion to a host's axes and units. Header-only, C++17.
//
//     p_host = units_per_m · P · p        places, velocities
//     d_host = P · d                      directions, forces (N)
//     a_host = det(P) · P · a             axial: torques (N·m), angular velocities, quaternions' vector part
//
// P exchanges and mirrors axes: row i has `sign[i]` in column `from[i]`.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "osteon.h"

namespace osteon {
namespace host {

using Vector = std::array<double, 3>;

/// w x y z
using Quaternion = std::array<double, 4>;

struct Pose {
  Vector position{0.0, 0.0, 0.0};              ///< in the host's unit
  Quaternion orientation{1.0, 0.0, 0.0, 0.0};  ///< any length except 0
};

/// Axes and unit of a host.
struct Axes {
  std::array<std::size_t, 3> from;
  std::array<double, 3> sign;
  double units_per_m;
  /// Order of the corners a, b, c of a triangle that the host draws from outside: 1 if (b - a) × (c - a),
  /// computed by components in the host's axes, points outward, -1 if inward. For Osteon's triangles it is 1.
  int front;

  /// Returns 1 for right-handed axes (as Osteon's), -1 for left-handed axes.
  constexpr int Determinant() const {
    const bool is_cyclic = (from[0] + 1) % 3 == from[1] && (from[1] + 1) % 3 == from[2];
    return (is_cyclic ? 1 : -1) * (sign[0] * sign[1] * sign[2] > 0.0 ? 1 : -1);
  }
  /// Whether the order of a triangle's corners must be reversed for the host.
  constexpr bool TurnsTrianglesOver() const { return Determinant() != front; }
};

inline constexpr Axes kOsteon{{0, 1, 2}, {1.0, 1.0, 1.0}, 1.0, 1};
/// Godot: right-handed, +y up, metres; the corners of a visible triangle are clockwise.
inline constexpr Axes kGodot{{0, 2, 1}, {1.0, 1.0, -1.0}, 1.0, -1};
/// Unity: left-handed, +y up, metres. Unity's plug-in is in C# and has these values itself; they are here for
/// comparison.
inline constexpr Axes kUnity{{0, 2, 1}, {1.0, 1.0, 1.0}, 1.0, 1};
/// Unreal: left-handed, +z up, centimetres; the corners of a visible triangle are counter-clockwise.
inline constexpr Axes kUnreal{{0, 1, 2}, {1.0, -1.0, 1.0}, 100.0, -1};

inline Vector DirectionToHost(const Axes& axes, const Vector& v) {
  return {axes.sign[0] * v[axes.from[0]], axes.sign[1] * v[axes.from[1]], axes.sign[2] * v[axes.from[2]]};
}

inline Vector DirectionFromHost(const Axes& axes, const Vector& v) {
  Vector result{};
  for (std::size_t i = 0; i < 3; ++i) result[axes.from[i]] = axes.sign[i] * v[i];
  return result;
}

inline Vector Scaled(const Vector& v, double scale) { return {scale * v[0], scale * v[1], scale * v[2]}; }

inline Vector PositionToHost(const Axes& axes, const Vector& p_m) {
  return Scaled(DirectionToHost(axes, p_m), axes.units_per_m);
}

inline Vector PositionFromHost(const Axes& axes, const Vector& p) {
  return Scaled(DirectionFromHost(axes, p), 1.0 / axes.units_per_m);
}

/// Converts torques and angular velocities.
inline Vector AxialToHost(const Axes& axes, const Vector& v) {
  return Scaled(DirectionToHost(axes, v), axes.Determinant());
}

inline Vector AxialFromHost(const Axes& axes, const Vector& v) {
  return Scaled(DirectionFromHost(axes, v), axes.Determinant());
}

inline Quaternion RotationToHost(const Axes& axes, const Quaternion& q) {
  const Vector v = AxialToHost(axes, {q[1], q[2], q[3]});
  return {q[0], v[0], v[1], v[2]};
}

inline Quaternion RotationFromHost(const Axes& axes, const Quaternion& q) {
  const Vector v = AxialFromHost(axes, {q[1], q[2], q[3]});
  return {q[0], v[0], v[1], v[2]};
}

inline Pose PoseToHost(const Axes& axes, const OsteonPose& pose) {
  const double* p = pose.position_m;
  const double* q = pose.orientation_wxyz;
  return {PositionToHost(axes, {p[0], p[1], p[2]}), RotationToHost(axes, {q[0], q[1], q[2], q[3]})};
}

inline OsteonPose PoseFromHost(const Axes& axes, const Pose& pose) {
  const Vector p = PositionFromHost(axes, pose.position);
  const Quaternion q = RotationFromHost(axes, pose.orientation);
  return {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}};
}

/// Returns the rotation of a matrix that is given by its rows. The matrix may also contain a positive scale.
/// If it is sheared or mirrored, returns {0, 0, 0, 0}, which every function of osteon.h refuses.
inline Quaternion RotationOf(const std::array<Vector, 3>& rows) {
  std::array<Vector, 3> m = rows;
  for (std::size_t column = 0; column < 3; ++column) {
    const double length = std::hypot(rows[0][column], rows[1][column], rows[2][column]);
    if (!(length > 1e-9) || !std::isfinite(length)) return {0.0, 0.0, 0.0, 0.0};
    for (std::size_t row = 0; row < 3; ++row) m[row][column] /= length;
  }
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  if (!(determinant > 0.99)) return {0.0, 0.0, 0.0, 0.0};  // sheared, or mirrored
  // Shepperd's method: divides by the largest component
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (trace > 0.0) {
    const double s = 2.0 * std::sqrt(1.0 + trace);
    return {0.25 * s, (m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s};
  }
  const std::size_t i = m[0][0] > m[1][1] ? (m[0][0] > m[2][2] ? 0 : 2) : (m[1][1] > m[2][2] ? 1 : 2);
  const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
  const double s = 2.0 * std::sqrt(1.0 + m[i][i] - m[j][j] - m[k][k]);
  Quaternion q{};
  q[0] = (m[k][j] - m[j][k]) / s;
  q[1 + i] = 0.25 * s;
  q[1 + j] = (m[j][i] + m[i][j]) / s;
  q[1 + k] = (m[k][i] + m[i][k]) / s;
  return q;
}

/// Returns the rows of the rotation matrix of q, which must have length 1.
inline std::array<Vector, 3> RowsOf(const Quaternion& q) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return {Vector{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
          Vector{2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
          Vector{2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
}

/// Force [N] and torque [N·m] on the tool at its apex, in the host's axes.
struct Wrench {
  Vector force_N{0.0, 0.0, 0.0};
  Vector torque_Nm{0.0, 0.0, 0.0};
};

inline Wrench WrenchToHost(const Axes& axes, const OsteonWrench& wrench) {
  const double* f = wrench.force_N;
  const double* t = wrench.torque_Nm;
  return {DirectionToHost(axes, {f[0], f[1], f[2]}), AxialToHost(axes, {t[0], t[1], t[2]})};
}

inline OsteonWrench WrenchFromHost(const Axes& axes, const Wrench& wrench) {
  const Vector f = DirectionFromHost(axes, wrench.force_N), t = AxialFromHost(axes, wrench.torque_Nm);
  return {{f[0], f[1], f[2]}, {t[0], t[1], t[2]}};
}

/// Velocity of the tool at its apex, in the host's axes.
struct Twist {
  Vector linear{0.0, 0.0, 0.0};  ///< in the host's unit per second
  /// a point at r from the apex has the velocity linear + angular × r
  Vector angular_rad_per_s{0.0, 0.0, 0.0};
};

inline OsteonTwist TwistFromHost(const Axes& axes, const Twist& twist) {
  const Vector v = PositionFromHost(axes, twist.linear), w = AxialFromHost(axes, twist.angular_rad_per_s);
  return {{v[0], v[1], v[2]}, {w[0], w[1], w[2]}};
}

}  // namespace host
}  // namespace osteon
