#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/cutting_engine.h"
#include "simulation/split_template.h"

namespace osteon::simulation {

/// A bone ball as it is now, in G. Radius 0: gone.
struct BallState {
  Vector3 center_m{Vector3::Zero()};
  double radius_m{0.0};
};

/// The ball as a carved state keeps it: float32 millimetres. So both engines and every saved state go on from
/// the same bone; what each frame does with it is double precision. Idempotent.
[[nodiscard]] BallState Stored(const BallState& ball);

/// What one cutting ball sweeps on a straight piece of its way, in G.
struct Capsule {
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};
  double radius_m{0.0};
};

/// ShrinkBall by each capsule, in their order.
void Shrink(BallState& ball, std::span<const Capsule> capsules);

/// A ball that has a block for its children but not yet these.
struct WaitingBall {
  std::uint32_t parent{0};
  BallState root{};             ///< what the children are made from
  std::vector<Capsule> cuts{};  ///< that have hit the root since; MostCuts() of them at most
};

/// How one ball is split and its children are cut: what engines share. Knows the uncut packing; what changes
/// is the caller's.
class BallSplitter {
 public:
  /// @throws std::invalid_argument naming the value of `params` that is not accepted.
  BallSplitter(std::vector<Ball> uncut, const SplitParams& params);

  [[nodiscard]] const SplitParams& params() const { return params_; }
  /// Children of a ball.
  [[nodiscard]] std::size_t slots() const { return static_cast<std::size_t>(params_.children); }
  /// A block's room less the root, two slots a capsule.
  [[nodiscard]] std::size_t MostCuts() const { return (slots() - 1) / 2; }
  /// Children below this are dropped [m].
  [[nodiscard]] double LeastChild(std::uint32_t parent) const {
    return params_.least_child_share * uncut_[parent].radius_m;
  }

  /// Whether the capsules touch a ball that is so large that it should be split, and none takes it as a
  /// whole.
  [[nodiscard]] bool IsTooLarge(const BallState& ball, std::span<const Capsule> capsules) const;

  /// Each child as large as it may be within the template's and within the root, cut by what has hit it.
  void MakeChildren(const WaitingBall& waiting, std::span<BallState> children) const;
  /// @returns whether any child is left.
  bool CutChildren(std::uint32_t parent, std::span<const Capsule> capsules,
                   std::span<BallState> children) const;
  /// Notes the capsules that hit the root. Where there are too many, what is left of the ball stands for
  /// them.
  void Keep(std::span<const Capsule> capsules, const BallState& shrunk, WaitingBall& waiting) const;

  /// A block as CarvedState::split_slots has it: slots() × 4 floats [mm].
  void Save(const WaitingBall& waiting, std::span<float> block) const;
  static void Save(std::span<const BallState> children, std::span<float> block);
  [[nodiscard]] static WaitingBall LoadWaiting(std::uint32_t parent, std::uint32_t cuts,
                                               std::span<const float> block);
  static void Load(std::span<const float> block, std::span<BallState> children);

  /// @throws std::invalid_argument where the state's split balls are not of this packing and these
  /// parameters.
  void CheckState(const CarvedState& state) const;

 private:
  SplitParams params_;
  SplitTemplate template_;
  std::vector<Ball> uncut_;
  std::vector<std::uint16_t> shape_;  ///< of each ball, in the template
};

}  // namespace osteon::simulation
