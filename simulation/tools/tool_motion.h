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
  double spindle_rad_per_s{0.0};  ///< from here to the next sample
};

/// Where a motion comes from: one line of text each.
struct MotionOrigin {
  std::string made_by;  ///< who or what held the tool
  std::string scene, cell, tool;
  std::string engine;   ///< that the hand felt
  std::string clock;    ///< virtual or wall time
  std::string command;  ///< that makes the file again
  std::string error;    ///< of the curve through the samples against what was recorded
};

/// A recorded motion of a tool: what it is played with is in motion_player.h.
struct ToolMotion {
  MotionOrigin origin;
  std::vector<MotionSample> samples;  ///< at least two; the first at time 0, times ascend strictly
};

/// Rows that a motion file may have.
inline constexpr std::size_t kMostMotionRows = 200'000;

/// Text of a motion file: a first line "# osteon motion 1", the origin in comment lines "# key: value", a
/// line that names the columns, and a row a sample:
///
///     time_s,x_mm,y_mm,z_mm,q_w,q_x,q_y,q_z,spindle_rpm
///
/// T's origin and axes in G. Times are rounded to 1 us, positions to .1 um, the unit quaternion to 1e-7, the
/// spindle to .001 rpm. Line breaks in the origin become spaces.
[[nodiscard]] std::string MotionText(const ToolMotion& motion);

/// The sample as it comes back from a file.
[[nodiscard]] MotionSample Rounded(const MotionSample& sample);

/// Reads what MotionText wrote. The error names the name, the line, the value and what is accepted: up to 16
/// MiB, 200 000 rows and 10 h; positions within ±10 m; quaternions of length 1 to within 1e-5; 0 … 500 000
/// rpm; from row to row at most 5 m/s in the mean and a quarter turn.
[[nodiscard]] tl::expected<ToolMotion, std::string> ParseMotion(const std::string& text,
                                                                const std::string& name);

/// ParseMotion of a file.
[[nodiscard]] tl::expected<ToolMotion, std::string> LoadMotion(const std::filesystem::path& path);

}  // namespace osteon::simulation
