#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "simulation/surface/surface_chunk.h"

// The bytes of a chunk as it is sent. Little endian; chunks follow each other without a gap.
//
//     head      8 bytes     u32 brick, u16 vertices, u16 quads
//     vertex    6 bytes     3 × u8 place, 2 × u8 octahedral normal, u8 material | cut << 7
//     quad      4 × u8      indices of vertices; 4 × u16 in a chunk of more than 256 vertices
//
// A place counts steps of voxel / 28 from the low corner of the brick's cell -1. All bricks share one lattice
// (28 steps per voxel, 8 voxels per brick), so neighbouring chunks still meet without a gap.

namespace osteon::surface {

inline constexpr std::size_t kChunkHeadBytes = 8;
inline constexpr std::size_t kVertexBytes = 6;
inline constexpr int kStepsPerVoxel = 28;

/// Appends a chunk's bytes. Vertices that no quad uses are left out.
void AppendChunk(const BrickLayout& layout, const SurfaceChunk& chunk, std::vector<std::uint8_t>& bytes);

/// Reads the chunk at the beginning of the bytes. The bytes are not trusted.
/// @param chunk  unchanged if the bytes are refused
/// @returns the number of bytes read; nothing if bytes are missing, the brick is not in the layout, there are
///   too many vertices or quads, a place is off the brick, or a quad names a vertex that isn't there.
[[nodiscard]] std::optional<std::size_t> ReadChunk(const BrickLayout& layout,
                                                   std::span<const std::uint8_t> bytes, SurfaceChunk& chunk);

}  // namespace osteon::surface
