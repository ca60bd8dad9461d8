#include "simulation/packing/clearance_climb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace osteon::simulation {

void ClearanceClimb::CacheNeighbours(const Vector3& p_m, double reach_m) {
  cached_.clear();
  planes_.clear();
  balls_.Gather(p_m, reach_m, cached_);
  gaps_m_.resize(cached_.size());
  cached_from_m_ = p_m;
  cached_reach_m_ = reach_m;
}

/// Returns the clearance at p. Stores in bounds_ all obstacles that are at most `window_m` farther away than
/// the nearest one.
double ClearanceClimb::Measure(const Vector3& p_m, double window_m) {
  std::optional<SurfacePoint> surface;
  const double depth = depths_.LowerBound(p_m);
  while (true) {
    double clearance = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < cached_.size(); ++k) {
      const Ball& ball = cached_[k];
      const double x = p_m.x() - ball.center_m.x, y = p_m.y() - ball.center_m.y,
                   z = p_m.z() - ball.center_m.z;
      gaps_m_[k] = std::sqrt(x * x + y * y + z * z) - ball.radius_m;
      clearance = std::min(clearance, gaps_m_[k]);
    }
    // Query the exact surface only if it may be nearer: the query takes longer than the rest of this
    // function.
    if (!surface && depth < clearance + window_m) surface = solid_.NearestSurface(p_m);
    if (surface) clearance = std::min(clearance, -surface->distance_m);
    // Balls that are not cached are farther away than known_reach_m. If an obstacle of interest might be
    // among them, refill the cache with a sufficient reach.
    const double known_reach_m = cached_reach_m_ - (p_m - cached_from_m_).norm();
    if (known_reach_m < clearance + window_m) {
      const std::vector<Plane> planes = std::move(planes_);
      CacheNeighbours(p_m, 1.5 * (std::max(0.0, clearance) + window_m) + 1e-12);
      planes_ = planes;
      continue;
    }
    if (surface && std::abs(surface->distance_m) > 1e-12) {
      const Vector3 normal = (p_m - surface->p_m) / -surface->distance_m;
      // replace a plane of nearly the same normal: it stands for the same piece of surface
      std::erase_if(planes_, [&normal](const Plane& plane) { return plane.normal.dot(normal) > 0.95; });
      planes_.push_back({normal, surface->p_m});
    }
    if (window_m > 0.0) {
      bounds_.clear();
      for (std::size_t k = 0; k < cached_.size(); ++k) {
        const double distance = gaps_m_[k] + cached_[k].radius_m;
        if (gaps_m_[k] < clearance + window_m && distance > 0.0)
          bounds_.push_back({gaps_m_[k], (p_m - Vector3(cached_[k].center_m)) / distance});
      }
      if (surface) AddPlanes(p_m, clearance, clearance + window_m);
    }
    return clearance;
  }
}

/// Adds the tangent planes that are nearer than `within_m` to the bounds. If the surface bulges inwards, a
/// plane that was found elsewhere may be nearer than the measured clearance; the clearance is used then.
void ClearanceClimb::AddPlanes(const Vector3& p_m, double clearance_m, double within_m) {
  for (const Plane& plane : planes_) {
    const double value = std::max(clearance_m, plane.normal.dot(p_m - plane.at_m));
    if (value < within_m) bounds_.push_back({value, plane.normal});
  }
}

Ball ClearanceClimb::Climb(const Vector3& p_m, double scale_m, double min_m) {
  Vector3 p = p_m;
  double max_step_m = 0.7 * scale_m;
  double clearance = Measure(p, 2.0 * max_step_m);
  constexpr int kMaxSteps = 40;  // usually five to ten steps suffice, although obstacles are curved; a
                                 // maximum touches four obstacles
  for (int i = 0; i < kMaxSteps && !bounds_.empty(); ++i) {
    if (clearance >= cap_.At(p)) return Settle(p, clearance);
    const auto [step, predicted_clearance] = WalkRidges(bounds_, max_step_m);
    const double gain = predicted_clearance - clearance;
    if (!(gain > 1e-7 * std::abs(clearance))) break;  // the clearance cannot grow any more
    last_bounds_ = bounds_;
    // true if the walk ended at a maximum, false if at its length limit
    const bool ends_inside = step.norm() < 0.99 * max_step_m;
    if (ends_inside) max_step_m = std::min(max_step_m, std::max(step.norm(), 0.01 * scale_m));
    const double next_clearance = Measure(p + step, 2.0 * max_step_m);
    // take the step if the clearance grows by at least a tenth of the predicted gain; otherwise try a shorter
    // step
    if (next_clearance > clearance + 0.1 * gain) {
      p += step;
      clearance = next_clearance;
      if (!ends_inside) max_step_m *= 2.0;
      // Give up: the maximum is near, and its clearance is far below `min_m`.
      if (ends_inside && next_clearance < 0.6 * min_m && gain < 0.1 * min_m) break;
    } else {
      std::swap(bounds_, last_bounds_);
      AddPlanes(p, clearance,
                std::numeric_limits<double>::infinity());  // the last Measure may have found a new plane
      max_step_m = 0.3 * step.norm();
      if (max_step_m < 1e-6 * std::abs(clearance)) break;
    }
  }
  return {.center_m = p, .radius_m = clearance};
}

/// Moves a ball of the cap's radius until it touches the three nearest obstacles. Each step of Newton's
/// method is the shortest solution of the linearised equations. If the method does not converge, the ball
/// stays at p.
Ball ClearanceClimb::Settle(const Vector3& p_m, double clearance_m) {
  const Ball unsettled{.center_m = p_m, .radius_m = std::min(clearance_m, cap_.At(p_m))};
  Vector3 p = p_m;
  constexpr int kMaxSteps = 12;
  for (int i = 0; i < kMaxSteps; ++i) {
    const double radius = cap_.At(p);
    const double clearance = Measure(p, 3.0 * radius);
    const std::size_t count = std::min<std::size_t>(3, bounds_.size());
    if (count == 0) break;
    std::partial_sort(bounds_.begin(), bounds_.begin() + count, bounds_.end(),
                      [](const ClearanceBound& a, const ClearanceBound& b) { return a.value_m < b.value_m; });
    double max_error_m = 0.0;
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> gradients(count, 3);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> errors_m(count);
    for (std::size_t k = 0; k < count; ++k) {
      gradients.row(k) = bounds_[k].gradient.transpose();
      errors_m[k] = radius - bounds_[k].value_m;
      max_error_m = std::max(max_error_m, std::abs(errors_m[k]));
    }
    if (max_error_m < 1e-9 * radius) return {.center_m = p, .radius_m = std::min(clearance, radius)};
    Vector3 step = gradients.completeOrthogonalDecomposition().solve(errors_m);
    const double length = step.norm();
    if (!(length < 1e3 * radius)) break;
    if (length > 0.5 * radius) step *= 0.5 * radius / length;
    p += step;
  }
  return unsettled;
}

}  // namespace osteon::simulation
