#pragma once

#include <optional>
#include <span>
#include <vector>

#include "report/cell_grid.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/solids/solid.h"

namespace osteon::report {

/// A union of balls in G, for queries.
class BallField {
 public:
  /// Balls without a finite centre or a positive radius are left out.
  explicit BallField(std::vector<simulation::Ball> balls);

  [[nodiscard]] const std::vector<simulation::Ball>& balls() const { return balls_; }
  /// Returns the depth [m] of p below the surface of the ball in which p lies deepest: a lower bound of the
  /// depth below the union's surface. Negative infinity if p is in no ball.
  [[nodiscard]] double Depth(const Vector3& p_G) const;
  /// Returns the distance [m] along the ray from o in direction d (unit vector) to the first ball; nothing if
  /// there is no ball within max_m. A ray that starts inside a ball hits at 0.
  [[nodiscard]] std::optional<double> FirstHit(const Vector3& o_G, const Vector3& d_G, double max_m) const;

 private:
  std::vector<simulation::Ball> balls_;
  CellGrid grid_;
};

/// Returns the balls of a bone in a carved state, without the removed ones. If the state holds no balls
/// (nothing was simulated), returns all balls of the bone. A state of another bone gives no balls.
[[nodiscard]] std::vector<simulation::Ball> CarvedBalls(const simulation::Bone& bone,
                                                        const simulation::CarvedState& state);

/// Returns the distance from the site up to which a picture shows the bone [m]. It is `radii` times the
/// site's radius, but at least `radii` times 25 mm / 3.2 if the bone extends that far, so that a small
/// opening is shown with bone around it.
[[nodiscard]] double SiteReach(const simulation::Bone& bone, double radii);

/// Finds the material at a position: from the solid if there is one, else from the nearest mass point,
/// whether it is cleared or not.
class MaterialMap {
 public:
  /// @param solid  the solid from which the bone was packed, or null; must outlive this
  explicit MaterialMap(std::span<const simulation::MassPoint> points,
                       const simulation::Solid* solid = nullptr);

  /// Returns the material at p. Without a solid, returns nothing if there is no mass point within eight grid
  /// cells.
  [[nodiscard]] std::optional<simulation::MaterialIndex> At(const Vector3& p_G) const;

 private:
  const simulation::Solid* solid_;
  std::vector<simulation::MassPoint> points_;
  CellGrid grid_;
};

/// Returns a pale colour "#rrggbb" for a material in drawings: cartilage bluish, cortical bone ivory,
/// cancellous bone reddish-yellow, each by its name; other materials by index.
[[nodiscard]] const char* MaterialTint(const simulation::Bone& bone, simulation::MaterialIndex material);

/// Returns the colour of a material in shaded pictures, sRGB 0 … 1.
[[nodiscard]] Vector3 MaterialColor(const simulation::Bone& bone, simulation::MaterialIndex material);

}  // namespace osteon::report
