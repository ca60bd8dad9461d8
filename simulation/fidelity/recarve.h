#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "simulation/cutting_engine.h"

// A bone that is being cut, packed anew: another packing of the same solid is carved as this one was, and
// takes its place between two frames.

namespace osteon::simulation {

/// Where a tool's proxy has been, thinned. All that the tool has passed is free of bone, so that this is what
/// another packing has to give way to.
class ProxyTrail {
 public:
  /// @param lever_m  of the tool: how far a turn of one radian carries its farthest point
  /// @param step_m   the tool's points go no farther from one place to the next, but for a single frame's way
  ProxyTrail(double lever_m, double step_m);

  /// A frame's free pose. The last one is always there.
  void Add(const Pose& X_GP);
  [[nodiscard]] const std::vector<PlainPose>& places() const { return places_; }
  /// Places that stay as they are whatever is added: all but the last one.
  [[nodiscard]] std::size_t settled() const { return places_.empty() ? 0 : places_.size() - 1; }

 private:
  double lever_m_, step_m_;
  std::vector<PlainPose> places_;
};

/// Carves along these places. @param engine  with RemovalLaw::kImmediate, and the frame W in G's place
/// @returns false where a frame was refused or the device is lost.
[[nodiscard]] bool CarveTrail(CuttingEngine& engine, std::span<const PlainPose> places);

/// Whether the tool went all the way: bone that its cutting balls do not reach may hold it.
[[nodiscard]] bool Arrived(const CarvedState& carved, const Pose& X_GP, double lever_m, double tolerance_m);

/// The state of a packing that was carved along a trail, with what has been counted on another one of the
/// same bone: cleared points, volume, mass, work.
/// @param counted  of the same mass points; its proxy is where the trail ends
/// @throws std::invalid_argument where the numbers of points differ.
[[nodiscard]] CarvedState TakeOver(CarvedState carved, const CarvedState& counted);

}  // namespace osteon::simulation
