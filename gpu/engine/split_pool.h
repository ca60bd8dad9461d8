#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "gpu/shaders/layout.h"
#include "simulation/removal/split_ball.h"

namespace osteon::gpu {

/// The host's record of split balls. simulation/removal/ball_removal.h defines the result that splitting must
/// have.
///
///     device  balls  │ parents, up to a multiple of 64 │ block 0: 64 slots │ block 1 │ …
///             blocks │ number of children left, by block
///                      ▲ events, in any order: parents that were touched and are too large, blocks that
///                        have lost their last child
///     host    sorted by parent ─▶ blocks ─▶ children, cut by the frame's capsules
///                                          ─▶ the next frame's uploads
///
/// A block holds the children of one parent and is a cluster of its own. It is culled with the box of its
/// parent's cluster, so culling and lists treat children like any cluster. The host makes the children, in a
/// few microseconds per ball, before the next frame. If a frame has no events, the host reads only the number
/// of events.
class SplitPool {
 public:
  /// @throws std::invalid_argument if params are not accepted, or the children of a ball do not fit in a
  /// cluster.
  SplitPool(const std::vector<simulation::Ball>& uncut, const simulation::SplitParams& params);

  /// Length of the device's list of balls: the parents, padded to whole clusters, and the slots of every
  /// block.
  [[nodiscard]] std::size_t ball_count() const { return first_ + params().pool_blocks * kGroupSize; }
  [[nodiscard]] std::size_t block_count() const { return params().pool_blocks; }
  /// Index of the first cluster of children.
  [[nodiscard]] std::size_t FirstCluster() const { return first_ / kGroupSize; }
  /// Blocks of the split parents that belong to a cluster.
  [[nodiscard]] const std::vector<uint>& BlocksIn(uint cluster) const { return blocks_of_cluster_[cluster]; }

  /// Number of uploads for one ball that is split: the ball, its children and its block.
  static constexpr std::size_t kUploadsPerSplit = 1 + kGroupSize + 1;

  /// True if EndFrame would have nothing to do after a frame without events.
  [[nodiscard]] bool IsIdle() const { return waiting_.empty() && emptied_.empty(); }
  /// Ends a frame: makes the children of the balls that are to be split, and frees empty blocks. @param
  /// capsules volumes that the cutting balls swept in the frame
  void EndFrame(std::span<const SplitEvent> events, std::span<const simulation::Capsule> capsules);

  /// Balls to send to the device before the next frame's lists are built.
  [[nodiscard]] const std::vector<SplitUpload>& uploads() const { return uploads_; }
  /// Clears the uploads; call after they were sent.
  void Uploaded() { uploads_.clear(); }
  /// Number of requests so far that were refused because no block was free.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

  /// Writes the state of parents and children, given the device's list of balls after all uploads.
  void Save(std::span<const vec4> balls, simulation::CarvedState& state) const;
  /// The device's lists of balls and of blocks.
  struct DeviceState {
    std::vector<vec4> balls;
    std::vector<Block> blocks;
  };
  /// Returns the device's lists for a state, and replaces the record of split balls by the state's. @throws
  /// std::invalid_argument if the state belongs to another packing or other parameters.
  [[nodiscard]] DeviceState Load(const simulation::CarvedState& state);
  /// Converts the indices of the contact memory's bone balls, from the device's to a saved state's and back.
  /// ToSaved drops the pairs whose bone ball is a child in a block that is free again.
  void ToSaved(simulation::ContactMemory& contact) const;
  void FromSaved(simulation::ContactMemory& contact) const;

 private:
  struct Waiting {
    simulation::WaitingBall ball;
    simulation::BallState now;  ///< present state of the ball on the device
  };
  [[nodiscard]] const simulation::SplitParams& params() const { return splitter_.params(); }
  [[nodiscard]] float MinChildRadius_mm(std::uint32_t parent) const {
    return static_cast<float>(1e3 * splitter_.MinChildRadius_m(parent));
  }
  // Reserves a free block for a parent's children; returns its index.
  uint TakeBlock(std::uint32_t parent);
  void FreeBlock(uint block);

  simulation::BallSplitter splitter_;
  std::size_t parents_;                ///< number of parents, that is of balls of the uncut bone
  std::size_t first_;                  ///< index of the first child in the device's list
  std::vector<std::int32_t> block_;    ///< block of each parent; -1: none
  std::vector<std::uint32_t> parent_;  ///< parent of each block that was ever in use
  std::set<uint> free_;                ///< blocks that were in use and are free now
  std::set<uint> in_use_;
  std::vector<uint> emptied_;  ///< blocks that got no children, to be freed at the end of the next frame
  /// Balls with a block that are not split yet, in ascending order of parents.
  std::vector<Waiting> waiting_;
  std::vector<std::vector<uint>> blocks_of_cluster_;
  std::vector<SplitUpload> uploads_;
  std::uint64_t refused_{0};
};

}  // namespace osteon::gpu
