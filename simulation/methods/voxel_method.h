#pragma once

#include "simulation/methods/method_base.h"
#include "simulation/methods/voxel_grid.h"

namespace osteon::simulation {

/// Common base of the methods that store the bone as voxels. A tool touches, cuts or deletes a voxel by the
/// voxel's centre alone. The outermost centres lie half a voxel below the bone's surface on average, so
/// contact begins half a voxel too deep.
class VoxelMethod : public MethodBase {
 public:
  [[nodiscard]] std::unique_ptr<CarvedShape> Shape() const final;
  [[nodiscard]] std::size_t ElementCount() const final { return grid_.first_count(); }

 protected:
  VoxelMethod(Method method, const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
              const CuttingParams& params, double voxel_m)
      : MethodBase(method, bone, tool, X_WG, params), grid_(bone, solid, voxel_m) {}

  /// Measures the engaged area from the voxels near the cutting balls.
  void MeasureEngagement(const ToolPoints& at, const Vector3& spindle_axis, MethodFrame& frame) const;
  /// Deletes the voxels inside the cutting balls, with radii reduced by `inset_m`, and adds
  /// their volume to frame.removed_m3.
  void DeleteInside(const ToolPoints& at, double inset_m, MethodFrame& frame);
  /// Called for each voxel after its deletion.
  virtual void OnDeleted(const VoxelIndex&) {}
  void SaveBone(CarvedState& state) const override { grid_.Save(state); }
  void LoadBone(const CarvedState& state) override { grid_.Load(state); }

  VoxelGrid grid_;
};

}  // namespace osteon::simulation
