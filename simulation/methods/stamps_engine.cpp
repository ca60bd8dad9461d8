#include "simulation/methods/stamps_engine.h"

#include <algorithm>
#include <cmath>

#include "simulation/contact/cutting_math.h"

namespace osteon::simulation {

StampsEngine::StampsEngine(const Bone& bone, const Solid* solid, const Tool& tool, const Pose& X_WG,
                           const CuttingParams& params)
    : BallMethod(Method::kStamps, bone, solid, tool, X_WG, params) {}

// Finds the deepest pair, the mean normal around its tool ball, and the travel along this normal that
// separates the pair. The travel is limited; if it does not separate the pair, the next push continues.
StampsEngine::Overlap StampsEngine::Deepest(const ToolPoints& at) const {
  Overlap deepest;
  Vector3 pair_direction = Vector3::Zero();
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    const double r_t = tool_.balls[t].radius_m;
    bone_.ForEachBallNear(at[t], at[t], r_t, [&](std::uint32_t, const BallBone::LiveBall& ball) {
      const double depth = r_t + ball.radius_m - (at[t] - ball.center_m).norm();
      if (depth <= deepest.depth_m) return;
      deepest = {.depth_m = depth, .tool_ball = t};
      pair_direction = (at[t] - ball.center_m).normalized();
    });
  }
  if (deepest.depth_m <= 0.0) return deepest;
  const Vector3 center = at[deepest.tool_ball];
  const double r_t = tool_.balls[deepest.tool_ball].radius_m, e = params_.normal_enlargement_m;
  bone_.ForEachBallNear(center, center, r_t + e, [&](std::uint32_t, const BallBone::LiveBall& ball) {
    const Vector3 out = center - ball.center_m;
    const double d = out.norm();
    if (d > 0.0) deepest.n += LensVolume(r_t + e, ball.radius_m, d) / d * out;
  });
  const double size = deepest.n.norm();
  deepest.n = size > 0.0 ? Vector3(deepest.n / size) : Vector3::Zero();
  deepest.depth_m /= std::max(kMinCosine, pair_direction.dot(deepest.n));
  return deepest;
}

bool StampsEngine::Overlaps(const ToolPoints& at) const {
  bool overlaps = false;
  for (std::size_t t = 0; t < tool_.balls.size() && !overlaps; ++t)
    bone_.ForEachBallNear(at[t], at[t], tool_.balls[t].radius_m,
                          [&](std::uint32_t, const BallBone::LiveBall& ball) {
                            const double reach = tool_.balls[t].radius_m + ball.radius_m - kFree_m;
                            overlaps = overlaps || (at[t] - ball.center_m).squaredNorm() < reach * reach;
                          });
  return overlaps;
}

MethodFrame StampsEngine::Solve(const Pose&, const Pose& X_GT, const FrameInput& input) {
  MethodFrame frame;
  frame.X_GP = X_GT;
  const ToolPoints goal = PlaceTool(tool_, X_GT);
  const bool cutting = input.spindle_rad_per_s != 0.0;

  // push the tool out of the bone
  ToolPoints free_pose = goal;
  Overlap first_overlap;
  for (int i = 0; i < kPushes; ++i) {
    const Overlap overlap = Deepest(free_pose);
    if (overlap.depth_m <= kFree_m || overlap.n.isZero()) break;
    if (i == 0) first_overlap = overlap;
    for (Vector3& point : free_pose) point += overlap.depth_m * overlap.n;
  }
  // move back until the tool just touches, by bisection: pushes go too far if many pairs overlap
  if (free_pose.back() != goal.back() && !Overlaps(free_pose)) {
    ToolPoints blocked = goal;
    for (int i = 0; i < kHalvings; ++i) {
      const ToolPoints middle = InterpolatePoints(blocked, free_pose, 0.5);
      (Overlaps(middle) ? blocked : free_pose) = middle;
    }
  }
  const Vector3 out = free_pose.back() - goal.back();
  frame.depth_m = out.norm();
  ToolPoints stamp = goal;
  if (frame.depth_m > 0.0) {
    frame.contact_fraction = 0.0;
    frame.touches = true;
    frame.touch_cuts = tool_.balls[first_overlap.tool_ball].cutting;
    frame.n = out / frame.depth_m;
    frame.point_m = goal[first_overlap.tool_ball] - tool_.balls[first_overlap.tool_ball].radius_m * frame.n;
    PushAlongNormal(goal.back(), frame);
    frame.X_GP.translation() = free_pose.back();

    if (cutting && frame.touch_cuts) MeasureEngagement(free_pose, X_GT.linear().col(2), frame);
    Advance(input, 0.0, frame);
    if (params_.law == RemovalLaw::kRate) {
      stamp = free_pose;
      for (Vector3& point : stamp) point -= frame.advance_m * frame.n;
    }
    if (cutting) frame.X_GP.translation() = stamp.back();
  }
  if (cutting)
    for (std::size_t t = 0; t < tool_.balls.size(); ++t)
      if (tool_.balls[t].cutting) bone_.Cut(stamp[t], stamp[t], tool_.balls[t].radius_m, frame.removed_m3);
  return frame;
}

}  // namespace osteon::simulation
