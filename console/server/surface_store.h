#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "simulation/surface/surface_chunk.h"

namespace osteon::console {

/// The carved surface as bytes for the pages, brick by brick: the newest version of each brick, and the grid
/// in which they lie. Any thread. Under the lock, a writer only swaps pointers and a reader only copies them
/// (surface_reader.h).
class SurfaceStore {
 public:
  using Bytes = std::shared_ptr<const std::string>;

  /// Removes all bricks and begins a new grid. @param message  describes the grid to a page
  void Begin(const surface::BrickLayout& grid, std::string message) {
    auto shared = std::make_shared<const std::string>(std::move(message));
    const std::lock_guard lock(mutex_);
    grid_ = grid;
    layout_ = {.version = ++version_, .bytes = std::move(shared)};
    layout_version_.store(version_);
    bricks_.clear();
    order_.clear();
  }

  /// The grid in which the bricks lie.
  [[nodiscard]] surface::BrickLayout Layout() const {
    const std::lock_guard lock(mutex_);
    return grid_;
  }

  /// Version at which the present grid began; 0: there is no grid.
  [[nodiscard]] std::uint64_t layout_version() const { return layout_version_.load(); }

  /// Replaces the bricks of one change: a reader gets all of them, or none. @param change  the bricks, each
  /// with its bytes (chunk_bytes.h), ready to be sent
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

  /// The data that a reader of an older version lacks.
  struct Change {
    Bytes layout;  ///< message of a new grid, which replaces all earlier bricks; null: the same grid
    std::vector<Bytes> bricks;  ///< all bricks that changed, the one with the oldest change first
  };

  /// Returns all data that changed after version `seen`, and sets `seen` to the newest version. If another
  /// thread holds the lock, it returns nothing and leaves `seen` unchanged, because a reader must not wait
  /// for a thread that a busy machine does not run.
  [[nodiscard]] Change Since(std::uint64_t& seen) const {
    Change change;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || version_ == seen) return change;
    if (layout_.version > seen) change.layout = layout_.bytes;
    for (auto at = order_.upper_bound(seen); at != order_.end(); ++at)
      change.bricks.push_back(bricks_.at(at->second).bytes);
    seen = version_;
    return change;
  }

  /// Number of bricks.
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return bricks_.size();
  }

 private:
  // Bytes of a brick, or the grid's message, with the version at which they were stored.
  struct Brick {
    std::uint64_t version{0};
    Bytes bytes;
  };
  mutable std::mutex mutex_;
  surface::BrickLayout grid_;
  Brick layout_;
  std::map<std::uint64_t, Brick> bricks_;         // bricks by their numbers
  std::map<std::uint64_t, std::uint64_t> order_;  // numbers of the bricks by their versions
  std::uint64_t version_{0};
  std::atomic<std::uint64_t> layout_version_{0};
};

}  // namespace osteon::console
