#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "simulation/engine/cutting_engine.h"

// Repacks a bone that is being cut: another packing of the same solid is carved in the same way, and replaces
// the first one between two frames.

namespace osteon::simulation {

/// Places of a tool's proxy, thinned. All bone that the tool has passed is gone, so another packing must be
/// carved along this trail.
class ProxyTrail {
 public:
  /// @param lever_m  of the tool: distance that a turn of one radian moves its farthest point
  /// @param step_m   largest motion of the tool's points from one place to the next, unless a single frame
  ///   moved them farther
  ProxyTrail(double lever_m, double step_m);

  /// Allocates memory for this many places and writes to it. Up to this number, adding a place then neither
  /// allocates nor moves memory, nor causes a page fault.
  void Reserve(std::size_t places);
  /// Adds the proxy's pose of a frame. The last pose is always in the trail.
  void Add(const Pose& X_GP);
  [[nodiscard]] const std::vector<PlainPose>& places() const { return places_; }
  /// Number of places that later poses do not change: all but the last one.
  [[nodiscard]] std::size_t settled() const { return places_.empty() ? 0 : places_.size() - 1; }

 private:
  double lever_m_, step_m_;
  std::vector<PlainPose> places_;
};

/// Carves along these places.
/// @param engine  with RemovalLaw::kImmediate, and with G as its world frame W
/// @returns false where a frame was refused or the device is lost.
[[nodiscard]] bool CarveTrail(CuttingEngine& engine, std::span<const PlainPose> places);

/// True where the tool reached X_GP. Bone that its cutting balls do not reach may stop it before.
[[nodiscard]] bool ReachedPose(const CarvedState& carved, const Pose& X_GP, double lever_m,
                               double tolerance_m);

/// Takes the balls of a packing that was carved along a trail, and the totals (cleared points, removed volume
/// and mass, work, frames) of the packing of the same bone that it replaces.
/// @param counted  with the same mass points; its proxy is the trail's end
/// @throws std::invalid_argument where the numbers of points differ.
[[nodiscard]] CarvedState MergeBooks(CarvedState carved, const CarvedState& counted);

}  // namespace osteon::simulation
