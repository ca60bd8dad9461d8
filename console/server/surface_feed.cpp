#include "console/server/surface_feed.h"

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "simulation/surface/chunk_bytes.h"

namespace osteon::console {

void SurfaceFeed::Begin(const surface::BrickLayout& layout) {
  layout_ = layout;
  store_.Begin(layout,
               nlohmann::json{{"type", "surface"},
                              {"origin_mm", {layout.origin_mm.x, layout.origin_mm.y, layout.origin_mm.z}},
                              {"voxel_mm", layout.voxel_mm},
                              {"bricks", layout.bricks}}
                   .dump());
}

void SurfaceFeed::Publish(std::span<const surface::SurfaceChunk> chunks, std::uint64_t) {
  std::vector<std::uint8_t> bytes;
  for (const surface::SurfaceChunk& chunk : chunks) {
    bytes.clear();
    surface::AppendChunk(layout_, chunk, bytes);
    store_.Put(chunk.brick, std::string(bytes.begin(), bytes.end()));
  }
}

}  // namespace osteon::console
