#pragma once

#include <algorithm>
#include <cmath>

#include "base/marker.h"
#include "kinematics/spatial.h"

// Two parts that both closed-form inverses (LBR and KR) share: two links that meet in an elbow, and a wrist
// whose three axes meet in a point.

namespace osteon::kinematics {

/// If the component of a direction across a joint's axis (a sine, or a length in m) is smaller, it does not
/// determine the joint: the joint is free.
inline constexpr double kFreeJoint = 1e-12;

/// The triangle of two links and the line between their far ends.
struct TwoLinks {
  double out_of_reach_m{0.0};  ///< > 0 too far, < 0 too near, 0 reachable, NaN if the reach is NaN
  double cos_elbow{1.0},
      sin_elbow{0.0};         ///< of the elbow's bending angle, 0 … pi; set only if out_of_reach_m is 0
  double four_areas_m2{0.0};  ///< four times the triangle's area
};

/// Solves the triangle by Heron's formula, which keeps the sine's relative accuracy for straight or folded
/// links. The cosine rule with an arccosine would lose half the digits.
inline TwoLinks SolveTwoLinks(double upper_m, double fore_m, double reach_m) OSTEON_RT {
  constexpr double kSlack_m = 1e-12;  // rounding error of the forward kinematics of a stretched arm
  const double max_reach = upper_m + fore_m, difference = upper_m - fore_m, min_reach = std::abs(difference);
  TwoLinks links;
  links.out_of_reach_m = reach_m > max_reach + kSlack_m   ? reach_m - max_reach
                         : reach_m < min_reach - kSlack_m ? reach_m - min_reach
                                                          : reach_m - reach_m;  // 0, or NaN for NaN
  if (links.out_of_reach_m != 0.0) return links;
  // A reach within rounding of a straight arm is treated as straight. Rounding would otherwise bend the elbow
  // by 1e-7 rad, and if the wrist is straight as well, this would turn the wrist's free joint. The change
  // moves the wrist by 1e-15 m.
  const double from_max = (max_reach - reach_m) * (max_reach + reach_m);
  const double short_of_max = from_max < 4e-15 * max_reach * max_reach ? 0.0 : from_max;
  const double above_min = std::max(0.0, (reach_m - difference) * (reach_m + difference));
  links.four_areas_m2 = std::sqrt(short_of_max * above_min);
  links.cos_elbow = (above_min - short_of_max) / (4.0 * upper_m * fore_m);
  links.sin_elbow = links.four_areas_m2 / (2.0 * upper_m * fore_m);
  return links;
}

/// Angles of Rz(turn) Ry(tilt) Rz(twist), tilt 0 … pi. The same rotation with the tilt negated has turn and
/// twist each half a turn away.
struct WristAngles {
  double turn, tilt, twist;
};

/// Finds the angles that turn the frame of axes x, y, z into R, all expressed in one frame. The twist is
/// measured from the axes as turned by the rounded `turn`, so that the three rotations together give R to
/// rounding even for a nearly straight wrist.
/// @param free_turn  value of `turn` if the wrist is straight
inline WristAngles SolveWrist(const Vector3& x, const Vector3& y, const Vector3& z, const Matrix3& R,
                              double free_turn) OSTEON_RT {
  const double along_x = x.dot(R.col(2)), along_y = y.dot(R.col(2)), along_z = z.dot(R.col(2));
  const double sine = std::sqrt(along_x * along_x + along_y * along_y);
  WristAngles angles;
  Vector3 y_turned;
  if (sine < kFreeJoint) {
    angles = {.turn = free_turn, .tilt = std::atan2(0.0, along_z), .twist = 0.0};
    y_turned = std::cos(free_turn) * y - std::sin(free_turn) * x;
  } else {
    angles = {.turn = std::atan2(along_y, along_x), .tilt = std::atan2(sine, along_z), .twist = 0.0};
    y_turned = (along_x * y - along_y * x) / sine;
  }
  angles.twist = std::atan2(y_turned.dot(R.col(0)), y_turned.dot(R.col(1)));
  return angles;
}

}  // namespace osteon::kinematics
