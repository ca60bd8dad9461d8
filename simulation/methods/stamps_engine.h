#pragma once

#include "simulation/methods/ball_method.h"

namespace osteon::simulation {

/// A method on this project's packing that tests only discrete poses. The paper (paper_engine.h) contrasts
/// this approach with its continuous detection ("most other methods evaluate the material removal at distinct
/// states of the simulation").
///
/// Contact: only the tool's pose is tested. The deepest pair pushes the tool out along the normal that is
/// weighted by the volumes of intersection, up to kPushes times (assumed), until no pair overlaps by more
/// than kFree_m. Then kHalvings bisections move the tool back until it just touches. The force is K times the
/// distance between this pose and the tool's pose. The proxy's rotation is that of the tool. Removal: every
/// cutting ball removes one ball (a stamp) per frame (ShrinkBall with a capsule of no length): kImmediate at
/// the tool's pose, kRate at the pushed-out pose, moved along -n by the law's advance.
class StampsEngine final : public BallMethod {
 public:
  /// @param solid  see MakeMethod. @throws std::invalid_argument as MakeMethod does.
  StampsEngine(const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
               const CuttingParams& params);

  static constexpr int kPushes = 8, kHalvings = 10;
  static constexpr double kFree_m = 1e-6;
  /// Smallest cosine of the angle between the pair's direction and the normal that a push uses. It limits the
  /// push's length.
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
  /// True if any pair overlaps by more than kFree_m.
  [[nodiscard]] bool Overlaps(const ToolPoints& at) const;
};

}  // namespace osteon::simulation
