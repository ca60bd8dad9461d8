#include "simulation/packing/tangent_balls.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/scramble.h"
#include "simulation/packing/graded_descent.h"

namespace osteon::simulation {
namespace {

constexpr std::uint64_t kSampleSalt = 2;  // salt of the random numbers that place the samples

/// A sample of the surface: a point and the normal there.
struct Foot {
  Vector3 p_m;
  Vector3 inward;  ///< unit
};

/// The surface point nearest to a random point in the cell, if it lies in this cell. So each part of the
/// surface gets samples only from the cell in which it lies.
std::optional<Foot> SampleIn(const Cell& cell, const Solid& solid, std::uint64_t salt) {
  CellRandom random(cell, salt);
  const Vector3 p = cell.min_corner() + cell.side_m * random.NextInUnitCube();
  const SurfacePoint foot = solid.NearestSurface(p);
  if (std::abs(foot.distance_m) < 1e-9) return {};  // too close to determine the normal
  for (int axis = 0; axis < 3; ++axis)
    if (static_cast<std::int32_t>(std::floor(foot.p_m[axis] / cell.side_m)) != cell.index[axis]) return {};
  return Foot{.p_m = foot.p_m, .inward = (p - foot.p_m) / -foot.distance_m};
}

/// Finds the largest ball that touches the surface at a foot.
class Search {
 public:
  Search(const Solid& solid, const CutZone& zone, const PackingParams& params)
      : solid_(solid),
        zone_(zone),
        params_(params),
        // no ball in the solid can be larger
        max_m_(0.5 * solid.Bounds().sizes().minCoeff()) {}

  /// Largest radius of a ball that touches at the foot and is not larger than the cap at its centre. A cap
  /// grows no faster than the depth, and so no faster than the radius: every smaller ball is within its cap,
  /// too.
  [[nodiscard]] double Cap(const Foot& foot, double depth_m) const {
    const double spacing = params_.SpacingAt(depth_m);
    const auto allowed = [&](double radius) {
      return radius <= params_.RadiusCapAt(zone_.DepthAt(foot.p_m + radius * foot.inward), spacing);
    };
    if (allowed(max_m_)) return max_m_;
    double low = std::min(max_m_, params_.cup_radius_cap_m), high = max_m_;
    while (high - low > 1e-3 * low) {
      const double middle = 0.5 * (low + high);
      (allowed(middle) ? low : high) = middle;
    }
    return low;
  }

  /// The largest ball in the solid that touches at the foot, with a radius up to `cap_m`; nothing if it is
  /// smaller than min_radius_m. The ball may miss the foot by about `slack_m2` / radius.
  /// @param guess_m  radius with which the search starts
  ///
  /// Shrinking ball (Ma, Bae, Choi, The Visual Computer 28, 2012): if a ball reaches beyond the surface, it
  /// is replaced by the smaller one that is tangent at the foot and passes through the surface point nearest
  /// to the centre. No larger tangent ball is empty (within the solid). From a guess below the cap (a
  /// neighbour's radius), the ball first grows until it is not empty.
  [[nodiscard]] std::optional<Ball> Largest(const Foot& foot, double cap_m, double guess_m,
                                            double slack_m2) const {
    constexpr int kMaxRounds = 40;
    double radius = std::min(cap_m, guess_m);
    std::optional<Ball> empty;  // the largest ball known to be empty
    bool growing = true;
    for (int round = 0; round < kMaxRounds && radius >= params_.min_radius_m; ++round) {
      const Vector3 center = foot.p_m + radius * foot.inward;
      const SurfacePoint nearest = solid_.NearestSurface(center);
      const Vector3 chord = nearest.p_m - foot.p_m;
      // depth of the nearest point below the foot, along the ball's axis
      const double sagitta = chord.dot(foot.inward);
      const double slack = std::min(0.1 * radius, std::max(1e-6 * radius, slack_m2 / radius));
      double next = 0.0;
      if (-nearest.distance_m >= radius - slack || sagitta <= 0.0) {
        const double inside = std::min(radius, -nearest.distance_m);
        if (inside < params_.min_radius_m) return {};
        empty = Ball{.center_m = center, .radius_m = inside};
        if (!growing || radius >= cap_m) return empty;
        next = std::min(cap_m, 2.0 * radius);
      } else {
        growing = false;
        next = std::min(0.999999 * radius, chord.squaredNorm() / (2.0 * sagitta));
        if (empty && next <= 1.001 * empty->radius_m) return empty;
      }
      radius = next;
    }
    return empty;
  }

 private:
  const Solid& solid_;
  const CutZone& zone_;
  const PackingParams& params_;
  double max_m_;
};

}  // namespace

std::vector<TangentBall> FindTangentBalls(const Solid& solid, const CutZone& zone,
                                          const PackingParams& params, const GradeParams& samples) {
  const Search search(solid, zone, params);
  const std::uint64_t salt = kSampleSalt + params.seed * kSplitMixStep;
  const auto add = [&](const Cell& cell, std::vector<TangentBall>& balls) {
    const std::optional<Foot> foot = SampleIn(cell, solid, salt);
    if (!foot) return;
    const double depth = zone.DepthAt(foot->p_m), cap = search.Cap(*foot, depth);
    const double guess = balls.empty() ? cap : 1.1 * balls.back().ball.radius_m;
    const auto ball = search.Largest(*foot, cap, guess, 0.05 * cell.side_m * cell.side_m);
    if (!ball) return;
    balls.push_back(
        {.foot_m = foot->p_m, .ball = *ball, .tolerance_m = static_cast<float>(params.SurfaceGapAt(depth))});
  };
  return DescendGraded<TangentBall>(solid, zone, samples, CellChoice::kSurface, params.threads, kMaxBalls,
                                    add);
}

}  // namespace osteon::simulation
