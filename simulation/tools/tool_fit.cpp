#include "simulation/tools/tool_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace osteon::simulation {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Finds the largest ball that touches the surface at the sample from inside, by shrinking a ball of radius
// largest_m until it stays within the solid (Ma, Bae, Choi, The Visual Computer 28, 2012). Nothing if the
// ball would be smaller than min_m.
std::optional<ToolBall> TangentBall(const Solid& solid, const SurfaceSample& sample, double largest_m,
                                    double min_m) {
  const Vector3 inward = -sample.normal;
  double radius = largest_m;
  constexpr int kMaxRounds = 60;
  for (int round = 0; round < kMaxRounds && radius >= min_m; ++round) {
    const Vector3 center = sample.p_m + radius * inward;
    const SurfacePoint nearest = solid.NearestSurface(center);
    const double clearance = -nearest.distance_m;
    if (clearance >= radius * (1.0 - 1e-4)) {  // a tenth of a micrometre at 1 mm
      const double inside = std::min(radius, clearance);
      if (inside < min_m) return std::nullopt;
      return ToolBall{.center_m = center, .radius_m = inside, .cutting = sample.cutting};
    }
    const Vector3 chord = nearest.p_m - sample.p_m;
    const double sagitta = chord.dot(inward);
    // The ball through the nearest point and the sample has the radius chord² / (2 sagitta). Without a
    // sagitta there is none: the sample lies on an edge, or beyond it.
    if (sagitta <= 1e-12) {
      if (clearance < min_m) return std::nullopt;
      radius = std::min(0.5 * radius, clearance);
      continue;
    }
    radius = std::min(0.9999999 * radius, chord.squaredNorm() / (2.0 * sagitta));
  }
  return std::nullopt;
}

// Finds the largest ball below an edge that leaves half the accepted gap to the edge, by bisection over the
// depth of its centre: a deeper centre leaves a larger gap. Nothing if the ball would be smaller than min_m.
std::optional<ToolBall> BallBelowEdge(const Solid& solid, const SurfaceSample& sample, double largest_m,
                                      double min_m) {
  const auto clearance = [&](double depth_m) {
    return -solid.SignedDistance(sample.p_m - depth_m * sample.normal);
  };
  double low = 0.0, high = largest_m;
  for (int round = 0; round < 40 && high - low > 1e-4 * high; ++round) {
    const double middle = 0.5 * (low + high);
    (middle - clearance(middle) <= 0.5 * sample.gap_m ? low : high) = middle;
  }
  const double radius = clearance(low);
  if (radius < min_m) return std::nullopt;
  return ToolBall{
      .center_m = sample.p_m - low * sample.normal, .radius_m = radius, .cutting = sample.cutting};
}

// Gap between a surface point and a ball; 0 inside the ball.
double Gap(const Vector3& p_m, const ToolBall& ball) {
  return std::max(0.0, (p_m - Vector3(ball.center_m)).norm() - ball.radius_m);
}

}  // namespace

ToolFit FitTool(const Solid& solid, std::span<const SurfaceSample> samples,
                const std::vector<ToolBall>& first, const ToolFitParams& params) {
  // Sort by height: the samples that a ball can serve then stand next to each other in the list.
  std::vector<SurfaceSample> sorted(samples.begin(), samples.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const SurfaceSample& a, const SurfaceSample& b) { return a.p_m.z() > b.p_m.z(); });
  double max_gap_m = 0.0;
  for (const SurfaceSample& sample : sorted) max_gap_m = std::max(max_gap_m, sample.gap_m);

  const double largest_m = 0.5 * solid.Bounds().sizes().maxCoeff();
  std::vector<ToolBall> candidates;
  // Every sample gives a candidate ball. In large lists, only every second to fourth sample does, and each
  // sample on an edge.
  const std::size_t stride = std::clamp<std::size_t>(sorted.size() / 3000, 1, 4);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (!sorted[i].edge && i % stride != 0) continue;
    const auto ball = sorted[i].edge ? BallBelowEdge(solid, sorted[i], largest_m, params.min_radius_m)
                                     : TangentBall(solid, sorted[i], largest_m, params.min_radius_m);
    if (ball) candidates.push_back(*ball);
  }

  std::vector<double> gap(sorted.size(), kInfinity);  // gap at each sample, with the balls added so far
  // calls visit(i) for the samples of the ball's kind near enough to be served, in order
  const auto for_near = [&](const ToolBall& ball, const auto& visit) {
    const double reach = ball.radius_m + max_gap_m;
    const auto begin = std::partition_point(sorted.begin(), sorted.end(), [&](const SurfaceSample& sample) {
      return sample.p_m.z() > ball.center_m.z + reach;
    });
    for (auto i = static_cast<std::size_t>(begin - sorted.begin()); i < sorted.size(); ++i) {
      if (sorted[i].p_m.z() < ball.center_m.z - reach) break;
      if (sorted[i].cutting == ball.cutting) visit(i);
    }
  };
  ToolFit fit;
  const auto add = [&](const ToolBall& ball) {
    fit.balls.push_back(ball);
    for (std::size_t i = 0; i < sorted.size(); ++i)
      if (sorted[i].cutting == ball.cutting) gap[i] = std::min(gap[i], Gap(sorted[i].p_m, ball));
  };
  for (const ToolBall& ball : first) add(ball);

  std::vector<const ToolBall*> serving;
  for (std::size_t i = 0; i < sorted.size() && fit.balls.size() < params.max_count; ++i) {
    if (gap[i] <= sorted[i].gap_m) continue;
    serving.clear();
    const ToolBall* best = nullptr;
    // if no candidate serves the sample, the one with the smallest gap is used
    double best_gap = 0.9 * gap[i];
    for (const ToolBall& ball : candidates) {
      if (ball.cutting != sorted[i].cutting) continue;
      const double remaining_gap_m = Gap(sorted[i].p_m, ball);
      if (remaining_gap_m <= sorted[i].gap_m) serving.push_back(&ball);
      if (remaining_gap_m < best_gap) best = &ball, best_gap = remaining_gap_m;
    }
    // If many candidates serve the sample, only some of them are evaluated: neighbours serve almost the same
    // samples.
    constexpr std::size_t kLookedAt = 256;  // approximate number of candidates that are evaluated
    std::size_t max_served = 0;
    const std::size_t step = serving.size() / kLookedAt + 1;
    for (std::size_t k = 0; k < serving.size(); k += step) {
      const ToolBall& ball = *serving[k];
      std::size_t served = 0;
      for_near(ball, [&](std::size_t j) {
        if (gap[j] > sorted[j].gap_m && Gap(sorted[j].p_m, ball) <= sorted[j].gap_m) ++served;
      });
      if (served > max_served || (served == max_served && ball.radius_m > best->radius_m))
        best = &ball, max_served = served;
    }
    if (best) add(*best);
  }

  for (std::size_t i = 0; i < sorted.size(); ++i)
    fit.worst_ratio = std::max(fit.worst_ratio, gap[i] / sorted[i].gap_m);
  std::stable_sort(fit.balls.begin(), fit.balls.end(), [](const ToolBall& a, const ToolBall& b) {
    if (a.cutting != b.cutting) return a.cutting;
    return a.center_m.z > b.center_m.z;
  });
  return fit;
}

}  // namespace osteon::simulation
