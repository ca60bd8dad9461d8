#pragma once

#include <vector>

#include "simulation/solids/solid.h"
#include "simulation/tools/tool_fit.h"

// The exact outline of a turned tool. The tool's balls are fitted to it, and the tool's mass and the balls'
// error are computed from it.
//
//         r ▲
//           │        back ┌────────┐ shank
//           │             │         ╲  cone
//           │             │          ╲______ neck ╭──╮ head: arc about a point of the axis
//           └─────────────┴───────────────────────────◗──▶ z (feed)
//                                                     0 apex

namespace osteon::simulation {

/// One piece of an outline, from front to back in T: a straight line (cone, cylinder, or a flat face where
/// both z are equal), or an arc of a sphere whose centre lies on the axis.
struct ProfilePiece {
  double front_z_m{0.0}, front_r_m{0.0}, back_z_m{0.0}, back_r_m{0.0};
  double sphere_radius_m{0.0};  ///< 0: straight
  double sphere_z_m{0.0};
  bool cutting{true};
  double gap_m{0.0};        ///< accepted gap between this surface and the union of the balls
  double metal_ratio{1.0};  ///< share of the cross-section that is metal; below 1 where flutes are cut
};

/// A solid of revolution about T's z axis: pieces from the apex (z = 0) back, each beginning where the
/// previous one ended. Behind the last piece, the solid continues for one more diameter into the holder.
/// Otherwise balls would have to fill the edge of an end face that nothing touches.
class ToolProfile final : public Solid {
 public:
  /// @throws std::invalid_argument if pieces do not join, lead forward, have a negative radius or an end that
  ///   is not on its sphere, or enclose nothing.
  explicit ToolProfile(std::vector<ProfilePiece> pieces);

  /// The distance is exact inside and outside.
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override;
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3&) const override { return 0; }
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override;

  [[nodiscard]] const std::vector<ProfilePiece>& pieces() const { return pieces_; }
  [[nodiscard]] double length_m() const { return -pieces_.back().back_z_m; }
  /// Radius at z, 0 beyond the ends; at a step the larger radius.
  [[nodiscard]] double RadiusAt(double z_m) const;

  /// Evenly spread points of the pieces (a low-discrepancy sequence on each, and rings where they meet).
  /// At least `count` in all; more on pieces with a finer gap, and at least an eighth of `count` on each.
  /// @param seed  selects the points
  [[nodiscard]] std::vector<SurfaceSample> Sample(std::size_t count, std::uint64_t seed) const;

 private:
  std::vector<ProfilePiece> pieces_;
  double largest_r_m_{0.0};
  double end_z_m_{0.0};  ///< end of the part in the holder
};

}  // namespace osteon::simulation
