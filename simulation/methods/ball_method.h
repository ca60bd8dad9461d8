#pragma once

#include "simulation/methods/ball_bone.h"
#include "simulation/methods/method_base.h"

namespace osteon::simulation {

/// Common base of the methods with balls and mass points.
class BallMethod : public MethodBase {
 public:
  [[nodiscard]] std::unique_ptr<CarvedShape> Shape() const final;
  [[nodiscard]] std::size_t ElementCount() const final { return bone_.balls().size(); }

 protected:
  BallMethod(Method method, const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
             const CuttingParams& params)
      : MethodBase(method, bone, tool, X_WG, params), bone_(bone, solid) {}

  /// Adds the engaged area to `frame`. It is measured from the mass points within the engaged layer at the
  /// cutting balls' surfaces.
  void MeasureEngagement(const ToolPoints& at, const Vector3& spindle_axis, MethodFrame& frame) const;
  void SaveBone(CarvedState& state) const final { bone_.Save(state); }
  void LoadBone(const CarvedState& state) final { bone_.Load(state); }

  BallBone bone_;
};

}  // namespace osteon::simulation
