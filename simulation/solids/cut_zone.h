#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/bone/bone.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// The part of a bone that is going to be cut. The depth below this zone determines how fine balls and mass
/// points are.
class CutZone {
 public:
  CutZone() = default;
  virtual ~CutZone() = default;
  CutZone(const CutZone&) = delete;
  CutZone& operator=(const CutZone&) = delete;

  /// Depth of p (in G) below the cuttable surface; negative in the bone that will be cut away. Between two
  /// places it changes by at most their distance (1-Lipschitz).
  [[nodiscard]] virtual double DepthAt(const Vector3& p_m) const = 0;
};

/// The whole bone: the depth is zero everywhere.
class EverywhereZone final : public CutZone {
 public:
  [[nodiscard]] double DepthAt(const Vector3&) const override { return 0.0; }
};

/// A cup. The depth is the distance to the volume that a reamer of the cup's radius sweeps on its way in: all
/// points within this radius of the ray from the cup's centre along its axis.
class CupZone final : public CutZone {
 public:
  explicit CupZone(const CutSite& cup) : cup_(cup) {}
  [[nodiscard]] double DepthAt(const Vector3& p_m) const override {
    const Vector3 d = p_m - Vector3(cup_.center_m);
    const double along = std::max(0.0, d.dot(Vector3(cup_.axis)));
    return (d - along * Vector3(cup_.axis)).norm() - cup_.radius_m;
  }

 private:
  CutSite cup_;
};

/// A planned tool path. The depth is the distance to the polyline of the tool's centre, less the tool's
/// radius.
class PathZone final : public CutZone {
 public:
  /// @throws std::invalid_argument if there is no point, a point is not finite, or the radius is not
  ///   positive.
  PathZone(std::vector<Vector3> centers_m, double radius_m);
  [[nodiscard]] double DepthAt(const Vector3& p_m) const override;

 private:
  std::vector<Vector3> centers_m_;
  double radius_m_;
};

/// A region of the bone's surface. The depth is the distance to the surface or to the region's ball,
/// whichever is larger. Without a region, it is the distance to the whole surface.
class SurfaceZone final : public CutZone {
 public:
  /// @param solid  must outlive the zone
  explicit SurfaceZone(const Solid& solid, const std::optional<Ball>& region = {})
      : solid_(solid), region_(region) {}
  [[nodiscard]] double DepthAt(const Vector3& p_m) const override;

 private:
  const Solid& solid_;
  std::optional<Ball> region_;
};

}  // namespace osteon::simulation
