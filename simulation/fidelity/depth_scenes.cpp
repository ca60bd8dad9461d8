#include "simulation/fidelity/depth_scenes.h"

#include <algorithm>
#include <cmath>

#include "base/check_range.h"
#include "simulation/solids/box_solid.h"

namespace osteon::simulation {

ShellSolid::ShellSolid(double inner_m, double outer_m) : inner_m_(inner_m), outer_m_(outer_m) {
  CheckRangeMm("shell: outer radius", outer_m, 1e-3, 1.0);
  CheckRangeMm("shell: inner radius", inner_m, 1e-3, std::nextafter(outer_m, 0.0));
}

SurfacePoint ShellSolid::NearestSurface(const Vector3& p) const {
  // below the rim's plane the nearest of three faces, above it the nearest point of the rim
  const double size = p.norm();
  const Vector3 out = size > 0.0 ? Vector3(p / size) : Vector3(-Vector3::UnitZ());
  if (p.z() <= 0.0) {
    const double to_outer = size - outer_m_, to_inner = inner_m_ - size, to_rim = p.z();
    if (to_outer > 0.0 || (to_outer >= to_inner && to_outer >= to_rim)) return {outer_m_ * out, to_outer};
    if (to_inner > 0.0 || to_inner >= to_rim) return {inner_m_ * out, to_inner};
    return {Vector3(p.x(), p.y(), 0.0), to_rim};
  }
  const double across = std::hypot(p.x(), p.y());
  const Vector3 radial =
      across > 0.0 ? Vector3(p.x() / across, p.y() / across, 0.0) : Vector3(Vector3::UnitX());
  const Vector3 foot = std::clamp(across, inner_m_, outer_m_) * radial;
  return {foot, (p - foot).norm()};
}

Eigen::AlignedBox3d ShellSolid::Bounds() const {
  return {Vector3(-outer_m_, -outer_m_, -outer_m_), Vector3(outer_m_, outer_m_, 0.0)};
}

std::vector<Pose> DepthScene::Path(double step_m) const {
  const Vector3 center_T = tool.balls.front().center_m;
  std::vector<Pose> path;
  const auto add = [&](const Vector3& center) {
    Pose X = Pose::Identity();
    X.linear() = Vector3(1, -1, -1).asDiagonal();
    X.translation() = center - X.linear() * center_T;
    path.push_back(X);
  };
  add(corners_m.front());
  for (std::size_t i = 0; i + 1 < corners_m.size(); ++i) {
    const Vector3 way = corners_m[i + 1] - corners_m[i];
    const int steps = std::max(1, static_cast<int>(std::ceil(way.norm() / step_m - 1e-9)));
    for (int k = 1; k <= steps; ++k) add(corners_m[i] + (static_cast<double>(k) / steps) * way);
  }
  return path;
}

namespace {

Tool OneBall(const char* name, double radius_m) {
  Tool tool;
  tool.name = name;
  tool.balls = {{.center_m = Vector3(0, 0, -radius_m), .radius_m = radius_m, .cutting = true}};
  return tool;
}

}  // namespace

DepthScene MakeBlockScene() {
  DepthScene scene;
  scene.name = "block";
  scene.solid = std::make_unique<BoxSolid>(Vector3(-10e-3, -10e-3, -20e-3), Vector3(10e-3, 10e-3, 0.0));
  scene.zone = std::make_unique<PathZone>(std::vector<Vector3>{Vector3::Zero()}, 9e-3);  // around the entry
  scene.tool = OneBall("ball of 5 mm", 5e-3);
  scene.corners_m = {{-3e-3, 0, 5.5e-3}, {-3e-3, 0, 0}, {3e-3, 0, 0}};
  return scene;
}

DepthScene MakeCupScene() {
  DepthScene scene;
  scene.name = "cup";
  scene.solid = std::make_unique<ShellSolid>(25e-3, 33e-3);
  scene.zone = std::make_unique<CupZone>(
      CutSite{.center_m = Vector3(0, 0, 0), .axis = Vector3(0, 0, 1), .radius_m = 25e-3});
  scene.tool = OneBall("ball of 25 mm", 25e-3);
  scene.corners_m = {{0, 0, 0}, {0, 0, -3e-3}};
  return scene;
}

}  // namespace osteon::simulation
