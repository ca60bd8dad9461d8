#pragma once

#include <optional>
#include <span>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/engine/frame_record.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

// Measures of a cut, independent of the engine that made it.

namespace osteon::simulation {

/// Distance from `origin_m` along the unit vector `direction` to the first ball of a union; nothing where the
/// ray meets none, 0 where the origin lies in a ball.
[[nodiscard]] std::optional<double> FirstHit(std::span<const Ball> balls, const Vector3& origin_m,
                                             const Vector3& direction);

/// The remaining balls; for split balls, their children.
[[nodiscard]] std::vector<Ball> LiveBalls(const CarvedState& state);

/// Depth of the tool's apex at a proxy pose, below the cup's first floor (of the uncut balls, along the cup's
/// axis) [m].
class ApexDepth {
 public:
  ApexDepth(const Bone& bone, const Tool& tool);
  /// Depth at a pose; negative above the floor.
  [[nodiscard]] double DepthAt(const Pose& X_GP) const;
  /// Distance of the first floor from the cup's centre.
  [[nodiscard]] double floor_m() const { return floor_m_; }

 private:
  CutSite cup_;
  Vector3 head_T_m_;
  double head_radius_m_;
  double floor_m_;
};

/// Depth of the tool's apex in the bone along the cup's axis since its first touch, gathered frame by frame.
///
/// Only new depth in which bone was removed counts. It is divided into steps of 0.25 mm; a step counts where
/// its removed volume over its depth is at least 0.5 % of the head's cross-section (and 0.2 mm²). A tool that
/// slides past the bone, or is through it, does not ream.
class ReamedDepth {
 public:
  ReamedDepth(const Bone& bone, const Tool& tool, const Pose& X_WG);
  /// Adds a frame. Frames in which the engine reported an error, or without a number (0), are left out.
  void Add(const FrameRecord& frame);
  /// Depth so far.
  [[nodiscard]] double depth_m() const;

 private:
  /// True where enough bone was removed in the current step.
  [[nodiscard]] bool Cuts() const;

  ApexDepth apex_;
  Pose X_GW_;
  double min_area_m2_;
  double reamed_m_{0.0}, deepest_m_{0.0}, removed_m3_{0.0};
  double from_m_{0.0}, from_m3_{0.0};  // depth and removed volume at the step's beginning
  bool touched_{false}, cuts_{false};  // the tool has touched the bone; the last whole step counted
};

/// Volume of the solid that the tool's cutting balls sweep along a path of proxy poses: the solid's cells of
/// a regular grid whose centre lies within a ball's radius of the path of the ball's centre. Independent of
/// balls and mass points.
/// @param cell_m  edge of a cell; the error falls with the cell's size relative to the cut's
/// @param threads  0: one per core. The volume does not depend on them
[[nodiscard]] double SweptVolume(const Solid& solid, const Tool& tool, std::span<const Pose> X_GP,
                                 double cell_m, int threads = 0);

}  // namespace osteon::simulation
