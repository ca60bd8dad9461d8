#pragma once

#include "config/reading/strict/reader.h"

namespace osteon::config {

/// Places are at most this far from the origin of their frame, along each axis.
inline constexpr double kRoom_mm = 5000;

/// Reads a section with position_mm and rpy_deg: rotations about the fixed x, then y, then z axis (as in
/// URDF).
[[nodiscard]] Pose ReadPose(Reader section);

}  // namespace osteon::config
