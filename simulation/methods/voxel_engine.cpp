#include "simulation/methods/voxel_engine.h"

#include <algorithm>
#include <cmath>

namespace osteon::simulation {
namespace {

void Move(ToolPoints& points, const Vector3& by) {
  for (Vector3& point : points) point += by;
}

}  // namespace

VoxelEngine::VoxelEngine(const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
                         const CuttingParams& params, double voxel_m)
    : VoxelMethod(Method::kVoxelProxy, bone, solid, tool, X_WG, params, voxel_m) {}

bool VoxelEngine::IsBlocked(const ToolPoints& at) const {
  for (std::size_t t = 0; t < tool_.balls.size(); ++t)
    if (!grid_.ForEachSolidNear(at[t], tool_.balls[t].radius_m, 0.0,
                                [](const VoxelIndex&, double) { return false; }))
      return true;
  return false;
}

VoxelEngine::March VoxelEngine::MarchTowards(const ToolPoints& from, const ToolPoints& to) const {
  March march;
  double longest_path_m = 0.0;
  bool something_near = false;
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    const double path_m = (to[t] - from[t]).norm();
    longest_path_m = std::max(longest_path_m, path_m);
    something_near =
        something_near || grid_.AnyBrickNear(0.5 * (from[t] + to[t]), tool_.balls[t].radius_m + 0.5 * path_m);
  }
  if (!something_near || longest_path_m <= 0.0) return march;
  const double step = kStep * grid_.voxel_m() / longest_path_m;
  double free = 0.0, blocked = 1.0;  // fractions of the path: the last free one and the first blocked one
  for (int i = 1;; ++i) {
    const double s = std::min(1.0, i * step);
    if (IsBlocked(InterpolatePoints(from, to, s))) {
      march.blocked = true;
      blocked = s;
      break;
    }
    free = s;
    if (s >= 1.0 || i >= kMaxSteps) break;
  }
  if (!march.blocked) {
    march.fraction = free;
    return march;
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double s = 0.5 * (free + blocked);
    (IsBlocked(InterpolatePoints(from, to, s)) ? blocked : free) = s;
  }
  march.fraction = free;
  FindNormal(InterpolatePoints(from, to, blocked), march);
  return march;
}

// Sums the density's gradient over the voxels that stop the tool.
void VoxelEngine::FindNormal(const ToolPoints& at, March& march) const {
  // limits the time: a pose deep inside is blocked by far more voxels, which hardly change the mean
  constexpr int kMaxVoxels = 256;
  Vector3 sum = Vector3::Zero();
  int voxels = 0;
  for (std::size_t t = tool_.balls.size(); t-- > 0;) {
    grid_.ForEachSolidNear(at[t], tool_.balls[t].radius_m, 0.0, [&](const VoxelIndex& v, double) {
      march.tool_ball = t;
      for (int z = -kGradientReach; z <= kGradientReach; ++z)
        for (int y = -kGradientReach; y <= kGradientReach; ++y)
          for (int x = -kGradientReach; x <= kGradientReach; ++x) {
            const int d2 = x * x + y * y + z * z;
            if (d2 == 0 || d2 > kGradientReach * kGradientReach + 1) continue;
            if (grid_.IsSolid({v.x + x, v.y + y, v.z + z})) sum -= Vector3(x, y, z) / d2;
          }
      return ++voxels < kMaxVoxels;
    });
  }
  const double size = sum.norm();
  // if the gradients cancel, the normal stays zero
  if (size > 1e-9 * voxels) march.n = sum / size;
}

MethodFrame VoxelEngine::Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) {
  MethodFrame frame;
  frame.X_GP = X_GT;
  const ToolPoints goal = PlaceTool(tool_, X_GT);
  ToolPoints proxy = PlaceTool(tool_, X_GP);

  // march towards the tool's pose until the first plane stops the proxy
  const March first = MarchTowards(proxy, goal);
  proxy = InterpolatePoints(proxy, goal, first.fraction);
  double turned_fraction = first.fraction;
  if (first.blocked) {
    frame.contact_fraction = first.fraction;
    const Vector3& n1 = first.n;
    if (!n1.isZero()) {
      // lift the proxy off the plane by the stand-off if the lifted pose is free; then slide parallel to the
      // plane
      ToolPoints lifted = proxy;
      Move(lifted, kStandOff * grid_.voxel_m() * n1);
      if (!IsBlocked(lifted)) proxy = lifted;
      ToolPoints target = goal;
      Move(target, n1.dot(proxy[first.tool_ball] - goal[first.tool_ball]) * n1);
      const March second = MarchTowards(proxy, target);
      proxy = InterpolatePoints(proxy, target, second.fraction);
      turned_fraction += (1.0 - turned_fraction) * second.fraction;
      // if a second plane stops the slide, continue along the line in which both planes meet, unless they are
      // parallel
      const Vector3 line = n1.cross(second.n);
      if (second.blocked && line.norm() > 1e-3) {
        const Vector3 along = line.normalized();
        ToolPoints end = proxy;
        Move(end, along.dot(goal[second.tool_ball] - proxy[second.tool_ball]) * along);
        proxy = InterpolatePoints(proxy, end, MarchTowards(proxy, end).fraction);
      }
      // lower the proxy onto the surface: the hand would feel a remaining stand-off, and nothing would cut it
      ToolPoints lowered = proxy;
      Move(lowered, -2.0 * kStandOff * grid_.voxel_m() * n1);
      proxy = InterpolatePoints(proxy, lowered, MarchTowards(proxy, lowered).fraction);
    }
  }
  frame.X_GP.linear() = Eigen::Quaterniond(X_GP.linear())
                            .slerp(turned_fraction, Eigen::Quaterniond(X_GT.linear()))
                            .toRotationMatrix();
  frame.X_GP.translation() = proxy.back();

  const bool cutting = input.spindle_rad_per_s != 0.0;
  // the offset also contains the effect of the turn that the proxy has not made
  const Vector3 proxy_offset = proxy[first.tool_ball] - goal[first.tool_ball];
  if (first.blocked && proxy_offset.norm() > 0.0) {
    frame.touches = true;
    frame.touch_cuts = tool_.balls[first.tool_ball].cutting;
    frame.depth_m = proxy_offset.norm();
    frame.n = proxy_offset / frame.depth_m;
    frame.point_m = goal[first.tool_ball] - tool_.balls[first.tool_ball].radius_m * frame.n;
    PushAlongNormal(goal.back(), frame);
    if (cutting && frame.touch_cuts) MeasureEngagement(proxy, X_GT.linear().col(2), frame);
    Advance(input, 0.0, frame);
  }
  if (cutting) {
    ToolPoints cut = goal;
    if (params_.law == RemovalLaw::kRate) {
      cut = proxy;
      Move(cut, -frame.advance_m * frame.n);
    }
    DeleteInside(cut, 0.0, frame);
  }
  return frame;
}

}  // namespace osteon::simulation
