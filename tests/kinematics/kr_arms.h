#pragma once

#include <array>
#include <numbers>

#include "kinematics/ortho_parallel_params.h"

namespace osteon::kinematics {

namespace detail {
// A KR arm from its lengths [m] and, for A1 to A6, lower limit, upper limit [deg] and speed limit [deg/s].
inline OrthoParallelParams Kr(const std::array<double, 7>& a1_a2_b_c1_c2_c3_c4_m,
                              const std::array<std::array<double, 3>, 6>& lower_upper_deg_speed) {
  constexpr double rad = std::numbers::pi / 180.0;
  const auto& length = a1_a2_b_c1_c2_c3_c4_m;
  OrthoParallelParams params{.a1_m = length[0],
                             .a2_m = length[1],
                             .b_m = length[2],
                             .c1_m = length[3],
                             .c2_m = length[4],
                             .c3_m = length[5],
                             .c4_m = length[6],
                             .offset_rad = {0.0, -90.0 * rad, 0.0, 0.0, 0.0, 0.0},
                             .sign = {-1.0, 1.0, 1.0, -1.0, 1.0, -1.0},
                             .limits = {}};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& row = lower_upper_deg_speed[i];
    params.limits[i] = {
        .lower_rad = row[0] * rad, .upper_rad = row[1] * rad, .velocity_rad_per_s = row[2] * rad};
  }
  return params;
}
}  // namespace detail

/// KR 6 R900-2 and KR 16-2: kuka_experimental's figures, limits of KUKA's data sheets.
inline OrthoParallelParams Kr6R900Params() {
  return detail::Kr({.025, -.025, .0, .400, .455, .420, .090}, {{{-170, 170, 360},
                                                                 {-190, 45, 300},
                                                                 {-120, 156, 360},
                                                                 {-185, 185, 450},
                                                                 {-120, 120, 450},
                                                                 {-350, 350, 540}}});
}
inline OrthoParallelParams Kr16Params() {
  return detail::Kr({.26, -.035, .0, .675, .68, .67, .158}, {{{-185, 185, 156},
                                                              {-155, 35, 156},
                                                              {-130, 154, 156},
                                                              {-350, 350, 330},
                                                              {-130, 130, 330},
                                                              {-350, 350, 615}}});
}

/// An invented arm with all lengths different from zero, so that the plane of its links does not contain A1's
/// axis, with offsets of the joint angles, and with other signs than a KR arm.
inline OrthoParallelParams CrookedArmParams() {
  OrthoParallelParams params = Kr16Params();
  params.a1_m = -0.1;
  params.b_m = 0.07;
  params.a2_m = 0.05;
  params.offset_rad = {0.0, 0.3, -1.1, 0.7, -0.4, 2.1};
  params.sign = {1.0, -1.0, 1.0, 1.0, -1.0, 1.0};
  return params;
}

}  // namespace osteon::kinematics
