#pragma once

#include <filesystem>

#include <tl/expected.hpp>

#include "base/file_error.h"
#include "simulation/surface/brick_field.h"

// The swept field on disk, so that a saved cut keeps its surface.
//
//     byte  0   SweptHeader   swept_file.cpp: magic, version, the grid, CRC of all that follows
//     byte 48   1 byte per brick: 0 nothing swept, 1 all swept, 2 it has values
//               1024 bytes per brick with values, in the bricks' order: 512 values, int16
//
// Little-endian. A file of another version is refused.

namespace osteon::surface {

/// Saves a swept field. The file appears complete or not at all. Its bytes depend on the arguments alone.
[[nodiscard]] tl::expected<void, simulation::FileError> WriteSweptField(const std::filesystem::path& path,
                                                                        const BrickField& swept,
                                                                        const BrickLayout& layout);

/// Reads a swept field and verifies everything: sizes, checksum, the grid, every value.
/// @param layout  grid of the field that will use it
/// @returns an error naming the byte, what was found there and what is accepted.
[[nodiscard]] tl::expected<BrickField, simulation::FileError> ReadSweptField(
    const std::filesystem::path& path, const BrickLayout& layout);

}  // namespace osteon::surface
