#pragma once

#include <span>

#include "simulation/bone.h"
#include "simulation/packing/ball_forest.h"

namespace osteon::simulation {

/// What a method has left of the bone, in G, seen from outside: what a probe feels and the eye sees. The same
/// question for balls, voxels or a distance field, so that methods can be compared.
class CarvedShape {
 public:
  CarvedShape() = default;
  virtual ~CarvedShape() = default;
  CarvedShape(const CarvedShape&) = delete;
  CarvedShape& operator=(const CarvedShape&) = delete;

  /// Distance [m] from p to the nearest material left: 0 inside, `at_most_m` where it is farther. Any number
  /// of threads may ask. A probe of radius rho is free at p where Distance(p, rho) >= rho.
  [[nodiscard]] virtual double Distance(const Vector3& p_G, double at_most_m) const = 0;
};

/// The union of balls. Exact; a question costs about the logarithm of their number.
class BallUnion final : public CarvedShape {
 public:
  /// Balls without a radius are gone and left out. @pre centres are finite.
  explicit BallUnion(std::span<const Ball> balls);

  [[nodiscard]] double Distance(const Vector3& p_G, double at_most_m) const override;

 private:
  BallForest forest_;
};

}  // namespace osteon::simulation
