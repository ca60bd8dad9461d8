#pragma once

#include <span>

#include "simulation/bone/bone.h"
#include "simulation/packing/ball_forest.h"

namespace osteon::simulation {

/// The bone that is left after a method has cut it, in G. Balls, voxels and distance fields answer the same
/// query, so that methods can be compared.
class CarvedShape {
 public:
  CarvedShape() = default;
  virtual ~CarvedShape() = default;
  CarvedShape(const CarvedShape&) = delete;
  CarvedShape& operator=(const CarvedShape&) = delete;

  /// Distance [m] from p to the nearest remaining material: 0 inside, `at_most_m` if the material is farther
  /// away. Thread-safe. A probe of radius rho touches nothing at p if Distance(p, rho) >= rho.
  [[nodiscard]] virtual double Distance(const Vector3& p_G, double at_most_m) const = 0;
};

/// The union of balls. Distances are exact. The cost of a query grows about with the logarithm of the number
/// of balls.
class BallUnion final : public CarvedShape {
 public:
  /// Copies the balls, without those that have no radius (they are gone). @pre centres are finite.
  explicit BallUnion(std::span<const Ball> balls);

  [[nodiscard]] double Distance(const Vector3& p_G, double at_most_m) const override;

 private:
  BallForest forest_;
};

}  // namespace osteon::simulation
