#pragma once

#include <cmath>

#include "simulation/solid.h"

// Solids with distances that can be checked by eye.

namespace osteon::simulation {

class BoxSolid final : public Solid {
 public:
  explicit BoxSolid(const Vector3& size_m) : half_m_(0.5 * size_m) {}
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p) const override {
    if ((p.cwiseAbs() - half_m_).maxCoeff() > 0.0) {
      const Vector3 foot = p.cwiseMin(half_m_).cwiseMax(-half_m_);
      return {.p_m = foot, .distance_m = (p - foot).norm()};
    }
    int axis = 0;
    (half_m_ - p.cwiseAbs()).minCoeff(&axis);
    Vector3 foot = p;
    foot[axis] = std::copysign(half_m_[axis], p[axis]);
    return {.p_m = foot, .distance_m = std::abs(p[axis]) - half_m_[axis]};
  }
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3&) const override { return 0; }
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override { return {-half_m_, half_m_}; }
  [[nodiscard]] double volume_m3() const { return 8.0 * half_m_.prod(); }

 private:
  Vector3 half_m_;
};

class BallSolid final : public Solid {
 public:
  BallSolid(const Vector3& center_m, double radius_m) : center_m_(center_m), radius_m_(radius_m) {}
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p) const override {
    const double from_center = (p - center_m_).norm();
    const Vector3 out = from_center > 0.0 ? Vector3((p - center_m_) / from_center) : Vector3::UnitX();
    return {.p_m = center_m_ + radius_m_ * out, .distance_m = from_center - radius_m_};
  }
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3&) const override { return 0; }
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override {
    return {center_m_ - Vector3::Constant(radius_m_), center_m_ + Vector3::Constant(radius_m_)};
  }

 private:
  Vector3 center_m_;
  double radius_m_;
};

}  // namespace osteon::simulation
