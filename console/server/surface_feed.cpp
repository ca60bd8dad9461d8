#include "console/server/surface_feed.h"

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "simulation/surface/chunk_bytes.h"

namespace osteon::console {

void SurfaceFeed::Begin(const surface::BrickLayout& layout) { BeginStore(layout, std::nullopt); }

void SurfaceFeed::BeginDifference(const surface::BrickLayout& layout, float step_mm) {
  BeginStore(layout, step_mm);
}

void SurfaceFeed::BeginStore(const surface::BrickLayout& layout, std::optional<float> difference_step_mm) {
  layout_ = layout;
  nlohmann::json message{{"type", "surface"},
                         {"origin_mm", {layout.origin_mm.x, layout.origin_mm.y, layout.origin_mm.z}},
                         {"voxel_mm", layout.voxel_mm},
                         {"bricks", layout.bricks}};
  if (difference_step_mm) message["difference_step_mm"] = *difference_step_mm;
  store_.Begin(layout, message.dump());
}

void SurfaceFeed::Publish(std::span<const surface::SurfaceChunk> chunks, std::uint64_t) {
  std::vector<std::uint8_t> bytes;
  std::vector<std::pair<std::uint64_t, std::string>> change;
  for (const surface::SurfaceChunk& chunk : chunks) {
    bytes.clear();
    surface::AppendChunk(layout_, chunk, bytes);
    change.emplace_back(chunk.brick, std::string(bytes.begin(), bytes.end()));
  }
  store_.Put(std::move(change));
}

}  // namespace osteon::console
