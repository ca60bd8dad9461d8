#pragma once

#include <algorithm>
#include <cmath>

#include "control/rt/marker.h"
#include "kinematics/lbr_params.h"
#include "kinematics/spatial.h"

// Where an LBR's elbow can be for a given wrist: what the inverse and the intervals of the arm angle share.
//
//           E            the triangle shoulder S, elbow E, wrist W is rigid; it turns about SW by the arm
//        u / \ f         angle psi. In its plane: axis a along SW, e toward the elbow; m = a x e its normal.
//         /   \              e = cos(psi) up + sin(psi) side       m = cos(psi) side - sin(psi) up
//        S-----W             u = cos(alpha) a + sin(alpha) e       f = cos(beta) a - sin(beta) e
//           a            with alpha + beta = |q4|; d = m x u points out of the elbow.

namespace osteon::kinematics {

/// The circle's frame: `axis` along shoulder to wrist, `up` to the circle's highest point (+x of B where the
/// axis is vertical), `side` = axis x up.
struct ElbowCircle {
  Vector3 axis, up, side;
};

inline ElbowCircle CircleAround(const Vector3& axis) OSTEON_RT {
  constexpr double kVertical = 1e-9;  // sine below which the line has no highest point around it
  const double h = std::sqrt(axis.x() * axis.x() + axis.y() * axis.y());
  if (h < kVertical) {
    const Vector3 up = (Vector3::UnitX() - axis.x() * axis).normalized();
    return {.axis = axis, .up = up, .side = axis.cross(up)};
  }
  const double cosine = axis.x() / h, sine = axis.y() / h;
  return {.axis = axis,
          .up = Vector3(-axis.z() * cosine, -axis.z() * sine, h),
          .side = Vector3(sine, -cosine, 0.0)};
}

/// Triangle of the two links and the line between shoulder and wrist.
struct ElbowTriangle {
  Vector3 axis;                       ///< from shoulder to wrist, unit
  double out_of_reach_m;              ///< as LbrSolutions::out_of_reach_m; the rest is set where it is 0
  double cos_shoulder, sin_shoulder;  ///< alpha, 0 … pi
  double cos_elbow, sin_elbow;        ///< |q4|, 0 … pi
};

/// Sines come from Heron's product, which keeps its relative accuracy where the arm is straight or folded.
inline ElbowTriangle TriangleTo(const LbrParams& params, const Vector3& p_SW) OSTEON_RT {
  constexpr double kSlack_m = 1e-12;  // rounding of a stretched arm's own forward kinematics
  const double upper = params.shoulder_to_elbow_m, fore = params.elbow_to_wrist_m;
  const double reach = p_SW.norm(), most = upper + fore, difference = upper - fore;
  ElbowTriangle t;
  if (reach > most + kSlack_m) {
    t.out_of_reach_m = reach - most;
    return t;
  }
  if (reach < std::abs(difference) - kSlack_m) {
    t.out_of_reach_m = reach - std::abs(difference);
    return t;
  }
  t.out_of_reach_m = reach - reach;  // 0, or not a number as the input
  t.axis = reach > 0.0 ? Vector3(p_SW / reach) : Vector3::UnitZ();
  // within rounding of straight it is straight: the reach decides the elbow to 1e-7 rad only, which would
  // turn the free joint of a wrist that is straight as well; the wrist moves by 1e-15 m
  const double from_most = (most - reach) * (most + reach);
  const double short_of_most = from_most < 4e-15 * most * most ? 0.0 : from_most;
  const double above_least = std::max(0.0, (reach - difference) * (reach + difference));
  const double four_areas = std::sqrt(short_of_most * above_least);
  const double across = reach > 0.0 ? 2.0 * reach * upper : 1.0;
  t.sin_shoulder = reach > 0.0 ? std::min(1.0, four_areas / across) : 0.0;
  t.cos_shoulder = reach > 0.0 ? std::clamp((reach * reach + difference * most) / across, -1.0, 1.0) : 1.0;
  t.sin_elbow = four_areas / (2.0 * upper * fore);
  t.cos_elbow = (above_least - short_of_most) / (4.0 * upper * fore);
  return t;
}

/// Sine below which a direction says nothing about the angle around the axis that it is measured from.
inline constexpr double kFreeJoint = 1e-12;

}  // namespace osteon::kinematics
