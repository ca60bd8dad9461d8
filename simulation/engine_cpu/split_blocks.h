#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "simulation/engine_cpu/bone_store.h"
#include "simulation/removal/split_ball.h"

namespace osteon::simulation::cpu {

/// Keeps track of split balls and the blocks of their children. Assigns the same blocks in the same order as
/// BallRemoval (removal/ball_removal.h), but finds split balls by lists instead of visiting all parents.
///
///     large balls that the sweep may touch ─▶ Begin: assigns blocks, makes children or waiting balls, and
///                                             keeps them apart
///     the removal pass shrinks all other balls and children
///     touched children ─▶ End: stores the balls that were kept apart, and frees empty blocks
///
/// A frame allocates memory only if a waiting ball records another cut (SplitParams::blocks_per_frame > 0).
class SplitBlocks {
 public:
  /// Begins without split balls. @throws std::invalid_argument naming the value of `params` that is not
  /// accepted.
  SplitBlocks(BoneStore& bone, const SplitParams& params);

  [[nodiscard]] const SplitParams& params() const { return splitter_.params(); }
  /// Number of blocks of eight for each split ball.
  [[nodiscard]] std::uint32_t stride() const { return stride_; }
  /// FirstBlock returns the first block of children of the split ball with this number; the next function
  /// returns the cluster of its parent.
  [[nodiscard]] std::uint32_t FirstBlock(std::uint32_t number) const;
  [[nodiscard]] std::uint32_t ParentCluster(std::uint32_t number) const;
  /// For each number that was ever in use: radius below which its children are removed [m].
  [[nodiscard]] const double* min_child_m() const { return min_child_m_.data(); }
  /// Calls visit(number) for the split balls whose parents lie in a cluster.
  template <class Visit>
  void EachIn(std::uint32_t cluster, Visit&& visit) const {
    for (std::int32_t number = first_in_cluster_[cluster]; number >= 0;
         number = next_in_cluster_[static_cast<std::size_t>(number)])
      visit(static_cast<std::uint32_t>(number));
  }
  [[nodiscard]] bool HasAnyIn(std::uint32_t cluster) const { return first_in_cluster_[cluster] >= 0; }
  [[nodiscard]] bool any_waiting() const { return !waiting_.empty(); }
  /// Number of requests for a block when none was free.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

  /// Decides before the removal pass which balls are split.
  /// @param large  balls that the sweep may touch and that may be too large, ascending
  void Begin(std::span<const std::uint32_t> large, std::span<const Capsule> capsules);
  /// Call it after the removal pass. Stores the balls that were kept apart, removes small children and frees
  /// empty blocks.
  /// @param touched  blocks of children that the pass has changed
  /// @returns the numbers that were given children in this frame, ascending; valid until the next Begin.
  std::span<const std::uint32_t> End(std::span<const std::uint32_t> touched);

  /// Saves the blocks in the order of their parents.
  void Save(CarvedState& state) const;
  /// Checks a state. @throws std::invalid_argument unless it belongs to this packing and these parameters.
  void CheckState(const CarvedState& state) const { splitter_.CheckState(state); }
  /// Loads a state. @pre CheckState has accepted it
  void Load(const CarvedState& state);
  /// ToSaved converts the indices of bone balls in the contact memory to those of a saved state, and
  /// FromSaved back.
  void ToSaved(ContactMemory& contact) const;
  void FromSaved(ContactMemory& contact) const;

 private:
  // Each function is described in split_blocks.cpp.
  void Visit(std::uint32_t parent, WaitingBall waiting, std::span<const Capsule> capsules,
             std::size_t& may_split);
  void MakeChildren(const WaitingBall& waiting, std::span<const Capsule> capsules);
  void TakeNumber(std::uint32_t parent);
  void AddNumber(std::uint32_t number, std::uint32_t parent);
  void FreeNumber(std::uint32_t number);
  void NoteSmallChildren(std::uint32_t block);
  void NoteIfEmpty(std::uint32_t number);
  [[nodiscard]] std::size_t FirstChild(std::uint32_t number) const {
    return 8 * std::size_t{FirstBlock(number)};
  }
  [[nodiscard]] std::size_t InUse() const { return parent_.size() - free_.size(); }

  BoneStore& bone_;
  BallSplitter splitter_;
  std::uint32_t stride_;
  std::vector<std::int32_t> number_of_;  // number of each parent; -1: none
  std::vector<std::uint32_t> parent_;    // parent of each number that was ever in use
  std::vector<double> min_child_m_;
  std::vector<std::int32_t> first_in_cluster_, next_in_cluster_;
  std::vector<std::uint32_t> free_;            // a heap, smallest number on top
  std::vector<WaitingBall> waiting_, waited_;  // without children yet: after and before this frame
  std::uint64_t refused_{0};
  // small_: children that became too small by rounding to floats; they are removed when bone is removed next.
  // empty_at_load_: numbers whose children were all gone when a state was loaded.
  std::vector<std::uint32_t> small_, small_before_, empty_at_load_;
  // scratch of a frame
  std::vector<std::pair<std::size_t, BallState>> set_aside_;
  std::vector<BallState> children_;
  std::vector<std::uint32_t> made_, emptied_;
};

}  // namespace osteon::simulation::cpu
