#pragma once

#include <filesystem>
#include <span>

#include <tl/expected.hpp>

#include "base/file_error.h"
#include "simulation/bone/bone.h"

// Files of balls for other programs, in millimetres in the frame G. Both kinds of files appear complete or
// not at all.

namespace osteon::simulation {

/// Writes a binary little-endian PLY file: element vertex with float x, y, z, radius.
[[nodiscard]] tl::expected<void, FileError> WritePly(const std::filesystem::path& path,
                                                     std::span<const Ball> balls);

/// Writes a CSV file: a header line "x_mm,y_mm,z_mm,r_mm", then one line per ball; numbers have the fewest
/// digits that identify the float32.
[[nodiscard]] tl::expected<void, FileError> WriteCsv(const std::filesystem::path& path,
                                                     std::span<const Ball> balls);

}  // namespace osteon::simulation
