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
  /// Depth [m] of p below the surface of the ball in which p lies deepest: a lower bound of the depth below
  /// the union's surface. Negative infinity outside.
  [[nodiscard]] double Depth(const Vector3& p_G) const;
  /// Distance [m] along the ray from o in direction d (unit) to the first ball; none within max_m. A ray that
  /// starts inside a ball hits at 0.
  [[nodiscard]] std::optional<double> FirstHit(const Vector3& o_G, const Vector3& d_G, double max_m) const;

 private:
  std::vector<simulation::Ball> balls_;
  CellGrid grid_;
};

/// The balls of a bone in a carved state, without the removed ones. All of the bone's balls if the state
/// holds none (nothing was simulated). A state of another bone gives no balls.
[[nodiscard]] std::vector<simulation::Ball> CarvedBalls(const simulation::Bone& bone,
                                                        const simulation::CarvedState& state);

/// How much of a bone a picture shows around its site [m]: `radii` times the site's radius, but for each 3.2
/// radii at least 25 mm (or the whole bone), so that a small opening still shows the bone around it.
[[nodiscard]] double SiteReach(const simulation::Bone& bone, double radii);

/// The material by position: from the solid if there is one, else from the nearest mass point, cleared or
/// not.
class MaterialMap {
 public:
  /// @param solid  what the bone was packed from, or null; must outlive this
  explicit MaterialMap(std::span<const simulation::MassPoint> points,
                       const simulation::Solid* solid = nullptr);

  /// Without a solid: none if no mass point lies within reach (eight cells).
  [[nodiscard]] std::optional<simulation::MaterialIndex> At(const Vector3& p_G) const;

 private:
  const simulation::Solid* solid_;
  std::vector<simulation::MassPoint> points_;
  CellGrid grid_;
};

/// "#rrggbb" for a material in drawings, pale: by name cartilage bluish, cortical bone ivory, cancellous bone
/// reddish-yellow; other materials by index.
[[nodiscard]] const char* MaterialTint(const simulation::Bone& bone, simulation::MaterialIndex material);

/// sRGB 0 … 1 for a material in shaded pictures.
[[nodiscard]] Vector3 MaterialColor(const simulation::Bone& bone, simulation::MaterialIndex material);

}  // namespace osteon::report
