#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/removal/split_template.h"

namespace osteon::simulation {

/// The present state of a bone ball, in G. Radius 0: the ball is gone.
struct BallState {
  Vector3 center_m{Vector3::Zero()};
  double radius_m{0.0};
};

/// Rounds a ball to the precision of a carved state: float32 millimetres. With this rounding after each
/// frame, both engines and every saved state continue from the same bone; within a frame, engines compute in
/// double precision. Rounding twice changes nothing.
[[nodiscard]] BallState RoundToStored(const BallState& ball);

/// Volume that one cutting ball sweeps on a straight piece of its path, in G.
struct Capsule {
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};
  double radius_m{0.0};
};

/// Shrinks a ball by each capsule (ShrinkBall), in the capsules' order.
void Shrink(BallState& ball, std::span<const Capsule> capsules);

/// A ball that has a block for its children, but whose children are not made yet (BallRemoval).
struct WaitingBall {
  std::uint32_t parent{0};
  BallState root{};             ///< the ball from which the children will be made
  std::vector<Capsule> cuts{};  ///< capsules that have hit the root since; at most MaxCuts()
};

/// Splits balls and cuts their children; used by both engines. It stores the uncut packing and the template;
/// the caller stores everything that changes.
class BallSplitter {
 public:
  /// @throws std::invalid_argument naming the value of `params` that is not accepted.
  BallSplitter(std::vector<Ball> uncut, const SplitParams& params);

  [[nodiscard]] const SplitParams& params() const { return params_; }
  /// Number of slots in a block: one for each child of a split ball.
  [[nodiscard]] std::size_t slots() const { return static_cast<std::size_t>(params_.children); }
  /// Number of capsules that fit into a block in addition to the root. A capsule takes two slots.
  [[nodiscard]] std::size_t MaxCuts() const { return (slots() - 1) / 2; }
  /// Radius below which children are dropped [m].
  [[nodiscard]] double MinChildRadius_m(std::uint32_t parent) const {
    return params_.min_child_share * uncut_[parent].radius_m;
  }

  /// True if the ball is large enough to be split, a capsule touches it, and no capsule removes the whole
  /// ball.
  [[nodiscard]] bool ShouldSplit(const BallState& ball, std::span<const Capsule> capsules) const;

  /// Makes the children: each is as large as the template and the root allow, and is then cut by the stored
  /// capsules.
  void MakeChildren(const WaitingBall& waiting, std::span<BallState> children) const;
  /// Cuts the children by the capsules.
  /// @returns whether any child is left.
  bool CutChildren(std::uint32_t parent, std::span<const Capsule> capsules,
                   std::span<BallState> children) const;
  /// Stores the capsules that hit the root. If they do not fit into the block, the shrunken ball becomes the
  /// new root, and the stored capsules are dropped.
  void StoreCuts(std::span<const Capsule> capsules, const BallState& shrunk, WaitingBall& waiting) const;

  /// Writes a block as in CarvedState::split_slots: slots() × 4 floats [mm].
  void Save(const WaitingBall& waiting, std::span<float> block) const;
  static void Save(std::span<const BallState> children, std::span<float> block);
  /// Reads a waiting ball from a block that Save wrote.
  /// @param cuts  1 + number of capsules in the block, as in CarvedState::split_cuts
  [[nodiscard]] static WaitingBall LoadWaiting(std::uint32_t parent, std::uint32_t cuts,
                                               std::span<const float> block);
  static void Load(std::span<const float> block, std::span<BallState> children);

  /// @throws std::invalid_argument if the state's split balls belong to another packing or other parameters.
  void CheckState(const CarvedState& state) const;

 private:
  SplitParams params_;
  SplitTemplate template_;
  std::vector<Ball> uncut_;
  std::vector<std::uint16_t> shape_;  ///< for each ball, the index of its shape in the template
};

}  // namespace osteon::simulation
