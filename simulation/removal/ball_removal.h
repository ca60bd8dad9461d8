#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/removal/split_ball.h"

namespace osteon::simulation {

/// Pass 3 over balls: removes a frame's capsules from a packing, and splits balls.
///
/// The caller owns the list of balls: first the bone's own balls, the *parents*, then a pool of blocks of K
/// children each.
///
///     parent ──first touch, larger than r_split──▶ block of K children (the parent itself is gone then)
///            ──no block left──────────────────────▶ shrinks whole, counted in `refused`
///     block  ──its children are all gone──────────▶ free again, from the next frame on
///
/// Each parent is an independent work item that reads and writes only itself and its block. Parents share
/// only the count of free blocks, which are given out in the order of the parents' numbers. The result
/// therefore does not depend on scheduling. The choice of a parent's block affects only the order in the
/// list.
///
/// A frame splits at most SplitParams::blocks_per_frame balls. The others get their block but wait: they
/// shrink like any ball while the block stores the capsules that hit them. A later frame makes their children
/// from the ball as it was and cuts them with all these capsules. Such children may fill space that the
/// shrunken ball had left, but never space outside the original ball or inside the sweep.
///
/// Invariants: a child lies in its parent; nothing overlaps a capsule once it was applied; without waiting,
/// the union never grows.
class BallRemoval {
 public:
  /// @throws std::invalid_argument naming the value of `params` that is not accepted.
  /// @param parents  the uncut balls
  BallRemoval(std::span<const BallState> parents, const SplitParams& params);

  /// Applies one frame's capsules, in their order.
  /// @pre `balls` is the list that the previous frames left; it grows as blocks come into use.
  void Remove(std::span<const Capsule> capsules, std::vector<BallState>& balls);

  /// Number of requests for a block that found none, one per frame and ball. Such balls shrank whole although
  /// they should have been split.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  [[nodiscard]] std::size_t blocks_in_use() const { return blocks_ - free_.size(); }
  /// Largest number of blocks that were in use at a time.
  [[nodiscard]] std::size_t max_blocks_in_use() const { return blocks_; }

  /// Writes balls and blocks to a state. Blocks are in the order of their parents.
  void Save(const std::vector<BallState>& balls, CarvedState& state) const;
  /// Index of a ball of the list in a state that Save writes and Load reads; nothing for a child in a free
  /// block.
  [[nodiscard]] std::optional<std::uint32_t> SavedIndex(std::uint32_t ball) const;
  /// @throws std::invalid_argument where the state belongs to another packing or other parameters.
  void Load(const CarvedState& state, std::vector<BallState>& balls);

 private:
  /// Index of a block's first child in the list of balls.
  [[nodiscard]] std::size_t ChildAt(std::size_t block) const { return parents_ + block * splitter_->slots(); }
  [[nodiscard]] std::span<BallState> ChildrenOf(std::uint32_t parent, std::vector<BallState>& balls) const {
    return std::span(balls).subspan(ChildAt(static_cast<std::size_t>(block_[parent])), splitter_->slots());
  }
  /// Gives the parent a free block, or a new one at the end of the list.
  void TakeBlock(std::uint32_t parent, std::vector<BallState>& balls);
  void FreeBlock(std::uint32_t parent);

  std::size_t parents_;
  std::optional<BallSplitter> splitter_;  ///< nothing where balls are not split
  static constexpr std::int32_t kNone = -1;
  std::vector<std::int32_t> block_;   ///< block of each parent, kNone where it has none
  std::size_t blocks_{0};             ///< number of blocks that were ever in use
  std::set<std::uint32_t> free_;      ///< those of them that are free now
  std::vector<WaitingBall> waiting_;  ///< in ascending order of parents
  std::uint64_t refused_{0};
};

}  // namespace osteon::simulation
