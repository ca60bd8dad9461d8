#include "simulation/surface/chunk_bytes.h"

#include <algorithm>
#include <cmath>

namespace osteon::surface {
namespace {

constexpr int kMaxPlace = kStepsPerVoxel * kCellEdge;  // 252: the upper end of a brick's last cell
constexpr std::size_t kMaxByteIndices = 256;           // largest number of vertices that one byte can index
constexpr std::uint8_t kMaterialMask = 0x7f;

void AppendU16(std::vector<std::uint8_t>& bytes, std::size_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8 & 0xff));
}

/// Reads two bytes, the lower one first.
std::uint16_t U16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

/// Maps -1 … 1 to 0 … 255.
std::uint8_t ToByte(float unit) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(unit * 0.5F + 0.5F, 0.0F, 1.0F) * 255.0F));
}

/// Octahedral code of a unit vector. Source: Cigolle et al., JCGT 3(2), 2014.
std::array<std::uint8_t, 2> EncodeNormal(Vec3 n) {
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(sum > 0.0F)) return EncodeNormal({0.0F, 0.0F, 1.0F});
  float x = n.x / sum, y = n.y / sum;
  // fold the octahedron's lower half outwards, into the corners of the square
  if (n.z < 0.0F) {
    const float fold_x = (1.0F - std::abs(y)) * (x < 0.0F ? -1.0F : 1.0F);
    const float fold_y = (1.0F - std::abs(x)) * (y < 0.0F ? -1.0F : 1.0F);
    x = fold_x;
    y = fold_y;
  }
  return {ToByte(x), ToByte(y)};
}

/// The unit vector of EncodeNormal's two bytes.
Vec3 DecodeNormal(std::uint8_t a, std::uint8_t b) {
  float x = static_cast<float>(a) / 127.5F - 1.0F, y = static_cast<float>(b) / 127.5F - 1.0F;
  const float z = 1.0F - std::abs(x) - std::abs(y);
  if (z < 0.0F) {
    const float fold_x = (1.0F - std::abs(y)) * (x < 0.0F ? -1.0F : 1.0F);
    const float fold_y = (1.0F - std::abs(x)) * (y < 0.0F ? -1.0F : 1.0F);
    x = fold_x;
    y = fold_y;
  }
  const Vec3 n{x, y, z};
  return (1.0F / Norm(n)) * n;
}

/// Lowest corner of the brick's cell -1 [mm]. Vertex coordinates are counted in steps from this corner.
Vec3 LowCorner(const BrickLayout& layout, BrickIndex brick) {
  const auto [x, y, z] = layout.PlaceOf(brick);
  return layout.Node(x * kBrickEdge - 1, y * kBrickEdge - 1, z * kBrickEdge - 1);
}

/// Rounds a vertex coordinate, relative to LowCorner, to steps: a "place" of the format.
std::uint8_t ToPlace(float offset_mm, float voxel_mm) {
  const long steps = std::lround(offset_mm * static_cast<float>(kStepsPerVoxel) / voxel_mm);
  return static_cast<std::uint8_t>(std::clamp<long>(steps, 0, kMaxPlace));
}

}  // namespace

void AppendChunk(const BrickLayout& layout, const SurfaceChunk& chunk, std::vector<std::uint8_t>& bytes) {
  std::vector<bool> used(chunk.vertices.size(), false);
  for (const std::uint16_t v : chunk.quads) used[v] = true;
  std::vector<std::uint16_t> number(chunk.vertices.size(), 0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) number[i] = static_cast<std::uint16_t>(count++);
  AppendU16(bytes, chunk.brick & 0xffff);
  AppendU16(bytes, chunk.brick >> 16);
  AppendU16(bytes, count);
  AppendU16(bytes, chunk.quads.size() / 4);
  const Vec3 low = LowCorner(layout, chunk.brick);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const SurfaceVertex& v = chunk.vertices[i];
    const Vec3 offset = v.p_mm - low;
    for (const float along : {offset.x, offset.y, offset.z}) bytes.push_back(ToPlace(along, layout.voxel_mm));
    for (const std::uint8_t part : EncodeNormal(v.normal)) bytes.push_back(part);
    bytes.push_back(static_cast<std::uint8_t>((v.material & kMaterialMask) | (v.cut ? 0x80 : 0)));
  }
  for (const std::uint16_t v : chunk.quads) {
    if (count <= kMaxByteIndices)
      bytes.push_back(static_cast<std::uint8_t>(number[v]));
    else
      AppendU16(bytes, number[v]);
  }
}

std::optional<std::size_t> ReadChunk(const BrickLayout& layout, std::span<const std::uint8_t> bytes,
                                     SurfaceChunk& chunk) {
  if (bytes.size() < kChunkHeadBytes) return std::nullopt;
  const BrickIndex brick = U16(bytes, 0) | static_cast<BrickIndex>(U16(bytes, 2)) << 16;
  const std::size_t vertices = U16(bytes, 4), quads = U16(bytes, 6);
  if (brick >= layout.Count() || vertices > kMaxChunkVertices || quads > kMaxChunkQuads) return std::nullopt;
  const std::size_t index_bytes = vertices <= kMaxByteIndices ? 1 : 2;
  const std::size_t quads_at = kChunkHeadBytes + kVertexBytes * vertices;
  const std::size_t end = quads_at + quads * 4 * index_bytes;
  if (bytes.size() < end) return std::nullopt;
  SurfaceChunk read{.brick = brick};
  read.vertices.reserve(vertices);
  read.quads.reserve(4 * quads);
  const Vec3 low = LowCorner(layout, brick);
  const float step_mm = layout.voxel_mm / static_cast<float>(kStepsPerVoxel);
  for (std::size_t at = kChunkHeadBytes; at < quads_at; at += kVertexBytes) {
    if (bytes[at] > kMaxPlace || bytes[at + 1] > kMaxPlace || bytes[at + 2] > kMaxPlace) return std::nullopt;
    const Vec3 steps{static_cast<float>(bytes[at]), static_cast<float>(bytes[at + 1]),
                     static_cast<float>(bytes[at + 2])};
    read.vertices.push_back({.p_mm = low + step_mm * steps,
                             .normal = DecodeNormal(bytes[at + 3], bytes[at + 4]),
                             .material = static_cast<std::uint8_t>(bytes[at + 5] & kMaterialMask),
                             .cut = (bytes[at + 5] & 0x80) != 0});
  }
  for (std::size_t at = quads_at; at < end; at += index_bytes) {
    const std::uint16_t v = index_bytes == 1 ? bytes[at] : U16(bytes, at);
    if (v >= vertices) return std::nullopt;
    read.quads.push_back(v);
  }
  chunk = std::move(read);
  return end;
}

}  // namespace osteon::surface
