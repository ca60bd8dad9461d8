#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "simulation/surface/surface_chunk.h"

namespace osteon::console {

/// The carved surface as bytes for the pages, brick by brick: the newest version of each, and the grid they
/// lie in. Any thread. A writer only swaps pointers under the lock, a reader copies them.
class SurfaceStore {
 public:
  using Bytes = std::shared_ptr<const std::string>;

  /// Begins anew on another grid. @param message  that describes it to a page
  void Begin(const surface::BrickLayout& grid, std::string message) {
    auto shared = std::make_shared<const std::string>(std::move(message));
    const std::lock_guard lock(mutex_);
    grid_ = grid;
    layout_ = {.version = ++version_, .bytes = std::move(shared)};
    bricks_.clear();
    order_.clear();
  }

  /// The grid that the bricks lie in.
  [[nodiscard]] surface::BrickLayout Layout() const {
    const std::lock_guard lock(mutex_);
    return grid_;
  }

  /// The grid's message if it is newer than version `seen`, which then becomes its version: what a page had
  /// is void.
  [[nodiscard]] Bytes LayoutSince(std::uint64_t& seen) const {
    const std::lock_guard lock(mutex_);
    if (layout_.version <= seen) return nullptr;
    seen = layout_.version;
    return layout_.bytes;
  }

  /// Replaces the bricks of one change: a reader has all of them, or none. @param change  bricks, each with
  /// its bytes of chunk_bytes.h, ready to be sent
  void Put(std::vector<std::pair<std::uint64_t, std::string>> change) {
    std::vector<Bytes> shared;
    for (auto& [brick, bytes] : change)
      shared.push_back(std::make_shared<const std::string>(std::move(bytes)));
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < change.size(); ++i) {
      Brick& kept = bricks_[change[i].first];
      order_.erase(kept.version);
      kept = {.version = ++version_, .bytes = std::move(shared[i])};
      order_.emplace_hint(order_.end(), kept.version, change[i].first);
    }
  }

  /// The bricks that changed after version `seen`, the longest unchanged first, at most `most`. `seen`
  /// becomes the last one's version; it is the newest version where nothing is left.
  [[nodiscard]] std::vector<Bytes> Since(std::uint64_t& seen, std::size_t most) const {
    std::vector<Bytes> bytes;
    const std::lock_guard lock(mutex_);
    for (auto at = order_.upper_bound(seen); at != order_.end() && bytes.size() < most; ++at) {
      bytes.push_back(bricks_.at(at->second).bytes);
      seen = at->first;
    }
    return bytes;
  }

  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return bricks_.size();
  }

 private:
  struct Brick {
    std::uint64_t version{0};
    Bytes bytes;
  };
  mutable std::mutex mutex_;
  surface::BrickLayout grid_;
  Brick layout_;
  std::map<std::uint64_t, Brick> bricks_;
  std::map<std::uint64_t, std::uint64_t> order_;  // bricks by their versions
  std::uint64_t version_{0};
};

}  // namespace osteon::console
