#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/removal/split_template.h"

namespace osteon::simulation {

/// A bone ball as it is now, in G. Radius 0: gone.
struct BallState {
  Vector3 center_m{Vector3::Zero()};
  double radius_m{0.0};
};

/// Rounds a ball as a carved state stores it: float32 millimetres. Both engines and every saved state then
/// continue from the same bone; each frame computes in double precision. Idempotent.
[[nodiscard]] BallState RoundToStored(const BallState& ball);

/// Volume that one cutting ball sweeps on a straight piece of its way, in G.
struct Capsule {
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};
  double radius_m{0.0};
};

/// Applies ShrinkBall for each capsule, in their order.
void Shrink(BallState& ball, std::span<const Capsule> capsules);

/// A ball that has a block for its children, but whose children are not made yet.
struct WaitingBall {
  std::uint32_t parent{0};
  BallState root{};             ///< the ball that the children are made from
  std::vector<Capsule> cuts{};  ///< capsules that have hit the root since; at most MaxCuts()
};

/// Splits one ball and cuts its children: shared by both engines. It stores the uncut packing; the caller
/// stores everything that changes.
class BallSplitter {
 public:
  /// @throws std::invalid_argument naming the value of `params` that is not accepted.
  BallSplitter(std::vector<Ball> uncut, const SplitParams& params);

  [[nodiscard]] const SplitParams& params() const { return params_; }
  /// Number of children of a ball.
  [[nodiscard]] std::size_t slots() const { return static_cast<std::size_t>(params_.children); }
  /// Number of capsules that a block has room for beside the root, two slots each.
  [[nodiscard]] std::size_t MaxCuts() const { return (slots() - 1) / 2; }
  /// Radius below which children are dropped [m].
  [[nodiscard]] double MinChildRadius_m(std::uint32_t parent) const {
    return params_.min_child_share * uncut_[parent].radius_m;
  }

  /// True where the capsules touch a ball that is large enough to be split, and no capsule removes it as a
  /// whole.
  [[nodiscard]] bool ShouldSplit(const BallState& ball, std::span<const Capsule> capsules) const;

  /// Makes the children: each as large as the template and the root allow, then cut by the stored capsules.
  void MakeChildren(const WaitingBall& waiting, std::span<BallState> children) const;
  /// Cuts the children by the capsules.
  /// @returns whether any child is left.
  bool CutChildren(std::uint32_t parent, std::span<const Capsule> capsules,
                   std::span<BallState> children) const;
  /// Stores the capsules that hit the root. Where there are too many, the rest of the ball becomes the new
  /// root instead.
  void StoreCuts(std::span<const Capsule> capsules, const BallState& shrunk, WaitingBall& waiting) const;

  /// Writes a block as in CarvedState::split_slots: slots() × 4 floats [mm].
  void Save(const WaitingBall& waiting, std::span<float> block) const;
  static void Save(std::span<const BallState> children, std::span<float> block);
  /// @param cuts  1 + number of capsules in the block, as in CarvedState::split_cuts
  [[nodiscard]] static WaitingBall LoadWaiting(std::uint32_t parent, std::uint32_t cuts,
                                               std::span<const float> block);
  static void Load(std::span<const float> block, std::span<BallState> children);

  /// @throws std::invalid_argument where the state's split balls belong to another packing or other
  ///   parameters.
  void CheckState(const CarvedState& state) const;

 private:
  SplitParams params_;
  SplitTemplate template_;
  std::vector<Ball> uncut_;
  std::vector<std::uint16_t> shape_;  ///< for each ball, the index of its shape in the template
};

}  // namespace osteon::simulation
