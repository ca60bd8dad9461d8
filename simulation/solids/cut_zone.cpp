#include "simulation/solids/cut_zone.h"

#include <algorithm>
#include <limits>

#include "base/check_range.h"
#include "simulation/contact/cutting_math.h"

namespace osteon::simulation {

PathZone::PathZone(std::vector<Vector3> centers_m, double radius_m)
    : centers_m_(std::move(centers_m)), radius_m_(radius_m) {
  CheckRangeMm("path zone: radius", radius_m, 0.01e-3, 0.100);
  if (centers_m_.empty()) throw std::invalid_argument("path zone: found no point, accepted one and more");
  for (std::size_t i = 0; i < centers_m_.size(); ++i)
    if (!centers_m_[i].allFinite())
      throw std::invalid_argument(fmt::format("path zone: point {}: not finite", i));
}

double PathZone::DepthAt(const Vector3& p_m) const {
  double nearest = (p_m - centers_m_.front()).squaredNorm();
  for (std::size_t i = 0; i + 1 < centers_m_.size(); ++i)
    nearest =
        std::min(nearest, (p_m - ClosestOnSegment(p_m, centers_m_[i], centers_m_[i + 1])).squaredNorm());
  return std::sqrt(nearest) - radius_m_;
}

double SurfaceZone::DepthAt(const Vector3& p_m) const {
  const double depth = std::abs(solid_.SignedDistance(p_m));
  if (!region_) return depth;
  return std::max(depth, (p_m - Vector3(region_->center_m)).norm() - region_->radius_m);
}

}  // namespace osteon::simulation
