#pragma once

#include "config/reading/strict/reader.h"

namespace osteon::config {

/// Largest accepted coordinate of a position, in magnitude, in its frame [mm].
inline constexpr double kRoom_mm = 5000;

/// Reads a section with position_mm and rpy_deg: rotations about the fixed x, then y, then z axis (as in
/// URDF).
[[nodiscard]] Pose ReadPose(Reader section);

}  // namespace osteon::config
