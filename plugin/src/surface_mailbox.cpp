#include "plugin/src/surface_mailbox.h"

#include <algorithm>
#include <array>
#include <utility>

#include "plugin/src/result.h"

namespace osteon::plugin {
namespace {

using surface::SurfaceChunk;
using surface::SurfaceVertex;
using surface::Vec3;

static_assert(surface::kMaxChunkVertices == OSTEON_CHUNK_MAX_VERTICES);
static_assert(surface::kMaxChunkQuads * 6 == OSTEON_CHUNK_MAX_INDICES);

/// Number of indices of a chunk's triangles: each quad gives two triangles.
std::size_t IndexCount(const SurfaceChunk& chunk) { return chunk.quads.size() / 4 * 6; }

OsteonVertex VertexOf(const SurfaceVertex& v) {
  return {.position_mm = {v.p_mm.x, v.p_mm.y, v.p_mm.z},
          .normal = {v.normal.x, v.normal.y, v.normal.z},
          .material = v.material,
          .cut = static_cast<std::uint8_t>(v.cut ? 1 : 0),
          .reserved = {}};
}

/// Returns the two triangles of a quad, divided along its shorter diagonal. @param first  position of the
/// quad's first corner in chunk.quads
std::array<std::uint16_t, 6> TrianglesOf(const SurfaceChunk& chunk, std::size_t first) {
  const std::array<std::uint16_t, 4> q{chunk.quads[first], chunk.quads[first + 1], chunk.quads[first + 2],
                                       chunk.quads[first + 3]};
  const auto length2 = [&](std::uint16_t a, std::uint16_t b) {
    const Vec3 d = chunk.vertices[a].p_mm - chunk.vertices[b].p_mm;
    return surface::Dot(d, d);
  };
  if (length2(q[0], q[2]) <= length2(q[1], q[3])) return {q[0], q[1], q[2], q[0], q[2], q[3]};
  return {q[0], q[1], q[3], q[1], q[2], q[3]};
}

/// Appends a chunk to the buffers, which must have room for it.
void Append(const SurfaceChunk& chunk, OsteonSurfaceBuffers& to) {
  to.chunks[to.chunk_count++] = {.brick = chunk.brick,
                                 .first_vertex = static_cast<std::uint32_t>(to.vertex_count),
                                 .vertex_count = static_cast<std::uint32_t>(chunk.vertices.size()),
                                 .first_index = static_cast<std::uint32_t>(to.index_count),
                                 .index_count = static_cast<std::uint32_t>(IndexCount(chunk)),
                                 .reserved = 0};
  for (const SurfaceVertex& vertex : chunk.vertices) to.vertices[to.vertex_count++] = VertexOf(vertex);
  for (std::size_t first = 0; first + 3 < chunk.quads.size(); first += 4)
    for (const std::uint16_t index : TrianglesOf(chunk, first)) to.indices[to.index_count++] = index;
}

/// @throws Failure if a pointer is null, or if the buffers are too small for the largest possible chunk.
void CheckBuffers(const OsteonSurfaceBuffers& buffers) {
  CheckPointer(buffers.chunks, "chunks");
  CheckPointer(buffers.vertices, "vertices");
  CheckPointer(buffers.indices, "indices");
  if (buffers.chunk_capacity < 1 || buffers.vertex_capacity < OSTEON_CHUNK_MAX_VERTICES ||
      buffers.index_capacity < OSTEON_CHUNK_MAX_INDICES)
    throw Failure(
        OSTEON_ERROR_BUFFER,
        "buffers: found room for less than a chunk, accepted 1 chunk, OSTEON_CHUNK_MAX_VERTICES and "
        "OSTEON_CHUNK_MAX_INDICES or more");
}

}  // namespace

void SurfaceMailbox::Begin(const surface::BrickLayout& layout) {
  const std::lock_guard lock(mutex_);
  kept_.assign(layout.Count(), {});
}

void SurfaceMailbox::Publish(std::span<const SurfaceChunk> chunks, std::uint64_t /*frame*/) {
  const std::lock_guard lock(mutex_);
  for (const SurfaceChunk& chunk : chunks) {
    Kept& kept = kept_[chunk.brick];
    if (kept.generation == 0 && chunk.vertices.empty()) continue;  // an empty brick that was never there
    kept = {.generation = ++generation_, .chunk = chunk};
  }
}

void SurfaceMailbox::CopyChanges(std::uint64_t& generation, OsteonSurfaceBuffers& buffers) const {
  CheckBuffers(buffers);
  buffers.chunk_count = buffers.vertex_count = buffers.index_count = 0;
  buffers.left = 0;
  const std::lock_guard lock(mutex_);
  if (generation > generation_)
    throw Failure(OSTEON_ERROR_ARGUMENT,
                  "generation: found one of another session, accepted 0 to begin with");
  std::vector<const Kept*> changed;
  for (const Kept& kept : kept_)
    if (kept.generation > generation) changed.push_back(&kept);
  std::sort(changed.begin(), changed.end(),
            [](const Kept* a, const Kept* b) { return a->generation < b->generation; });
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const SurfaceChunk& chunk = changed[i]->chunk;
    if (buffers.chunk_count == buffers.chunk_capacity ||
        buffers.vertex_count + chunk.vertices.size() > buffers.vertex_capacity ||
        buffers.index_count + IndexCount(chunk) > buffers.index_capacity) {
      buffers.left = changed.size() - i;
      return;
    }
    Append(chunk, buffers);
    generation = changed[i]->generation;
  }
}

}  // namespace osteon::plugin
