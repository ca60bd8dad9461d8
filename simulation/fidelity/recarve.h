#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "simulation/engine/cutting_engine.h"

// Replaces the packing of a bone while the bone is being cut: another packing of the same solid is carved
// along the same path, and takes the first one's place between two frames.

namespace osteon::simulation {

/// The path of a tool's proxy, thinned. All bone along this path is gone, so another packing must be carved
/// along it before it can replace the first one.
class ProxyTrail {
 public:
  /// @param lever_m  distance of the tool's farthest point from T's origin: a turn of one radian moves it as
  ///   far
  /// @param step_m  largest motion of any point of the tool from one stored pose to the next, unless a single
  ///   frame moves the tool farther
  ProxyTrail(double lever_m, double step_m);

  /// Allocates memory for this many poses, and writes to it. Until the trail has so many poses, Add neither
  /// allocates nor moves memory, nor causes a page fault.
  void Reserve(std::size_t places);
  /// Adds the proxy's pose of a frame. The last pose is always in the trail.
  void Add(const Pose& X_GP);
  [[nodiscard]] const std::vector<PlainPose>& places() const { return places_; }
  /// Number of stored poses that a later Add does not change: all but the last one.
  [[nodiscard]] std::size_t settled() const { return places_.empty() ? 0 : places_.size() - 1; }

 private:
  double lever_m_, step_m_;
  std::vector<PlainPose> places_;
};

/// Carves the engine's bone along these poses.
/// @param engine  with RemovalLaw::kImmediate, and with G as its world frame W
/// @returns false if the engine refused a frame or its device is lost.
[[nodiscard]] bool CarveTrail(CuttingEngine& engine, std::span<const PlainPose> places);

/// True if the proxy in the carved state is within tolerance_m of X_GP. Bone that the cutting balls do not
/// reach may have stopped the tool before.
[[nodiscard]] bool ReachedPose(const CarvedState& carved, const Pose& X_GP, double lever_m,
                               double tolerance_m);

/// Combines two states of one bone: the balls of `carved`, the packing that was carved along a trail, and all
/// else of `counted`, the packing that it replaces: cleared points, proxy, removed volume and mass, cutting
/// work and debt, and frame number.
/// @param counted  state of a bone with the same mass points; its proxy is at the trail's end
/// @throws std::invalid_argument if the numbers of mass points differ.
[[nodiscard]] CarvedState MergeCarvedStates(CarvedState carved, const CarvedState& counted);

}  // namespace osteon::simulation
