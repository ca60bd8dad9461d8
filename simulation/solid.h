#pragma once

#include "simulation/bone.h"

#include <Eigen/Geometry>

namespace osteon::simulation {

/// The three tissues of a bone scene: indices into Bone::materials.
enum BoneTissue : MaterialIndex { kCartilage = 0, kCortical = 1, kCancellous = 2 };

/// The nearest point of a solid's surface.
struct SurfacePoint {
  Vector3 p_m{Vector3::Zero()};
  double distance_m{0.0};  ///< signed: negative inside the solid, positive outside
};

/// A closed solid of bone in G, with a cup that is to be reamed. Packings and mass points are built from this
/// alone.
///
/// Signed distances are negative inside. Inside they are exact (a ball of radius -distance around p lies in
/// the solid); that a packing never leaves its solid rests on it.
class Solid {
 public:
  explicit Solid(const Cup& cup) : cup_(cup) {}
  virtual ~Solid() = default;
  Solid(const Solid&) = delete;
  Solid& operator=(const Solid&) = delete;

  [[nodiscard]] virtual SurfacePoint NearestSurface(const Vector3& p_m) const = 0;
  [[nodiscard]] virtual MaterialIndex MaterialAt(const Vector3& p_m) const = 0;
  [[nodiscard]] virtual Eigen::AlignedBox3d Bounds() const = 0;

  [[nodiscard]] virtual double SignedDistance(const Vector3& p_m) const {
    return NearestSurface(p_m).distance_m;
  }

  [[nodiscard]] const Cup& cup() const { return cup_; }

  /// Depth of p below the cuttable surface: its distance to what a reamer of the cup's radius sweeps on its
  /// way in, the ray from the cup's centre along its axis, thickened by the radius. Negative in there.
  /// 1-Lipschitz.
  [[nodiscard]] double DepthBelowCup(const Vector3& p_m) const {
    const Vector3 d = p_m - Vector3(cup_.center_m);
    const double along = std::max(0.0, d.dot(Vector3(cup_.axis)));
    return (d - along * Vector3(cup_.axis)).norm() - cup_.radius_m;
  }

 private:
  Cup cup_;
};

}  // namespace osteon::simulation
