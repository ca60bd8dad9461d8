#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "gpu/shaders/layout.h"
#include "simulation/split_ball.h"

namespace osteon::gpu {

/// The host's books of split balls (simulation/ball_removal.h tells what they must amount to).
///
///     device  balls  │ parents, up to a multiple of 64 │ block 0: 64 slots │ block 1 │ …
///                      ▲ requests: parents that were touched and are too large, in any order
///     host    sorted by parent ─▶ blocks ─▶ children, cut by the frame's capsules
///                                          ─▶ the next frame's uploads
///
/// A block is a cluster of its own, in the same place as its parent's: whatever clusters can be done with
/// (culling, lists) children get without any change. Children are made on the host, a few microseconds a
/// ball; no later frame has seen the tool meet the ball in between.
class SplitPool {
 public:
  /// @throws std::invalid_argument where params are not accepted, or children do not fit a cluster.
  SplitPool(const std::vector<simulation::Ball>& uncut, const simulation::SplitParams& params);

  /// Of the device's list of balls: parents, and room for every block.
  [[nodiscard]] std::size_t ball_count() const { return first_ + params().pool_blocks * kGroupSize; }
  [[nodiscard]] std::size_t block_count() const { return params().pool_blocks; }
  [[nodiscard]] std::size_t FirstCluster() const { return first_ / kGroupSize; }
  /// Blocks whose parents lie in a cluster of parents.
  [[nodiscard]] const std::vector<uint>& BlocksIn(uint cluster) const { return blocks_of_cluster_[cluster]; }

  /// Ends a frame: serves its requests, frees blocks that are empty, and makes children.
  /// @param live  of each block's children, as the device counts them
  void EndFrame(std::span<const SplitRequest> requests, std::span<const simulation::Capsule> capsules,
                std::span<Block> blocks);

  /// What has to go to the device before the next frame's lists are made.
  [[nodiscard]] const std::vector<SplitUpload>& uploads() const { return uploads_; }
  void Uploaded() { uploads_.clear(); }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

  /// The state from the device's list of balls, uploads done.
  void Save(std::span<const vec4> balls, simulation::CarvedState& state) const;
  /// The device's list of balls from a state; clears all books.
  /// @throws std::invalid_argument where the state is not of this packing or these parameters.
  [[nodiscard]] std::vector<vec4> Load(const simulation::CarvedState& state, std::span<Block> blocks);
  /// Places of the contact memory's balls, in a state and on the device.
  void ToSaved(simulation::ContactMemory& contact) const;
  void FromSaved(simulation::ContactMemory& contact) const;

 private:
  struct Waiting {
    simulation::WaitingBall ball;
    simulation::BallState now;  ///< what the device has left of it
  };
  [[nodiscard]] const simulation::SplitParams& params() const { return splitter_.params(); }
  uint TakeBlock(std::uint32_t parent);
  void FreeBlock(uint block);

  simulation::BallSplitter splitter_;
  std::size_t parents_, first_;
  std::vector<std::int32_t> block_;    ///< of each parent; -1: none
  std::vector<std::uint32_t> parent_;  ///< of each block that was ever in use
  std::set<uint> free_;                ///< of these
  std::set<uint> in_use_;
  std::vector<Waiting> waiting_;  ///< ascending
  std::vector<std::vector<uint>> blocks_of_cluster_;
  std::vector<SplitUpload> uploads_;
  std::uint64_t refused_{0};
};

}  // namespace osteon::gpu
