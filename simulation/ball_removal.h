#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "simulation/cutting_engine.h"
#include "simulation/split_ball.h"

namespace osteon::simulation {

/// Pass 3 over balls: what a frame's capsules take away from a packing, and how balls are split.
///
/// The list of balls is the caller's: first the bone's own, the *parents*, then a pool of blocks of K
/// children each.
///
///     parent ──first touch, larger than r_split──▶ block of K children (the parent itself is gone then)
///            ──no block left──────────────────────▶ shrinks whole, counted in `refused`
///     block  ──its children are all gone──────────▶ free again, from the next frame on
///
/// Each parent is a work item of its own: it reads and writes itself and its block. The only thing they share
/// is the count of free blocks, and that goes to those that ask in the order of their numbers. So the result
/// does not depend on scheduling. Which block a parent gets has no influence on anything but the order in the
/// list.
///
/// A frame may split so many balls at most (SplitParams::blocks_per_frame). The others get their block but
/// wait: they are shrunk like any ball, the block keeps the capsules that have hit them, and their children
/// are made later from the ball as it was, with all of these. Children so made may reach where the shrunken
/// ball did not any more; never out of the ball as it was, nor into what was swept.
///
/// Invariants: a child lies in its parent; nothing overlaps a capsule once it was applied; without waiting,
/// the union never grows.
class BallRemoval {
 public:
  /// @throws std::invalid_argument naming the value of `params` that is not accepted.
  /// @param parents  the uncut balls
  BallRemoval(std::span<const BallState> parents, const SplitParams& params);

  /// Applies one frame's capsules, in their order. @pre `balls` is the list of the frames before; grows as
  /// blocks come into use.
  void Remove(std::span<const Capsule> capsules, std::vector<BallState>& balls);

  /// Frames' requests for a block that found none: balls that shrank whole although they should be split.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  [[nodiscard]] std::size_t blocks_in_use() const { return blocks_ - free_.size(); }
  /// Most blocks that were in use at a time.
  [[nodiscard]] std::size_t most_blocks() const { return blocks_; }

  /// Writes balls and blocks to a state, blocks in the order of their parents.
  void Save(const std::vector<BallState>& balls, CarvedState& state) const;
  /// Where a ball of the list lies in a state that Save writes and Load reads; nothing for a child of a block
  /// that is free.
  [[nodiscard]] std::optional<std::uint32_t> SavedIndex(std::uint32_t ball) const;
  /// @throws std::invalid_argument where the state is not of this packing or not of these parameters.
  void Load(const CarvedState& state, std::vector<BallState>& balls);

 private:
  [[nodiscard]] std::size_t ChildAt(std::size_t block) const { return parents_ + block * splitter_->slots(); }
  [[nodiscard]] std::span<BallState> ChildrenOf(std::uint32_t parent, std::vector<BallState>& balls) const {
    return std::span(balls).subspan(ChildAt(static_cast<std::size_t>(block_[parent])), splitter_->slots());
  }
  void TakeBlock(std::uint32_t parent, std::vector<BallState>& balls);
  void FreeBlock(std::uint32_t parent);

  std::size_t parents_;
  std::optional<BallSplitter> splitter_;  ///< nothing: balls are not split
  static constexpr std::int32_t kNone = -1;
  std::vector<std::int32_t> block_;   ///< of each parent, kNone where it has none
  std::size_t blocks_{0};             ///< that were ever in use
  std::set<std::uint32_t> free_;      ///< of these
  std::vector<WaitingBall> waiting_;  ///< ascending
  std::uint64_t refused_{0};
};

}  // namespace osteon::simulation
