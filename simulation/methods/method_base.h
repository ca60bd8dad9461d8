#pragma once

#include <array>
#include <vector>

#include "simulation/engine/frame_solution.h"
#include "simulation/methods/method.h"

namespace osteon::simulation {

/// Cutting surface in bone, by material: area projected on the plane normal to the force, and this area times
/// its distance to the spindle's axis (as in FrameSolution).
struct Engagement {
  std::array<double, kMaxMaterials> area_m2{}, moment_m3{};
};

/// One material item (a mass point, a voxel) near the cutting surface.
struct EngagedItem {
  Vector3 p_m;
  double volume_m3;
  MaterialIndex material;
};

/// Result of one frame of a method, in G.
struct MethodFrame {
  Pose X_GP{Pose::Identity()};  ///< the proxy after the frame
  /// Share of the path up to the first contact; 1 without contact. Methods without a path: 0 in contact.
  double contact_fraction{1.0};
  bool touches{false};
  bool touch_cuts{false};              ///< a cutting ball touches
  Vector3 n{Vector3::Zero()};          ///< unit, from bone to tool; zero where free
  double depth_m{0.0};                 ///< distance of the tool's pose beyond the surface, along n
  Vector3 point_m{Vector3::Zero()};    ///< touching point on the tool at the tool's pose
  Vector3 force_N{Vector3::Zero()};    ///< on the tool
  Vector3 torque_Nm{Vector3::Zero()};  ///< about T's origin at the tool's pose
  Engagement engaged{};
  double advance_m{0.0};  ///< of the cutting surface into the bone, against n, during the frame
  double edge_work_J{0.0}, ploughing_work_J{0.0};
  std::array<double, kMaxMaterials> removed_m3{};
};

/// The common part of all compared methods: checks the input, counts what is removed, applies the rate law,
/// and fills the contact model with at most one contact.
class MethodBase : public MethodEngine {
 public:
  ContactModel Step(const FrameInput& input) final;
  [[nodiscard]] CarvedState Snapshot() const final;
  void Restore(const CarvedState& state) final;
  [[nodiscard]] std::string name() const final { return std::string(MethodName(method_)); }
  [[nodiscard]] std::string device() const final { return "CPU, double precision, one thread"; }

 protected:
  /// @throws std::invalid_argument as MakeMethod does.
  MethodBase(Method method, const Bone& bone, const Tool& tool, const Pose& X_WG,
             const CuttingParams& params);

  /// Computes one frame between the last proxy and the tool's pose; changes the bone.
  virtual MethodFrame Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) = 0;
  /// Writes the remaining bone into the state.
  virtual void SaveBone(CarvedState& state) const = 0;
  /// Sets the remaining bone from the state.
  /// @throws std::invalid_argument where the state belongs to another bone; nothing has changed then.
  virtual void LoadBone(const CarvedState& state) = 0;

  /// Adds one item to the engaged area of the tool placed at `at`.
  /// @param layer_m   depth of the layer of bone that measures the area
  /// @param found_by  the cutting ball in whose layer the item was found; an item that is found by several
  ///   balls is counted for the first of them
  void AddEngaged(const EngagedItem& item, double layer_m, std::size_t found_by, const ToolPoints& at,
                  const Vector3& spindle_axis, MethodFrame& frame) const;
  /// Sets advance and edge work of a frame that cuts, by the law of `params` (ComputeAdvance).
  /// @param slide_m  distance that the proxy slides along the surface in this frame
  void Advance(const FrameInput& input, double slide_m, MethodFrame& frame) const;
  /// Applies the spring force `stiffness * depth` along n at `point_m`, at most the force limit.
  void PushAlongNormal(const Vector3& origin_T, MethodFrame& frame) const;

  const Tool tool_;
  const std::vector<Material> materials_;
  const CuttingParams params_;

 private:
  const Method method_;
  const Pose X_WG_;
  const MaterialMap map_;
  FrameMemory memory_;
};

}  // namespace osteon::simulation
