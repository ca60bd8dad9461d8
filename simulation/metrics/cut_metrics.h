#pragma once

#include <optional>
#include <span>
#include <vector>

#include "simulation/bone.h"
#include "simulation/cutting_engine.h"
#include "simulation/frame_record.h"
#include "simulation/solids/solid.h"
#include "simulation/tool.h"

// What a cut is measured by, independently of the engine that made it.

namespace osteon::simulation {

/// Distance from `origin_m` along the unit vector `direction` to the first ball of a union; nothing where
/// none is met, 0 where the origin lies in one.
[[nodiscard]] std::optional<double> FirstHit(std::span<const Ball> balls, const Vector3& origin_m,
                                             const Vector3& direction);

/// The balls that are left; of those that were split, the children.
[[nodiscard]] std::vector<Ball> LiveBalls(const CarvedState& state);

/// How far the tool's apex was below the cup's first floor (of the uncut balls, along the cup's axis) at one
/// proxy pose [m].
class ApexDepth {
 public:
  ApexDepth(const Bone& bone, const Tool& tool);
  /// Negative above the floor.
  [[nodiscard]] double Of(const Pose& X_GP) const;
  /// Distance of the first floor from the cup's centre.
  [[nodiscard]] double floor_m() const { return floor_m_; }

 private:
  Cup cup_;
  Vector3 head_T_m_;
  double head_radius_m_;
  double floor_m_;
};

/// How far the tool's apex went into the bone along the cup's axis, from the frame of its first touch on,
/// gathered frame by frame.
///
/// Only new depth counts in which bone went: in steps of 0.25 mm, those in which the removed volume over the
/// depth is at least 0.5 % of the head's cross-section (and 0.2 mm²). A tool that slides past the bone, or
/// that is through it, does not ream.
class ReamedDepth {
 public:
  ReamedDepth(const Bone& bone, const Tool& tool, const Pose& X_WG);
  /// Frames in which the engine reported an error, or that are no frame (number 0), are left out.
  void Add(const FrameRecord& frame);
  /// So far.
  [[nodiscard]] double depth_m() const;

 private:
  [[nodiscard]] bool Cuts() const;

  ApexDepth apex_;
  Pose X_GW_;
  double min_area_m2_;
  double reamed_m_{0.0}, deepest_m_{0.0}, removed_m3_{0.0};
  double from_m_{0.0}, from_m3_{0.0};  // depth and removed volume where the step began
  bool touched_{false}, cuts_{false};
};

/// Volume of the solid that the tool's cutting balls sweep along a path of proxy poses: the solid's cells of
/// a regular grid whose centre lies within a ball's radius of its centre's path. Independent of balls and
/// mass points.
/// @param cell_m  edge of a cell; the error falls with the cell's size over the cut's
/// @param threads  0: one a core. The volume does not depend on them
[[nodiscard]] double SweptVolume(const Solid& solid, const Tool& tool, std::span<const Pose> X_GP,
                                 double cell_m, int threads = 0);

}  // namespace osteon::simulation
