#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

// The mesh of the carved bone, brick by brick. Everything in this folder's core is in millimetres, in G.
//
//     brick: 8³ nodes of a grid; its chunk holds the faces around the grid edges that begin at its nodes
//
//        ┌───┬───┬───┐        a chunk's vertices lie in the cells -1 … 7 of its brick, so neighbouring
//        │   │ ╱─┼─╲ │        chunks meet in the same places, with the same bits
//        ├───┼╱──┼──╲┤
//        │   ╱   │   │
//        └───┴───┴───┘

namespace osteon::surface {

struct Vec3 {
  float x{0.0F}, y{0.0F}, z{0.0F};
};

[[nodiscard]] constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
[[nodiscard]] constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
[[nodiscard]] constexpr Vec3 operator*(float s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
[[nodiscard]] constexpr float Dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] constexpr Vec3 Cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline float Norm(Vec3 a) { return std::sqrt(Dot(a, a)); }

inline constexpr int kBrickEdge = 8;                                      ///< nodes along a brick
inline constexpr int kBrickNodes = kBrickEdge * kBrickEdge * kBrickEdge;  ///< nodes of a brick
inline constexpr int kCellEdge = kBrickEdge + 1;  ///< cells along a brick that its chunk may use: -1 … 7
inline constexpr int kMaxChunkQuads = 3 * kBrickNodes;
inline constexpr int kMaxPatches = 4;  ///< largest number of patches of one cell
/// Largest number of vertices of a chunk. Every vertex may be doubled: one for the old surface, one for the
/// cut.
inline constexpr int kMaxChunkVertices = kCellEdge * kCellEdge * kCellEdge * kMaxPatches * 2;

/// Number of a brick (x, y, z): x + nx (y + ny z), with nx and ny bricks along x and y.
using BrickIndex = std::uint32_t;

/// Position and size of the grid. Node (0, 0, 0) lies at origin_mm.
struct BrickLayout {
  Vec3 origin_mm;
  float voxel_mm{0.5F};  ///< distance between neighbouring nodes
  std::array<int, 3> bricks{};

  [[nodiscard]] BrickIndex Count() const {
    return static_cast<BrickIndex>(bricks[0] * bricks[1] * bricks[2]);
  }
  [[nodiscard]] BrickIndex At(int x, int y, int z) const {
    return static_cast<BrickIndex>((z * bricks[1] + y) * bricks[0] + x);
  }
  /// Indices of a brick along x, y and z.
  [[nodiscard]] std::array<int, 3> PlaceOf(BrickIndex brick) const {
    const int i = static_cast<int>(brick);
    return {i % bricks[0], i / bricks[0] % bricks[1], i / bricks[0] / bricks[1]};
  }
  [[nodiscard]] bool Contains(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < bricks[0] && y < bricks[1] && z < bricks[2];
  }
  /// Position of a node of the whole grid [mm].
  [[nodiscard]] Vec3 Node(int x, int y, int z) const {
    return {origin_mm.x + voxel_mm * static_cast<float>(x), origin_mm.y + voxel_mm * static_cast<float>(y),
            origin_mm.z + voxel_mm * static_cast<float>(z)};
  }
};

/// Largest number of bricks of a layout: 64 Mi, a table of 256 MB for each field.
inline constexpr double kMaxBricks = 67108864.0;

/// Makes the layout of a box: whole bricks with air all around, the origin at a multiple of the voxel.
/// @throws std::invalid_argument if the voxel is not above 0, the box is empty or not finite, or more than
///   kMaxBricks bricks would be needed.
[[nodiscard]] BrickLayout MakeLayout(Vec3 min_mm, Vec3 max_mm, float voxel_mm);

struct SurfaceVertex {
  Vec3 p_mm;
  Vec3 normal;               ///< outward, of unit length
  std::uint8_t material{0};  ///< index into Bone::materials; below 128
  bool cut{false};           ///< true: on a face that the tool cut; false: on the bone's original surface
  /// Cell (x, y, z) and patch within the brick: 4 (x + 9 (y + 9 z)) + patch. In the welded mesh, vertices of
  /// the same cell and patch become one: those of neighbouring chunks, and the two of a rim. ReadChunk sets
  /// 0.
  std::uint16_t key{0};
};

/// The mesh of one brick. An empty chunk means that the brick has no surface, or no longer has one.
struct SurfaceChunk {
  BrickIndex brick{0};
  std::vector<SurfaceVertex> vertices{};
  std::vector<std::uint16_t> quads{};  ///< four vertices each, counter-clockwise seen from outside
};

}  // namespace osteon::surface
