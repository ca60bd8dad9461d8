#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// A tool's pose relative to the bone at one moment.
struct MotionSample {
  double time_s{0.0};
  Vector3 p_GT_m{Vector3::Zero()};
  Eigen::Quaterniond R_GT{Eigen::Quaterniond::Identity()};
  double spindle_rad_per_s{0.0};  ///< spindle speed from this sample to the next one
};

/// Origin of a motion: one line of text each.
struct MotionOrigin {
  std::string made_by;  ///< person or program that held the tool
  std::string scene, cell, tool;
  std::string engine;   ///< engine that computed the force on the hand
  std::string clock;    ///< virtual or wall time
  std::string command;  ///< command that makes the file again
  std::string error;    ///< error of the curve through the samples against the recording
};

/// A recorded motion of a tool; motion_player.h plays it.
struct ToolMotion {
  MotionOrigin origin;
  std::vector<MotionSample> samples;  ///< at least two; the first at time 0, times ascend strictly
};

/// Largest number of rows in a motion file.
inline constexpr std::size_t kMaxMotionRows = 200'000;

/// Text of a motion file: a first line "# osteon motion 1", the origin in comment lines "# key: value", a
/// line that names the columns, and one row per sample:
///
///     time_s,x_mm,y_mm,z_mm,q_w,q_x,q_y,q_z,spindle_rpm
///
/// The pose is that of T in G. Times are rounded to 1 us, positions to 0.1 um, the unit quaternion to 1e-7,
/// the spindle to 0.001 rpm. Line breaks in the origin become spaces.
[[nodiscard]] std::string MotionText(const ToolMotion& motion);

/// Rounds a sample as a file stores it.
[[nodiscard]] MotionSample Rounded(const MotionSample& sample);

/// Reads a text in the form of MotionText. An error names `name`, the line, the value and what is accepted.
/// Accepted are up to 16 MiB, 200 000 rows and 10 h; positions within ±10 m; quaternions of length 1 to
/// within 1e-5; 0 … 500 000 rpm; from row to row a mean speed of at most 5 m/s and a turn of at most 90
/// degrees.
[[nodiscard]] tl::expected<ToolMotion, std::string> ParseMotion(const std::string& text,
                                                                const std::string& name);

/// Reads a motion file as ParseMotion does.
[[nodiscard]] tl::expected<ToolMotion, std::string> LoadMotion(const std::filesystem::path& path);

}  // namespace osteon::simulation
