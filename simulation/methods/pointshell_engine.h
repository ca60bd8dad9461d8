#pragma once

#include <deque>
#include <vector>

#include "simulation/methods/pointshell.h"
#include "simulation/methods/voxel_method.h"

namespace osteon::simulation {

/// Voxmap and pointshell (VPS): McNeely, Puterbaugh, Troy, "Six Degree-of-Freedom Haptic Rendering Using
/// Voxel Sampling", SIGGRAPH 1999; quasi-static coupling after Wan, McNeely, "Quasi-Static Approximation for
/// 6 Degrees-of-Freedom Haptic Rendering", IEEE Visualization 2003. The method computes penalty forces at
/// discrete poses.
///
/// Voxmap: each solid voxel stores its depth L, counted in layers: the chamfer distance 3-4-5 from the air.
/// Depths end at kLayers layers, and are updated around deleted voxels. The force f on a tool point p in such
/// a voxel refers to the tangent plane through the voxel's centre c:
///
///     d = n·(c - p) + (L - 1) h,  f = k_p d n   if d > 0;  n: inward normal of the point; h: edge of a voxel
///
/// If N > kFullPoints points touch, the sum of their forces is divided by N / kFullPoints (section 5.3 of the
/// first paper). Coupling: the proxy is where the coupling's force K (tool - proxy), at most the force limit,
/// balances the penalty. It is found by kNewtonSteps Newton steps per frame from the last frame's proxy. The
/// coupling's force is rendered. The proxy's rotation is that of the tool (assumed: this cell's coupling has
/// no rotational spring); the torque is that of the points. Removal: each frame deletes the voxels inside the
/// cutting balls at one pose. kImmediate: at the tool's pose. kRate: at the proxy, moved along -n by the
/// law's advance, with the balls' radii reduced by the deepest point's depth.
///
/// Parameters: voxel edge (MethodParams::voxel_m), points (::point_spacing_m; VPS: one voxel); k_p =
/// kPointStiffness K (assumed), so that ten touching points are 20 times as stiff as the coupling; kLayers =
/// 8 (assumed: the paper stores only the layer at the surface); kNewtonSteps = 2 (assumed: the papers take
/// one step).
class PointshellEngine final : public VoxelMethod {
 public:
  /// @throws std::invalid_argument as MakeMethod does.
  PointshellEngine(const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
                   const CuttingParams& params, const MethodParams& method_params);

  static constexpr int kLayers = 8, kFullPoints = 10, kNewtonSteps = 2;
  static constexpr double kPointStiffness = 2.0;

  /// Stored depth of a voxel in thirds of a voxel: 0 in the air, 3 at the surface, at most 3 kLayers.
  [[nodiscard]] int LayerOf(const VoxelIndex& v) const {
    return grid_.IsSolid(v) ? layer_[grid_.SlotOf(v)] : 0;
  }

 protected:
  MethodFrame Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) override;
  void OnDeleted(const VoxelIndex& v) override { changed_.push_back(v); }
  void LoadBone(const CarvedState& state) override;

 private:
  /// Sum of the forces on the tool's points.
  struct Penalty {
    Vector3 force_N{Vector3::Zero()}, torque_Nm{Vector3::Zero()};  ///< about T's origin
    Matrix3 stiffness_N_per_m{Matrix3::Zero()};
    Vector3 point_m{Vector3::Zero()};  ///< mean of the touching points, weighted by their depth
    double deepest_m{0.0};
    bool cutting{false};  ///< the deepest point belongs to a cutting ball
    int points{0};
  };
  /// The points' forces with the tool at X_G.
  [[nodiscard]] Penalty PenaltyAt(const Pose& X_G) const;
  /// Computes the depths of all voxels anew.
  void FindLayers();
  /// Updates the depths of the voxels around those in changed_, whose depths became smaller. Then empties
  /// changed_.
  void SpreadChanges();

  Pointshell shell_;
  std::vector<std::uint8_t> layer_;  ///< depth of each voxel by its slot, in thirds of a voxel
  std::deque<VoxelIndex> changed_;
};

}  // namespace osteon::simulation
