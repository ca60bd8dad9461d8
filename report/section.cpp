#include "report/section.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace osteon::report {
namespace {

using simulation::Ball;
using simulation::Bone;

/// Samples the signed distance to the union of the circles in which the plane cuts the balls. Values farther
/// outside than two grid steps are cut off; the distance is accurate near zero.
PlanarGrid SliceField(const std::vector<Ball>& balls, const SectionPlane& plane, const Vector2& min,
                      const Vector2& max, double step_m) {
  const double far_m = 2.0 * step_m;  // value of nodes that are not near any circle
  PlanarGrid grid(min, max, step_m, static_cast<float>(far_m));
  const Vector3 normal = plane.u.cross(plane.v);
  for (const Ball& ball : balls) {
    const Vector3 center = ball.center_m;
    const double from_plane_m = (center - plane.origin).dot(normal);
    if (!(std::abs(from_plane_m) < ball.radius_m)) continue;
    const double radius_m = std::sqrt(ball.radius_m * ball.radius_m - from_plane_m * from_plane_m);
    const Vector2 c = plane.Project(center);
    const Vector2 low = (c - min) / step_m - Vector2::Constant(radius_m / step_m + 2.0);
    const Vector2 high = (c - min) / step_m + Vector2::Constant(radius_m / step_m + 2.0);
    if (!(high.x() >= 0.0 && high.y() >= 0.0 && low.x() <= grid.nx && low.y() <= grid.ny)) continue;
    const int i0 = static_cast<int>(std::max(low.x(), 0.0)), j0 = static_cast<int>(std::max(low.y(), 0.0));
    const int i1 = static_cast<int>(std::min(high.x(), grid.nx - 1.0));
    const int j1 = static_cast<int>(std::min(high.y(), grid.ny - 1.0));
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) {
        const auto distance = static_cast<float>((grid.Node(i, j) - c).norm() - radius_m);
        grid.At(i, j) = std::min(grid.At(i, j), distance);
      }
  }
  return grid;
}

/// Samples the signed distance to the swept tool. The distance changes by at most the length of a
/// displacement. So a block of nodes needs only one evaluation if its centre is farther from the surface than
/// from its corners.
PlanarGrid SweptField(const SweptTool& swept, const SectionPlane& plane, const Vector2& min,
                      const Vector2& max, double step_m) {
  constexpr int kBlock = 8;
  PlanarGrid grid(min, max, step_m, static_cast<float>(step_m));
  for (int j0 = 0; j0 < grid.ny; j0 += kBlock) {
    for (int i0 = 0; i0 < grid.nx; i0 += kBlock) {
      const double half = 0.5 * (kBlock - 1) * step_m;
      const Vector2 middle = grid.Node(i0, j0) + Vector2::Constant(half);
      const double middle_m = swept.SignedDistance(plane.Point(middle));
      const bool is_far = std::abs(middle_m) > std::numbers::sqrt2 * half + 2.0 * step_m;
      for (int j = j0; j < std::min(j0 + kBlock, grid.ny); ++j)
        for (int i = i0; i < std::min(i0 + kBlock, grid.nx); ++i)
          grid.At(i, j) =
              static_cast<float>(is_far ? middle_m : swept.SignedDistance(plane.Point(grid.Node(i, j))));
    }
  }
  return grid;
}

/// Finds the region of each material in the plane from the solid or the nearest mass points, by majority in a
/// neighbourhood of 5×5 nodes, so that the outline does not follow single points.
std::vector<MaterialRegion> MaterialRegions(const Bone& bone, const SectionPlane& plane, const Vector2& min,
                                            const Vector2& max, double step_m,
                                            const simulation::Solid* solid) {
  std::vector<MaterialRegion> regions;
  if (bone.points.empty() && solid == nullptr) return regions;
  const MaterialMap map(bone.points, solid);
  const PlanarGrid shape(min, max, step_m, 0.0f);
  std::vector<int> label(shape.values.size(), -1);
  int max_material = -1;
  for (int j = 0; j < shape.ny; ++j)
    for (int i = 0; i < shape.nx; ++i) {
      const auto material = map.At(plane.Point(shape.Node(i, j)));
      if (!material) continue;
      label[static_cast<std::size_t>(j) * shape.nx + i] = *material;
      max_material = std::max(max_material, static_cast<int>(*material));
    }
  // fraction of each material around each node
  constexpr int kReach = 2;
  const std::size_t nodes = shape.values.size();
  std::vector<std::vector<float>> share(static_cast<std::size_t>(max_material + 1),
                                        std::vector<float>(nodes, 0.0f));
  for (int j = 0; j < shape.ny; ++j)
    for (int i = 0; i < shape.nx; ++i)
      for (int dj = -kReach; dj <= kReach; ++dj)
        for (int di = -kReach; di <= kReach; ++di) {
          const int x = std::clamp(i + di, 0, shape.nx - 1), y = std::clamp(j + dj, 0, shape.ny - 1);
          const int material = label[static_cast<std::size_t>(y) * shape.nx + x];
          const int weight = (kReach + 1 - std::abs(di)) * (kReach + 1 - std::abs(dj));
          if (material >= 0)
            share[material][static_cast<std::size_t>(j) * shape.nx + i] += static_cast<float>(weight);
        }
  // a node belongs to the material with the largest fraction around it; regions overlap a little, so that no
  // seam shows between them
  constexpr float kOverlap = 1.0f;  // in units of the weights above
  for (int material = 0; material <= max_material; ++material) {
    PlanarGrid field(min, max, step_m, 1.0f);
    for (std::size_t node = 0; node < nodes; ++node) {
      float largest_other = 0.0f;
      for (int k = 0; k <= max_material; ++k)
        if (k != material) largest_other = std::max(largest_other, share[k][node]);
      field.values[node] =
          share[material][node] > 0.0f ? largest_other - share[material][node] - kOverlap : 1.0f;
    }
    field.CloseBorder(1.0f);
    MaterialRegion region{.material = static_cast<simulation::MaterialIndex>(material)};
    for (const Polyline& line : Contour(field)) region.outline.push_back(Simplify(line, 0.1 * step_m));
    if (!region.outline.empty()) regions.push_back(std::move(region));
  }
  return regions;
}

/// Returns the deepest position of the head's centre in the cup, in G.
Vector3 DeepestHead(const Bone& bone, const simulation::ToolBall& head, std::span<const Pose> X_GP) {
  const Vector3 axis = bone.site.axis, center = bone.site.center_m;
  Vector3 deepest = X_GP.front() * Vector3(head.center_m);
  for (const Pose& X : X_GP) {
    const Vector3 at = X * Vector3(head.center_m);
    if ((at - center).dot(axis) < (deepest - center).dot(axis)) deepest = at;
  }
  return deepest;
}

/// Samples the middles of those pieces of `lines` that the cut has exposed: a middle must have been inside
/// the bone before, and must be visible from the swept volume. (A cut ball may also form another face of the
/// bone, which then moves too; that face is not part of the cavity and is not visible from the swept volume.)
std::vector<ErrorSample> MeasureOutline(const std::vector<Polyline>& lines, const SectionPlane& plane,
                                        const BallField& before, const BallField& left,
                                        const SweptTool& swept, const Vector2& head, double cut_depth_m) {
  // The ray starts this far from the outline, because a chord of the outline lies some micrometres inside its
  // own ball.
  constexpr double kClear_m = 20e-6;
  std::vector<ErrorSample> samples;
  for (const Polyline& line : lines) {
    const std::size_t pieces = line.closed ? line.points.size() : line.points.size() - 1;
    for (std::size_t i = 0; i < pieces; ++i) {
      const Vector2 a = line.points[i], b = line.points[(i + 1) % line.points.size()];
      const Vector2 middle = 0.5 * (a + b);
      const Vector3 p_G = plane.Point(middle);
      if (!(before.Depth(p_G) > cut_depth_m)) continue;
      const simulation::SweptDistance from = swept.Nearest(p_G);
      if (from.distance_m > kClear_m) {
        const Vector3 d = (from.axis_G - p_G).normalized();
        if (left.FirstHit(p_G + kClear_m * d, d, from.distance_m - kClear_m)) continue;
      }
      samples.push_back({.angle_rad = std::atan2(middle.x() - head.x(), head.y() - middle.y()),
                         .error_m = from.distance_m,
                         .weight = (b - a).norm(),
                         .place_m = middle});
    }
  }
  std::stable_sort(samples.begin(), samples.end(),
                   [](const auto& a, const auto& b) { return a.angle_rad < b.angle_rad; });
  return samples;
}

/// Simplifies each of the lines.
std::vector<Polyline> SimplifyAll(const std::vector<Polyline>& lines, double tolerance_m) {
  std::vector<Polyline> out;
  for (const Polyline& line : lines) out.push_back(Simplify(line, tolerance_m));
  return out;
}

}  // namespace

CavityError SummarizeErrors(std::span<const ErrorSample> samples) {
  CavityError error{.samples = static_cast<int>(samples.size())};
  if (samples.empty()) return error;
  std::vector<std::pair<double, double>> sizes;  // |error|, weight
  double total = 0.0;
  for (const ErrorSample& sample : samples) {
    total += sample.weight;
    error.mean_m += sample.weight * sample.error_m;
    error.mean_abs_m += sample.weight * std::abs(sample.error_m);
    error.max_over_m = std::max(error.max_over_m, sample.error_m);
    error.max_under_m = std::min(error.max_under_m, sample.error_m);
    sizes.emplace_back(std::abs(sample.error_m), sample.weight);
  }
  error.mean_m /= total;
  error.mean_abs_m /= total;
  std::sort(sizes.begin(), sizes.end());
  double below = 0.0;
  for (const auto& [size, weight] : sizes) {
    error.p95_m = size;
    below += weight;
    if (below >= 0.95 * total) break;
  }
  return error;
}

namespace {

// The space swept by the earlier tools and by this one.
SweptTool SweptByAll(const simulation::Tool& tool, std::span<const Pose> X_GP,
                     std::span<const simulation::ToolPath> earlier) {
  std::vector<simulation::ToolPath> all(earlier.begin(), earlier.end());
  all.push_back({.tool = &tool, .X_GP = X_GP});
  return SweptTool(all);
}

}  // namespace

SectionPlane ChooseSectionPlane(const Bone& bone, const simulation::Tool& tool, std::span<const Pose> X_GP) {
  SectionPlane plane{.origin = bone.site.center_m, .v = Vector3(bone.site.axis).normalized()};
  if (!plane.v.allFinite() || plane.v.norm() < 0.5) plane.v = Vector3::UnitZ();
  Vector3 farthest = Vector3::Zero();
  if (const simulation::ToolBall* head = CuttingHead(tool)) {
    for (const Pose& X : X_GP) {
      const Vector3 from = X * Vector3(head->center_m) - plane.origin;
      const Vector3 off = from - from.dot(plane.v) * plane.v;
      // only positions in the cup: the approach is not part of the cut
      if (from.dot(plane.v) < head->radius_m && off.norm() > farthest.norm()) farthest = off;
    }
  }
  constexpr double kNoticeable_m = 0.2e-3;  // if the path stays nearer to the axis, any plane is chosen
  if (farthest.norm() < kNoticeable_m) {
    const Vector3 other = std::abs(plane.v.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
    farthest = other - other.dot(plane.v) * plane.v;
  }
  plane.u = farthest.normalized();
  return plane;
}

Section ComputeSection(const Bone& bone, const simulation::CarvedState& after, const simulation::Tool& tool,
                       std::span<const Pose> X_GP, const SectionParams& params) {
  Section section;
  section.plane = ChooseSectionPlane(bone, tool, X_GP);
  const SectionPlane& plane = section.plane;
  const BallField before(bone.balls), left(CarvedBalls(bone, after));

  // the window contains the bone's slice, limited to SiteReach around the cup
  const double reach_m = SiteReach(bone, params.reach_in_cup_radii);
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Ball& ball : before.balls()) {
    if (std::abs((Vector3(ball.center_m) - plane.origin).dot(plane.u.cross(plane.v))) > ball.radius_m)
      continue;
    const Vector2 c = plane.Project(ball.center_m);
    low = low.cwiseMin(c - Vector2::Constant(ball.radius_m));
    high = high.cwiseMax(c + Vector2::Constant(ball.radius_m));
  }
  if (!(low.x() <= high.x())) low = high = Vector2::Zero();
  double down_m = params.depth_in_cup_radii / params.reach_in_cup_radii * reach_m;
  const simulation::ToolBall* head = CuttingHead(tool);
  const SweptTool swept = SweptByAll(tool, X_GP, params.earlier);
  const bool is_cut = head != nullptr && !swept.empty();
  if (is_cut) {  // extend the window so that the floor of a deep hole is in it
    section.head_center = plane.Project(DeepestHead(bone, *head, X_GP));
    section.head_radius_m = head->radius_m;
    down_m = std::max(down_m, head->radius_m - section.head_center.y());
  }
  section.min = low.cwiseMax(Vector2(-reach_m, -down_m)) - Vector2::Constant(params.margin_m);
  section.max = high.cwiseMin(Vector2::Constant(reach_m)) + Vector2::Constant(params.margin_m);
  section.min = section.min.cwiseMin(Vector2::Constant(-params.margin_m));
  section.max = section.max.cwiseMax(Vector2::Constant(params.margin_m));

  // outlines are left open at the window's border, because the bone continues beyond it
  const double tolerance_m = 0.04 * params.step_m;
  PlanarGrid field = SliceField(before.balls(), plane, section.min, section.max, params.step_m);
  section.before = SimplifyAll(Contour(field), tolerance_m);
  field = SliceField(left.balls(), plane, section.min, section.max, params.step_m);
  const std::vector<Polyline> outline = Contour(field);
  section.after = SimplifyAll(outline, tolerance_m);
  field.CloseBorder(static_cast<float>(params.step_m));
  section.solid = SimplifyAll(Contour(field), tolerance_m);
  section.materials =
      MaterialRegions(bone, plane, section.min, section.max, 2.5 * params.step_m, params.solid);

  if (!is_cut) return section;
  section.swept =
      SimplifyAll(Contour(SweptField(swept, plane, section.min, section.max, params.step_m)), tolerance_m);
  section.samples =
      MeasureOutline(outline, plane, before, left, swept, section.head_center, params.cut_depth_m);
  section.error = SummarizeErrors(section.samples);
  return section;
}

CavityError CavityErrorByDirection(const Bone& bone, const simulation::CarvedState& after,
                                   const simulation::Tool& tool, std::span<const Pose> X_GP,
                                   const SectionParams& params) {
  const simulation::ToolBall* head = CuttingHead(tool);
  const SweptTool swept = SweptByAll(tool, X_GP, params.earlier);
  if (head == nullptr || swept.empty()) return {};
  const BallField before(bone.balls), left(CarvedBalls(bone, after));
  const SectionPlane plane = ChooseSectionPlane(bone, tool, X_GP);
  const Vector3 w = plane.u.cross(plane.v), origin = DeepestHead(bone, *head, X_GP);
  constexpr double kEnd_m = 1e-7;  // accuracy with which the end of the swept volume is found

  std::vector<ErrorSample> samples;
  int open = 0;
  for (int i = 0; i < params.directions; ++i) {
    // Fibonacci lattice: equal areas on the hemisphere around -v
    const double down = (i + 0.5) / params.directions, turn = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double across = std::sqrt(1.0 - down * down);
    const Vector3 d = across * (std::cos(turn) * plane.u + std::sin(turn) * w) - down * plane.v;
    // find the end of the swept volume along d: a step as long as the distance to the surface cannot leave
    // the volume
    double end_m = 0.0;
    for (int step = 0; step < 10'000; ++step) {
      const double inside_m = -swept.SignedDistance(origin + end_m * d);
      if (inside_m < kEnd_m) break;
      end_m += inside_m;
    }
    if (!(before.Depth(origin + end_m * d) > params.cut_depth_m)) continue;
    const auto hit_m = left.FirstHit(origin, d, end_m + params.open_gap_m);
    if (!hit_m) {
      ++open;
      continue;
    }
    samples.push_back({.angle_rad = std::acos(down), .error_m = *hit_m - end_m});
  }
  CavityError error = SummarizeErrors(samples);
  error.open = open;
  return error;
}

}  // namespace osteon::report
