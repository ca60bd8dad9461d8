#pragma once

#include <functional>
#include <span>

#include "simulation/surface/brick_field.h"
#include "simulation/surface/capsule.h"

namespace osteon::surface {

/// Signed distance [mm] of the uncut solid at a place; negative inside. Called from several threads.
using DistanceAt = std::function<double(Vec3)>;

/// The solid before the cut: its signed distances at the nodes of a grid. Immutable; threads share it.
class SolidField {
 public:
  /// Samples a solid in a band around its surface.
  /// @param distance  exact inside; outside, exact or a lower bound
  SolidField(const BrickLayout& layout, const DistanceAt& distance);
  /// Makes the field of a union of balls (capsules of no length), for a bone whose solid is not known.
  SolidField(const BrickLayout& layout, std::span<const Capsule> balls);

  [[nodiscard]] const BrickLayout& layout() const { return layout_; }
  /// The signed distances; negative inside.
  [[nodiscard]] const BrickField& distances() const { return distances_; }

 private:
  BrickLayout layout_;
  BrickField distances_;
};

}  // namespace osteon::surface
