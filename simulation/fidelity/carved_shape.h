#pragma once

#include <span>

#include "simulation/bone/bone.h"
#include "simulation/packing/ball_forest.h"

namespace osteon::simulation {

/// The bone that a method has left, in G, as a probe or the eye meets it from outside. One query for balls,
/// voxels and distance fields, so that methods can be compared.
class CarvedShape {
 public:
  CarvedShape() = default;
  virtual ~CarvedShape() = default;
  CarvedShape(const CarvedShape&) = delete;
  CarvedShape& operator=(const CarvedShape&) = delete;

  /// Distance [m] from p to the nearest remaining material: 0 inside, `at_most_m` where it is farther.
  /// Thread-safe. A probe of radius rho is free at p where Distance(p, rho) >= rho.
  [[nodiscard]] virtual double Distance(const Vector3& p_G, double at_most_m) const = 0;
};

/// The union of balls. Exact; the cost of a query grows about with the logarithm of their number.
class BallUnion final : public CarvedShape {
 public:
  /// Copies the balls, without those that have no radius (they are gone). @pre centres are finite.
  explicit BallUnion(std::span<const Ball> balls);

  [[nodiscard]] double Distance(const Vector3& p_G, double at_most_m) const override;

 private:
  BallForest forest_;
};

}  // namespace osteon::simulation
