#pragma once

#include <array>
#include <vector>

#include "simulation/engine/frame_solution.h"
#include "simulation/methods/method.h"

namespace osteon::simulation {

/// The part of the cutting surface that lies in bone, for each material: its area projected onto the
/// contact's plane, and the integral of the distance from the spindle's axis over this area (as in
/// FrameSolution).
struct Engagement {
  std::array<double, kMaxMaterials> area_m2{}, moment_m3{};
};

/// A piece of material near the cutting surface: a mass point or a voxel.
struct EngagedItem {
  Vector3 p_m;
  double volume_m3;
  MaterialIndex material;
};

/// Result of one frame of a method, in G.
struct MethodFrame {
  Pose X_GP{Pose::Identity()};  ///< the proxy after the frame
  /// Fraction of the tool's path up to the first contact; 1 without contact. Methods that test no path: 0 in
  /// contact.
  double contact_fraction{1.0};
  bool touches{false};
  bool touch_cuts{false};            ///< a cutting ball touches
  Vector3 n{Vector3::Zero()};        ///< unit normal from bone to tool; zero without contact
  double depth_m{0.0};               ///< depth of the tool's pose in the bone, measured along n
  Vector3 point_m{Vector3::Zero()};  ///< point of the tool that touches, with the tool at its commanded pose
  Vector3 force_N{Vector3::Zero()};  ///< on the tool
  Vector3 torque_Nm{Vector3::Zero()};  ///< about T's origin, with the tool at its commanded pose
  Engagement engaged{};
  double advance_m{0.0};  ///< motion of the cutting surface into the bone (along -n) during the frame
  double edge_work_J{0.0}, ploughing_work_J{0.0};
  std::array<double, kMaxMaterials> removed_m3{};
};

/// Common base of all compared methods. It checks the input, sums up the removed volume and mass, applies the
/// rate law, and fills in the contact model with at most one contact.
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

  /// Computes one frame from the last proxy to the tool's pose, and removes bone.
  virtual MethodFrame Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) = 0;
  /// Writes the remaining bone into a carved state.
  virtual void SaveBone(CarvedState& state) const = 0;
  /// Sets the remaining bone from a carved state.
  /// @throws std::invalid_argument if the state belongs to another bone; the engine is unchanged then.
  virtual void LoadBone(const CarvedState& state) = 0;

  /// Adds one item to the engaged area of the tool, whose balls' centres are `at`.
  /// @param layer_m   depth of the layer of bone that measures the area
  /// @param found_by  index of the cutting ball in whose layer the item was found; an item in the layers of
  ///   several balls is counted once
  void AddEngaged(const EngagedItem& item, double layer_m, std::size_t found_by, const ToolPoints& at,
                  const Vector3& spindle_axis, MethodFrame& frame) const;
  /// Computes advance and edge work of a frame that cuts, by the cutting law of CuttingParams
  /// (ComputeAdvance).
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
