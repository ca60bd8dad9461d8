#pragma once

#include "base/check_range.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// A ball of one material, with G's origin at its centre: the simplest solid for testing a packing.
class BallSolid final : public Solid {
 public:
  /// @throws std::invalid_argument unless the radius is 0.1 … 500 mm.
  explicit BallSolid(double radius_m) : radius_m_(radius_m) {
    CheckRangeMm("ball: radius", radius_m, 0.1e-3, 0.5);
  }

  /// The distance is exact inside and outside. At the centre, all points of the surface are equally near; one
  /// of them is returned.
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override {
    const double distance_m = p_m.norm();
    const Vector3 out = distance_m > 0.0 ? Vector3(p_m / distance_m) : Vector3(Vector3::UnitX());
    return {.p_m = radius_m_ * out, .distance_m = distance_m - radius_m_};
  }
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3&) const override { return 0; }
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override {
    return {Vector3::Constant(-radius_m_), Vector3::Constant(radius_m_)};
  }

 private:
  double radius_m_;
};

}  // namespace osteon::simulation
