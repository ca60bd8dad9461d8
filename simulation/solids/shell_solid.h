#pragma once

#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// A hemispherical shell: inner_m <= |p| <= outer_m, z <= 0. It is the bone of a cup without any bone around.
class ShellSolid final : public Solid {
 public:
  /// @throws std::invalid_argument unless 1 mm <= inner < outer <= 1 m.
  ShellSolid(double inner_m, double outer_m);
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override;
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3&) const override { return 0; }
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override;

 private:
  double inner_m_, outer_m_;
};

}  // namespace osteon::simulation
