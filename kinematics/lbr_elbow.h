#pragma once

#include <algorithm>
#include <cmath>

#include "base/marker.h"
#include "kinematics/lbr_params.h"
#include "kinematics/spatial.h"
#include "kinematics/two_links.h"

// Geometry of an LBR's elbow for a given wrist position. LbrArm::Solve and FindArmAngleIntervals use it.
//
//           E            the triangle shoulder S, elbow E, wrist W is rigid; it turns about SW by the arm
//        u / \ f         angle psi. In its plane: axis a along SW, e toward the elbow; m = a x e its normal.
//         /   \              e = cos(psi) up + sin(psi) side       m = cos(psi) side - sin(psi) up
//        S-----W             u = cos(alpha) a + sin(alpha) e       f = cos(beta) a - sin(beta) e
//           a            with alpha + beta = |q4|; d = m x u points out of the elbow.

namespace osteon::kinematics {

/// The circle's frame: `axis` from shoulder to wrist, `up` to the circle's highest point (+x of B if the axis
/// is vertical), `side` = axis x up.
struct ElbowCircle {
  Vector3 axis, up, side;
};

/// Frame of the elbow's circle, for the unit axis from shoulder to wrist.
inline ElbowCircle CircleAround(const Vector3& axis) OSTEON_RT {
  // if the sine between axis and vertical is smaller, the circle has no highest point
  constexpr double kVertical = 1e-9;
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
  double out_of_reach_m;              ///< as LbrSolutions::out_of_reach_m; if 0 the rest is set
  double cos_shoulder, sin_shoulder;  ///< of alpha, the angle at the shoulder, 0 … pi
  double cos_elbow, sin_elbow;        ///< of |q4|, 0 … pi
};

/// Solves the triangle for a wrist at p_SW from the shoulder.
inline ElbowTriangle TriangleTo(const LbrParams& params, const Vector3& p_SW) OSTEON_RT {
  const double upper = params.shoulder_to_elbow_m, fore = params.elbow_to_wrist_m, reach = p_SW.norm();
  const TwoLinks links = SolveTwoLinks(upper, fore, reach);
  ElbowTriangle t;
  t.out_of_reach_m = links.out_of_reach_m;
  if (links.out_of_reach_m != 0.0) return t;
  t.cos_elbow = links.cos_elbow;
  t.sin_elbow = links.sin_elbow;
  if (reach == 0.0) {  // the two links are equally long and folded together, so any direction will do
    t.axis = Vector3::UnitZ();
    t.cos_shoulder = 1.0;
    t.sin_shoulder = 0.0;
    return t;
  }
  t.axis = p_SW / reach;
  const double across = 2.0 * reach * upper;
  t.cos_shoulder = std::clamp((reach * reach + (upper - fore) * (upper + fore)) / across, -1.0, 1.0);
  t.sin_shoulder = std::min(1.0, links.four_areas_m2 / across);
  return t;
}

/// Position of an LBR's wrist relative to its shoulder, in B.
inline Vector3 ShoulderToWrist(const LbrParams& params, const Pose& X_BF) OSTEON_RT {
  Vector3 p_SW = X_BF.translation() - params.wrist_to_flange_m * X_BF.linear().col(2);
  p_SW.z() -= params.base_to_shoulder_m;
  return p_SW;
}

}  // namespace osteon::kinematics
