#include "simulation/bone/scene_events.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "base/check_range.h"

namespace osteon::simulation {
namespace {

constexpr double kCosSixtyDegrees = 0.5;
constexpr int kMaxRefinements = 5;   // largest number of steps from a sample to the wall's nearest point
constexpr double kRefined_m = 1e-8;  // a shorter step along the wall ends the refinement

// Index of the region's material in the bone. @throws std::invalid_argument if the bone has no such material
MaterialIndex FindMaterial(const Bone& bone, const RegionWatch& region) {
  std::string names;
  for (std::size_t i = 0; i < bone.materials.size(); ++i) {
    if (bone.materials[i].name == region.material) return static_cast<MaterialIndex>(i);
    names += (i == 0 ? "" : ", ") + bone.materials[i].name;
  }
  throw std::invalid_argument(fmt::format("events: region {}: material: found \"{}\", accepted one of {}",
                                          region.name, region.material, names));
}

std::vector<OrientedPoint> MassPointsOf(const Bone& bone, MaterialIndex material) {
  std::vector<OrientedPoint> points;
  for (const MassPoint& point : bone.points)
    if (point.material == material) points.push_back({.p_m = point.p_m});
  return points;
}

}  // namespace

SceneWatch::SceneWatch(const Solid* solid, const Bone& bone, const Tool& tool, const SceneEventParams& params)
    : solid_(solid), site_(bone.site), params_(params), walls_({}) {
  CheckRangeMm("events: least_wall", params.min_wall_m, 0.0, 0.1);
  if (!(params.opening_widening >= 1.0 && params.opening_widening <= 10.0))
    throw std::invalid_argument(
        fmt::format("events: opening_widening: found {:g}, accepted 1 … 10", params.opening_widening));
  for (const ToolBall& ball : tool.balls)
    if (ball.cutting) cutting_.push_back(ball);
  for (const RegionWatch& watch : params.regions) {
    Region region{.name = watch.name, .material = FindMaterial(bone, watch), .points = {}};
    if (!solid || !solid->RegionDistance(region.material, site_.center_m))
      region.points.emplace(MassPointsOf(bone, region.material));
    regions_.push_back(std::move(region));
  }
  if (solid && params.min_wall_m > 0.0) {
    std::vector<OrientedPoint> samples = PointsOfSurface(*solid, params.wall_spacing_m);
    std::erase_if(samples, [this](const OrientedPoint& sample) { return IsOpening(sample); });
    walls_ = SampleIndex(std::move(samples));
  }
}

bool SceneWatch::IsOpening(const OrientedPoint& sample) const {
  const Vector3 axis = site_.axis, from_center = sample.p_m - Vector3(site_.center_m);
  const double out = sample.normal.dot(axis);  // cosine of the angle between normal and axis
  if (out > kCosSixtyDegrees) return true;
  const Vector3 off_axis = from_center - from_center.dot(axis) * axis;
  if (off_axis.norm() < params_.opening_widening * site_.radius_m) return out > -kCosSixtyDegrees;
  return out > 0.0 && sample.normal.dot(off_axis) < 0.0;
}

// Moves from a sample of the surface to the wall's point nearest to c. Each step moves the point in its
// tangent plane to the foot of the perpendicular from c, and then back to the surface. The steps continue
// while the point comes nearer to c and stays on a wall that faces away from c.
OrientedPoint SceneWatch::Refined(const Vector3& c_m, OrientedPoint at) const {
  for (int i = 0; i < kMaxRefinements; ++i) {
    const Vector3 to_center = c_m - at.p_m;
    const Vector3 along_wall = to_center - to_center.dot(at.normal) * at.normal;
    if (along_wall.norm() < kRefined_m) break;
    OrientedPoint next;
    next.p_m = solid_->NearestSurface(at.p_m + along_wall).p_m;
    next.normal = SurfaceNormal(*solid_, next.p_m);
    const bool nearer = (next.p_m - c_m).norm() < to_center.norm();
    if (!nearer || IsOpening(next) || (next.p_m - c_m).dot(next.normal) <= 0.0) break;
    at = next;
  }
  return at;
}

double SceneWatch::DepthOf(const Vector3& p_G) const {
  return Vector3(site_.axis).dot(Vector3(site_.center_m) - p_G);
}

std::vector<SceneEvent> SceneWatch::Step(const Pose& X_GP, double removed_volume_m3, rt::Nanoseconds stamp) {
  std::vector<SceneEvent> events;
  const bool cut = removed_volume_m3 > removed_volume_m3_;
  removed_volume_m3_ = removed_volume_m3;
  if (!cut || !X_GP.matrix().allFinite()) return events;

  for (Region& region : regions_)
    if (!region.reached) StepRegion(region, X_GP, stamp, events);

  if (const auto wall = ThinnestWall(X_GP)) {
    min_wall_m_ = wall->thickness_m;
    if (!wall_too_thin_ && wall->thickness_m < params_.min_wall_m) {
      wall_too_thin_ = true;
      events.push_back({.name = "wall too thin",
                        .stamp = stamp,
                        .value = std::max(0.0, wall->thickness_m),
                        .p_G_m = wall->p_G_m});
    }
    if (!broke_through_ && wall->thickness_m <= 0.0) {
      broke_through_ = true;
      events.push_back(
          {.name = "breakthrough", .stamp = stamp, .value = DepthOf(wall->p_G_m), .p_G_m = wall->p_G_m});
    }
  }
  return events;
}

void SceneWatch::StepRegion(Region& region, const Pose& X_GP, rt::Nanoseconds stamp,
                            std::vector<SceneEvent>& events) {
  for (const ToolBall& ball : cutting_) {
    const Vector3 c = X_GP * Vector3(ball.center_m);
    Vector3 place;
    if (region.points) {
      const auto point = region.points->Nearest(c, ball.radius_m);
      if (!point) continue;
      place = point->p_m;
    } else {
      const auto distance = solid_->RegionDistance(region.material, c);
      if (!distance || distance->distance_m > ball.radius_m) continue;
      place = distance->p_m;
    }
    region.reached = true;
    events.push_back(
        {.name = region.name + " reached", .stamp = stamp, .value = DepthOf(place), .p_G_m = place});
    return;
  }
}

std::optional<SceneWatch::Wall> SceneWatch::ThinnestWall(const Pose& X_GP) const {
  std::optional<Wall> thinnest;
  if (walls_.size() == 0) return thinnest;
  for (const ToolBall& ball : cutting_) {
    const Vector3 c = X_GP * Vector3(ball.center_m);
    // Search only for a wall thinner than the thinnest so far. Add one sample spacing, because the nearest
    // sample may be this much farther away than the wall's nearest point.
    const std::optional<double> bound = thinnest ? thinnest->thickness_m : min_wall_m_;
    const double limit_m = bound ? std::max(0.0, *bound) + ball.radius_m + params_.wall_spacing_m
                                 : std::numeric_limits<double>::infinity();
    const auto sample = walls_.Nearest(c, limit_m, true);
    if (!sample) continue;
    const OrientedPoint foot = Refined(c, *sample);  // the wall's point nearest to c
    const double distance_m = (foot.p_m - c).norm(), thickness_m = distance_m - ball.radius_m;
    // if the middle between ball and foot lies in air, the ball is outside the bone: no wall is between them
    const Vector3 middle = foot.p_m + 0.5 * thickness_m / distance_m * (c - foot.p_m);
    if (thickness_m > 0.0 && solid_->SignedDistance(middle) > 0.0) continue;
    if (!bound || thickness_m < *bound) thinnest = Wall{thickness_m, foot.p_m};
  }
  return thinnest;
}

}  // namespace osteon::simulation
