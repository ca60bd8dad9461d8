#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "console/server/surface_store.h"

namespace osteon::console {

/// One reader's progress in a SurfaceStore. Takes a change with all its bricks and returns it in parts.
///
///     SurfaceStore ──all that changed──▶ waiting bricks ──part──▶ part ──▶ … ──▶ whole; then the next change
///
/// Bricks that change meanwhile are not added to the waiting bricks; they form the next change. Therefore:
///
/// - every brick is sent, however often other bricks change
/// - all bricks of a change show the bone at the same time
/// - a reader holds at most the bytes of one whole surface
///
/// For one thread.
class SurfaceReader {
 public:
  struct Part {
    SurfaceStore::Bytes layout;  ///< the message of a new grid, to be sent first; null: the grid is the same
    std::string bricks;          ///< one after the other
    bool begins{false};          ///< the part has the first bricks of a change
    bool ends{false};            ///< the part has the last bricks of a change
  };

  /// Returns the next part; empty: nothing has changed. @param max_bytes  of the bricks; a single brick may
  /// be larger
  [[nodiscard]] Part Next(const SurfaceStore& store, std::size_t max_bytes) {
    Part part;
    if (store.layout_version() > seen_) waiting_.clear();  // they belong to an older grid
    if (waiting_.empty()) {
      auto [layout, bricks] = store.Since(seen_);
      part.layout = std::move(layout);
      part.begins = !bricks.empty();
      waiting_ = std::move(bricks);
      next_ = 0;
    }
    if (waiting_.empty()) return part;
    std::size_t end = next_ + 1, bytes = waiting_[next_]->size();
    while (end < waiting_.size() && bytes + waiting_[end]->size() <= max_bytes)
      bytes += waiting_[end++]->size();
    part.bricks.reserve(bytes);  // one allocation, because a change may have a quarter of a megabyte
    while (next_ < end) part.bricks += *waiting_[next_++];
    part.ends = next_ == waiting_.size();
    if (part.ends) waiting_.clear();
    return part;
  }

  /// Begins with the grid and all bricks again.
  void Restart() {
    waiting_.clear();
    seen_ = 0;
  }

 private:
  std::uint64_t seen_{0};  // the store's version of the change that is being handed out
  std::vector<SurfaceStore::Bytes> waiting_;
  std::size_t next_{0};  // index in waiting_ of the next brick to return
};

}  // namespace osteon::console
