#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "simulation/bone/bone.h"

namespace osteon::simulation {

/// The tissues of a bone scene: indices into Bone::materials.
enum BoneTissue : MaterialIndex { kCartilage = 0, kCortical = 1, kCancellous = 2, kMarrow = 3 };

/// The nearest point of a solid's surface.
struct SurfacePoint {
  Vector3 p_m{Vector3::Zero()};
  double distance_m{0.0};  ///< signed: negative inside the solid, positive outside
};

/// A closed solid of bone in G. Balls and mass points are made from the solid and its cut zone (cut_zone.h).
///
/// Signed distances are negative inside. Inside they must be exact: a ball around p with this distance as its
/// radius lies in the solid. Packings rely on this to stay within their solid.
class Solid {
 public:
  Solid() = default;
  virtual ~Solid() = default;
  Solid(const Solid&) = delete;
  Solid& operator=(const Solid&) = delete;

  /// The surface's point nearest to p, and the signed distance of p from it.
  [[nodiscard]] virtual SurfacePoint NearestSurface(const Vector3& p_m) const = 0;
  [[nodiscard]] virtual MaterialIndex MaterialAt(const Vector3& p_m) const = 0;
  /// A box that holds the solid, in G.
  [[nodiscard]] virtual Eigen::AlignedBox3d Bounds() const = 0;

  /// Nearest boundary point of the part that consists of this material, with the signed distance (negative in
  /// that part). Nothing if the solid cannot compute this exactly.
  [[nodiscard]] virtual std::optional<SurfacePoint> RegionDistance(MaterialIndex /*material*/,
                                                                   const Vector3& /*p_m*/) const {
    return std::nullopt;
  }

  [[nodiscard]] virtual double SignedDistance(const Vector3& p_m) const {
    return NearestSurface(p_m).distance_m;
  }
};

}  // namespace osteon::simulation
