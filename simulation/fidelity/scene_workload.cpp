#include "simulation/fidelity/scene_workload.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "simulation/solids/cup_frame.h"

namespace osteon::simulation {
namespace {

constexpr double kLead_m = 0.5e-3;  // height above first contact at which a tool begins
constexpr double kMinStep_m = 0.02e-3, kMaxStep_m = 0.2e-3;    // travel in a frame
constexpr double kTilt_rad = 20.0 * std::numbers::pi / 180.0;  // angle between the offset and the feed
// durations in which the offset grows, then stays constant, then turns once around the feed
constexpr double kPressing_s = 0.05, kSettling_s = 0.05, kCircle_s = 0.2;

/// Corners of the path of the head's centre, in the site's frame C. In a cup, the path leads down the axis:
/// it begins above the place at which the head touches the rim or the floor, and ends at the depth of the
/// cut.
std::vector<Vector3> WayOf(const SceneSolid& solid, const SceneParams& scene, const ToolBall& head) {
  using Kind = ZoneParams::Kind;
  if (scene.zone.kind == Kind::kPath) return scene.zone.path_C_m;
  if (scene.zone.kind != Kind::kCup)
    throw std::invalid_argument("scene's cut: zone: kind: found surface or everywhere, accepted cup, path");
  const double cup_m = solid.site.radius_m, head_m = head.radius_m;
  const double meeting_m =
      head_m > cup_m ? std::sqrt(head_m * head_m - cup_m * cup_m) : std::max(0.0, cup_m - head_m);
  const double floor_m = head_m - cup_m - scene.packing.cup_depth_m;
  return {Vector3(0, 0, std::max(meeting_m, floor_m) + kLead_m), Vector3(0, 0, floor_m)};
}

/// Points of the path, at most `step_m` apart.
std::vector<Vector3> Dense(const std::vector<Vector3>& way, double step_m) {
  std::vector<Vector3> places{way.front()};
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const Vector3 leg = way[i + 1] - way[i];
    const int steps = std::max(1, static_cast<int>(std::ceil(leg.norm() / step_m - 1e-9)));
    for (int k = 1; k <= steps; ++k) places.emplace_back(way[i] + (static_cast<double>(k) / steps) * leg);
  }
  return places;
}

}  // namespace

CutWorkload MakeSceneWorkload(const SceneSolid& solid, const SceneParams& scene, const Tool& tool,
                              const CuttingParams& cutting, const SceneWorkloadParams& params) {
  const ToolBall* head = CuttingHead(tool);
  if (head == nullptr)
    throw std::invalid_argument("scene's cut: found a tool that cuts nothing, accepted one that does");
  CutWorkload work;
  work.task = CutTask::kScene;
  work.solid = solid.solid;
  work.zone = MakeZone(scene.zone, solid.site, *solid.solid);
  work.materials = scene.materials;
  for (Material& material : work.materials) material.friction = 0.0;
  work.tool = tool;
  work.cutting = cutting;
  work.cutting.law = RemovalLaw::kImmediate;
  work.rate_hz = params.rate_hz;

  const std::vector<Vector3> way_C = WayOf(solid, scene, *head);
  double length_m = 0.0;
  for (std::size_t i = 0; i + 1 < way_C.size(); ++i) length_m += (way_C[i + 1] - way_C[i]).norm();
  const double step_m = std::clamp(length_m / static_cast<double>(params.cut_frames), kMinStep_m, kMaxStep_m);
  const Pose X_GC = CupPose(solid.site);
  const Matrix3 R_CT = Eigen::DiagonalMatrix<double, 3>(1, -1, -1).toDenseMatrix();  // the feed points down
  const auto add = [&](const Vector3& center_C, bool cuts) {
    Pose X_CT = Pose::Identity();
    X_CT.linear() = R_CT;
    X_CT.translation() = center_C - R_CT * Vector3(head->center_m);
    const auto stamp = std::llround(static_cast<double>(work.frames.size()) / params.rate_hz * 1e9);
    work.frames.push_back({.X_WT = Pose(X_GC * X_CT),
                           .spindle_rad_per_s = cuts ? 100.0 : 0.0,
                           .dt_s = 1.0 / params.rate_hz,
                           .stamp = static_cast<rt::Nanoseconds>(stamp)});
  };
  for (const Vector3& center : Dense(way_C, step_m)) add(center, true);
  work.cut_end = work.frames.size();

  const auto frames = [&](double seconds) {
    return static_cast<std::size_t>(std::lround(seconds * params.rate_hz));
  };
  const std::size_t rest = frames(kPressing_s + kSettling_s), circle = frames(kCircle_s);
  work.feel_begin = work.cut_end + rest;
  // With the spindle off, press the tool away from the path's end by the offset, let it settle, then turn the
  // offset once around the feed.
  for (std::size_t k = 0; k < rest + circle; ++k) {
    const double pressed = std::min(1.0, static_cast<double>(k + 1) / (params.rate_hz * kPressing_s));
    const double turn =
        k < rest ? 0.0
                 : 2.0 * std::numbers::pi * static_cast<double>(k - rest + 1) / static_cast<double>(circle);
    const Vector3 side(std::cos(turn), std::sin(turn), 0.0);
    const Vector3 offset =
        params.offset_m * (std::sin(kTilt_rad) * side - std::cos(kTilt_rad) * Vector3::UnitZ());
    add(way_C.back() + pressed * offset, false);
  }
  return work;
}

CutShape ShapeOfCut(const CutWorkload& work, const SceneParams& scene) {
  CutShape shape;
  const ToolBall* head = CuttingHead(work.tool);
  if (scene.zone.kind == ZoneParams::Kind::kCup) {
    shape.tool_radius_m = head->radius_m;
    shape.along_surface = true;
    shape.depth_m = scene.packing.cup_depth_m;
    const double R = head->radius_m;  // a hemisphere
    shape.area_m2 = 2.0 * std::numbers::pi * R * R;
    shape.rim_per_area_1_per_m = 1.0 / R;
    return shape;
  }
  shape.tool_radius_m = CuttingReach(work.tool);
  // Follow the head's centre along the path. Measure the length within the solid, the number of passes
  // through the surface (each makes a rim), and the shortest piece between two such passes.
  double run_m = 0.0, inside_m = 0.0, thinnest_m = 0.0;
  int rims = 0;
  bool was_inside = false;
  Vector3 last = Vector3::Zero();
  for (std::size_t k = 0; k < work.cut_end; ++k) {
    const Vector3 center = Pose(work.frames[k].X_WT) * Vector3(head->center_m);
    const bool inside = work.solid->SignedDistance(center) < 0.0;
    if (inside && was_inside) {
      run_m += (center - last).norm();
      inside_m += (center - last).norm();
    }
    if (k > 0 && inside != was_inside) {
      ++rims;
      if (!inside && (thinnest_m == 0.0 || run_m < thinnest_m)) thinnest_m = run_m;
      run_m = 0.0;
    }
    was_inside = inside;
    last = center;
  }
  shape.wall_m = thinnest_m;
  const double R = shape.tool_radius_m, around = 2.0 * std::numbers::pi * R;
  // wall of the hole; and a hemisphere at its end, if the path ends in bone
  shape.area_m2 = around * inside_m + (was_inside ? around * R : 0.0);
  if (shape.area_m2 > 0.0) shape.rim_per_area_1_per_m = rims * around / shape.area_m2;
  return shape;
}

}  // namespace osteon::simulation
