#pragma once

#include <optional>
#include <span>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/engine/frame_record.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

// Measures of a cut that do not depend on the engine that made it.

namespace osteon::simulation {

/// Distance along a ray from `origin_m` in the unit direction `direction` to the first ball that it meets; 0
/// if the origin lies in a ball, nothing if the ray meets no ball.
[[nodiscard]] std::optional<double> FirstHit(std::span<const Ball> balls, const Vector3& origin_m,
                                             const Vector3& direction);

/// The remaining balls of a state. A split ball is represented by its remaining children.
[[nodiscard]] std::vector<Ball> LiveBalls(const CarvedState& state);

/// Measures the depth [m] of the tool's apex at a proxy pose along the cup's axis, below the original floor:
/// the first uncut ball on the axis.
class ApexDepth {
 public:
  ApexDepth(const Bone& bone, const Tool& tool);
  /// Depth at a pose; negative above the original floor.
  [[nodiscard]] double DepthAt(const Pose& X_GP) const;
  /// Distance of the original floor from the cup's centre.
  [[nodiscard]] double floor_m() const { return floor_m_; }

 private:
  CutSite cup_;
  Vector3 head_T_m_;
  double head_radius_m_;
  double floor_m_;
};

/// Depth along the cup's axis that the tool's apex has reamed since the first touch, summed up frame by
/// frame.
///
/// Only depth that the apex reaches for the first time is counted, in steps of 0.25 mm. A step counts if the
/// volume removed during it, divided by its depth, is at least 0.5 % of the head's cross-section and 0.2 mm².
/// So a tool that slides past the bone, or has passed through it, reams no depth.
class ReamedDepth {
 public:
  ReamedDepth(const Bone& bone, const Tool& tool, const Pose& X_WG);
  /// Adds a frame. Frames in which the engine reported an error, or whose number is 0, are left out.
  void Add(const FrameRecord& frame);
  /// Reamed depth so far.
  [[nodiscard]] double depth_m() const;

 private:
  /// True if enough bone was removed in the current step.
  [[nodiscard]] bool Cuts() const;

  ApexDepth apex_;
  Pose X_GW_;
  double min_area_m2_;
  double reamed_m_{0.0}, deepest_m_{0.0}, removed_m3_{0.0};
  double from_m_{0.0}, from_m3_{0.0};  // depth and removed volume at the step's beginning
  // touched_: the tool has touched the bone; cuts_: the last complete step counted
  bool touched_{false}, cuts_{false};
};

/// Volume of the part of the solid that the tool's cutting balls sweep along a path of proxy poses. It is the
/// volume of those cells of a regular grid whose centres lie in the solid and in the sweep of a ball. It does
/// not depend on the packing and the mass points.
/// @param cell_m  edge of a cell; the smaller it is relative to the cut, the smaller is the error
/// @param threads  0: one per core. The volume does not depend on them
[[nodiscard]] double SweptVolume(const Solid& solid, const Tool& tool, std::span<const Pose> X_GP,
                                 double cell_m, int threads = 0);

}  // namespace osteon::simulation
