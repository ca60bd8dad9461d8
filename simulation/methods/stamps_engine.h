#pragma once

#include "simulation/methods/ball_method.h"

namespace osteon::simulation {

/// This project's packing, but tested only at discrete poses: the approach that the paper (paper_engine.h)
/// contrasts with its continuous detection ("most other methods evaluate the material removal at distinct
/// states of the simulation").
///
/// Contact: at the tool's pose, without a path. The deepest pair pushes the tool out along the lens-weighted
/// normal, up to kPushes times (assumed), until nothing overlaps by more than kFree_m; then kHalvings
/// halvings bring it back to where it just touches. The distance moved out is the penalty's depth, and K
/// times it the force. Rotation follows the hand. Removal: one stamp per frame by every cutting ball
/// (ShrinkBall with a capsule of no length): kImmediate at the tool's pose, kRate at the pushed-out pose
/// moved along -n by the law's advance.
class StampsEngine final : public BallMethod {
 public:
  /// @param solid  see MakeMethod. @throws std::invalid_argument as MakeMethod does.
  StampsEngine(const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
               const CuttingParams& params);

  static constexpr int kPushes = 8, kHalvings = 10;
  static constexpr double kFree_m = 1e-6;
  /// Smallest cosine between pair and normal in a push: limits its length.
  static constexpr double kMinCosine = 0.3;

 protected:
  MethodFrame Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) override;

 private:
  struct Overlap {
    double depth_m{0.0};  ///< travel along n that separates the pair, limited by kMinCosine
    std::size_t tool_ball{0};
    Vector3 n{Vector3::Zero()};
  };
  /// The pair of tool ball and bone ball that overlaps most; depth 0 where none overlaps.
  [[nodiscard]] Overlap Deepest(const ToolPoints& at) const;
  /// True where any pair overlaps by more than kFree_m.
  [[nodiscard]] bool Overlaps(const ToolPoints& at) const;
};

}  // namespace osteon::simulation
