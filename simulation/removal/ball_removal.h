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

/// Pass 3 of a frame, for the balls: removes the frame's capsules from a packing, and splits balls.
///
/// The caller owns the list of balls. First come the bone's own balls, the *parents*, then a pool of blocks
/// for K children each.
///
///     parent ──first touch, larger than r_split──▶ block of K children (the parent itself is gone then)
///            ──no block left──────────────────────▶ shrinks whole, counted in `refused`
///     block  ──its children are all gone──────────▶ free again, from the next frame on
///
/// Each parent is an independent work item that reads and writes only itself and its block. Parents share
/// only the number of free blocks, which are assigned in the order of the parents' numbers. The result
/// therefore does not depend on scheduling. The choice of the block for a parent affects only the order in
/// the list.
///
/// A frame splits at most SplitParams::blocks_per_frame balls. Other balls to be split get a block, but wait:
/// they shrink as unsplit balls do, and their block stores the capsules that hit them. A later frame makes
/// the children from the ball as it was before these capsules, and cuts them with all stored capsules. Such
/// children may fill space that the shrunken ball no longer filled, but never space outside the original ball
/// or inside the sweep.
///
/// Invariants: a child lies in its parent; no ball overlaps a capsule that was applied; if no ball waits, the
/// union of the balls never grows.
class BallRemoval {
 public:
  /// @throws std::invalid_argument naming the value of `params` that is not accepted.
  /// @param parents  the uncut balls
  BallRemoval(std::span<const BallState> parents, const SplitParams& params);

  /// Applies one frame's capsules, in their order.
  /// @pre `balls` is the list that the previous frames left; the list grows when new blocks come into use.
  void Remove(std::span<const Capsule> capsules, std::vector<BallState>& balls);

  /// Number of requests for a block when no block was free, one per frame and ball. Such a ball shrank
  /// although it should have been split.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  [[nodiscard]] std::size_t blocks_in_use() const { return blocks_ - free_.size(); }
  /// Largest number of blocks that were in use at the same time.
  [[nodiscard]] std::size_t max_blocks_in_use() const { return blocks_; }

  /// Writes balls and blocks into a carved state. There, blocks are in the order of their parents.
  void Save(const std::vector<BallState>& balls, CarvedState& state) const;
  /// Converts a ball's index in the list to its index in a state that Save writes; nothing for a child in a
  /// free block.
  [[nodiscard]] std::optional<std::uint32_t> SavedIndex(std::uint32_t ball) const;
  /// @throws std::invalid_argument if the state belongs to another packing or other parameters.
  void Load(const CarvedState& state, std::vector<BallState>& balls);

 private:
  /// Index of a block's first child in the list of balls.
  [[nodiscard]] std::size_t ChildAt(std::size_t block) const { return parents_ + block * splitter_->slots(); }
  [[nodiscard]] std::span<BallState> ChildrenOf(std::uint32_t parent, std::vector<BallState>& balls) const {
    return std::span(balls).subspan(ChildAt(static_cast<std::size_t>(block_[parent])), splitter_->slots());
  }
  /// Assigns a free block to the parent, or a new block at the end of the list.
  void TakeBlock(std::uint32_t parent, std::vector<BallState>& balls);
  void FreeBlock(std::uint32_t parent);

  std::size_t parents_;
  std::optional<BallSplitter> splitter_;  ///< empty if balls are not split
  static constexpr std::int32_t kNone = -1;
  std::vector<std::int32_t> block_;   ///< block of each parent; kNone: no block
  std::size_t blocks_{0};             ///< number of blocks that were ever in use
  std::set<std::uint32_t> free_;      ///< blocks below blocks_ that are free now
  std::vector<WaitingBall> waiting_;  ///< balls that wait for their children, in ascending order of parents
  std::uint64_t refused_{0};
};

}  // namespace osteon::simulation
