#pragma once

#include <algorithm>
#include <cmath>

#include "base/marker.h"
#include "kinematics/spatial.h"

// Shared by the closed-form inverses: two links that meet in an elbow, and a wrist whose three axes meet.

namespace osteon::kinematics {

/// Sine (or length [m]) below which a direction does not determine the angle about its axis: a free joint.
inline constexpr double kFreeJoint = 1e-12;

/// The triangle of two links and the line between their far ends.
struct TwoLinks {
  double out_of_reach_m{0.0};  ///< > 0 too far, < 0 too near, else 0 (NaN if the reach is)
  double cos_elbow{1.0},
      sin_elbow{0.0};         ///< how far the elbow is bent, 0 … pi: set where out_of_reach_m is 0
  double four_areas_m2{0.0};  ///< four times the triangle's area
};

/// Solves the triangle by Heron's product, which keeps the sine's relative accuracy if the links are straight
/// or folded; the cosine rule's arccosine would lose half the digits.
inline TwoLinks SolveTwoLinks(double upper_m, double fore_m, double reach_m) OSTEON_RT {
  constexpr double kSlack_m = 1e-12;  // rounding of a stretched arm's own forward kinematics
  const double max_reach = upper_m + fore_m, difference = upper_m - fore_m, min_reach = std::abs(difference);
  TwoLinks links;
  links.out_of_reach_m = reach_m > max_reach + kSlack_m   ? reach_m - max_reach
                         : reach_m < min_reach - kSlack_m ? reach_m - min_reach
                                                          : reach_m - reach_m;  // 0, or NaN for NaN
  if (links.out_of_reach_m != 0.0) return links;
  // a reach within rounding of straight counts as straight: it determines the elbow to 1e-7 rad only, which
  // would turn the free joint of a wrist that is straight as well; the wrist moves by 1e-15 m
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
/// measured from the axes after the rounded turn, so that the product keeps R to rounding for every wrist,
/// however straight.
/// @param free_turn the turn to use if the wrist is straight.
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
