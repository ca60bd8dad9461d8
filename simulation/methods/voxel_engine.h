#pragma once

#include "simulation/methods/voxel_method.h"

namespace osteon::simulation {

/// A voxel volume with a finger-proxy and voxel deletion, as in drilling simulators on CHAI3D (Conti et al.,
/// CHAI 3D, 2003 on: cVoxelObject, cAlgorithmFingerProxy; proxy after Ruspini, Kolarov, Khatib 1997).
///
///     proxy ─▶ marches towards the tool, kStep voxels at a time, until a solid voxel's centre lies in a
///              tool ball; kHalvings bisections then find the contact
///           ─▶ normal: gradient of the voxels' density within kGradientReach voxels of those in the tool
///              ball
///           ─▶ marches on within that plane, then along the line of two such planes: three constraints
///     force = K (proxy - tool); then every voxel inside the cutting balls is deleted: kImmediate at the
///     tool's pose, kRate at the proxy moved along -n by the law's advance
///
/// Parameters: voxel edge (MethodParams::voxel_m); step 1 voxel (CHAI3D marches voxel by voxel); gradient
/// over two voxels (assumed: CHAI3D's central differences of binary voxels give only 26 directions);
/// stand-off of 1/8 voxel from a plane before sliding (assumed; CHAI3D's epsilon); at most kMaxSteps steps
/// per march, so the proxy of a fast tool lags behind. Improvements on the original: empty bricks of voxels
/// are skipped, so that a large tool's cost grows with its surface and not its volume; voxels are binary
/// instead of 8 bits of density. The tool turns along with the march.
class VoxelEngine final : public VoxelMethod {
 public:
  /// @throws std::invalid_argument as MakeMethod does.
  VoxelEngine(const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
              const CuttingParams& params, double voxel_m);

  static constexpr double kStep = 1.0, kStandOff = 0.125;  ///< in voxels
  static constexpr int kHalvings = 8, kGradientReach = 2, kMaxSteps = 8192;

 protected:
  MethodFrame Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) override;

 private:
  struct March {
    double fraction{1.0};  ///< travelled fraction of the path
    bool blocked{false};
    std::size_t tool_ball{0};    ///< the ball that was stopped
    Vector3 n{Vector3::Zero()};  ///< normal there; zero where the density has no gradient
  };
  /// True if a solid voxel's centre lies in a tool ball.
  [[nodiscard]] bool IsBlocked(const ToolPoints& at) const;
  /// Moves the tool from `from` towards `to` until it is blocked.
  [[nodiscard]] March MarchTowards(const ToolPoints& from, const ToolPoints& to) const;
  /// Sets normal and tool ball of a march that was blocked with the tool at `at`.
  void FindNormal(const ToolPoints& at, March& march) const;
};

}  // namespace osteon::simulation
