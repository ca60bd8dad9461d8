#include "simulation/methods/paper_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/contact/cutting_math.h"
#include "simulation/methods/paper_math.h"

namespace osteon::simulation {
namespace {

/// Distance before the contact at which the proxy of the printed method stops
constexpr double kStandOff_m = 1e-6;

// Pose with the given origin and a rotation between those of two poses, at the fraction `share` of the turn.
Pose Turned(const Pose& from, const Pose& to, double share, const Vector3& origin) {
  Pose X = Pose::Identity();
  const Eigen::Quaterniond a(from.linear()), b(to.linear());
  X.linear() = a.slerp(share, b).toRotationMatrix();
  X.translation() = origin;
  return X;
}

}  // namespace

PaperEngine::PaperEngine(bool printed, const Bone& bone, const Solid* solid, const Tool& tool,
                         const Pose& X_WG, const CuttingParams& params)
    : BallMethod(printed ? Method::kPaperPrinted : Method::kPaperCorrected, bone, solid, tool, X_WG, params),
      printed_(printed) {}

MethodFrame PaperEngine::Solve(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) {
  return printed_ ? SolvePrinted(X_GP, X_GT, input) : SolveCorrected(X_GP, X_GT, input);
}

// ---- the corrected method

// Finds the smallest fraction over all pairs; of equal fractions, that of the first tool ball.
std::optional<PaperEngine::FirstTouch> PaperEngine::FindTouch(const ToolPoints& from, const ToolPoints& to,
                                                              double tolerance_m) const {
  FirstTouch first{.fraction = kNoContact, .tool_ball = 0};
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    const double r_t = tool_.balls[t].radius_m;
    bone_.ForEachBallNear(from[t], to[t], r_t, [&](std::uint32_t, const BallBone::LiveBall& ball) {
      const double s =
          FirstContactFraction(ball.center_m - from[t], to[t] - from[t], r_t + ball.radius_m - tolerance_m);
      if (s < first.fraction) first = {.fraction = s, .tool_ball = t};
    });
  }
  return first.fraction <= 1.0 ? std::optional(first) : std::nullopt;
}

// Normal of the contact ball and the tool balls that overlap it, all enlarged by e, weighted by the volumes
// of their intersections with bone balls.
Vector3 PaperEngine::Normal(const ToolPoints& at, std::size_t contact_ball) const {
  const double e = params_.normal_enlargement_m, r_c = tool_.balls[contact_ball].radius_m + e;
  Vector3 n = Vector3::Zero();
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    const double r_t = tool_.balls[t].radius_m + e;
    if (t != contact_ball && (at[t] - at[contact_ball]).norm() >= r_c + r_t) continue;
    bone_.ForEachBallNear(at[t], at[t], r_t, [&](std::uint32_t, const BallBone::LiveBall& ball) {
      const Vector3 out = at[t] - ball.center_m;
      const double d = out.norm();
      if (d > 0.0) n += LensVolume(r_t, ball.radius_m, d) * ball.density_kg_per_m3 / d * out;
    });
  }
  const double size = n.norm();
  return size > 0.0 ? Vector3(n / size) : Vector3::Zero();
}

void PaperEngine::Cut(const ToolPoints& a, const ToolPoints& b, std::size_t contact_ball,
                      MethodFrame& frame) {
  for (std::size_t t = 0; t < tool_.balls.size(); ++t)
    if (tool_.balls[t].cutting && (contact_ball == t || contact_ball == tool_.balls.size()))
      bone_.Cut(a[t], b[t], tool_.balls[t].radius_m, frame.removed_m3);
}

MethodFrame PaperEngine::SolveCorrected(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) {
  MethodFrame frame;
  frame.X_GP = X_GT;
  const ToolPoints start = PlaceTool(tool_, X_GP), goal = PlaceTool(tool_, X_GT);
  const auto touch = FindTouch(start, goal, 0.0);
  if (!touch) return frame;

  // the contact: its plane, and the depth of the tool's pose beyond this plane
  frame.contact_fraction = touch->fraction;
  const std::size_t c = touch->tool_ball;
  const ToolPoints contact = InterpolatePoints(start, goal, touch->fraction);
  frame.touches = true;
  frame.touch_cuts = tool_.balls[c].cutting;
  frame.n = Normal(contact, c);
  frame.depth_m = std::max(0.0, frame.n.dot(contact[c] - goal[c]));
  frame.point_m = goal[c] - tool_.balls[c].radius_m * frame.n;
  PushAlongNormal(goal.back(), frame);

  // Slide along the plane: search the first contact again on the path to the device's pose, projected onto
  // the plane.
  ToolPoints target = goal;
  for (Vector3& point : target) point += frame.depth_m * frame.n;
  double longest_path_m = 0.0;
  for (std::size_t t = 0; t < target.size(); ++t)
    longest_path_m = std::max(longest_path_m, (target[t] - contact[t]).norm());
  const double max_slide_m = MaxSlide(params_, input);
  double slide = longest_path_m > max_slide_m ? max_slide_m / longest_path_m : 1.0;
  // no tolerance while the spindle turns: the tool would cut by the tolerance in every frame, whatever the
  // cutting law
  const bool cutting = input.spindle_rad_per_s != 0.0;
  if (const auto stop = FindTouch(contact, target, cutting ? 0.0 : params_.contact_tolerance_m))
    slide = std::min(slide, stop->fraction);
  const ToolPoints slid = InterpolatePoints(contact, target, slide);

  // Removal by kImmediate: from the contact to the device's pose. By kRate: along the slide, then into the
  // bone by the law's advance.
  if (cutting && frame.touch_cuts) MeasureEngagement(contact, X_GT.linear().col(2), frame);
  Advance(input, slide * longest_path_m, frame);
  if (cutting) {
    const std::size_t cutters = params_.cutters == Cutters::kContactSphere ? c : tool_.balls.size();
    if (params_.law == RemovalLaw::kImmediate) {
      Cut(contact, goal, cutters, frame);
      return frame;
    }
    ToolPoints end = slid;
    for (Vector3& point : end) point -= frame.advance_m * frame.n;
    Cut(contact, slid, cutters, frame);
    Cut(slid, end, cutters, frame);
    frame.X_GP = Turned(X_GP, X_GT, touch->fraction + (1.0 - touch->fraction) * slide, end.back());
    return frame;
  }
  frame.X_GP = Turned(X_GP, X_GT, touch->fraction + (1.0 - touch->fraction) * slide, slid.back());
  return frame;
}

// ---- the printed method

// Finds the pair with the smallest travelled distance, not with the smallest fraction of the path.
std::optional<PaperEngine::FirstTouch> PaperEngine::FindPrintedTouch(const ToolPoints& from,
                                                                     const ToolPoints& to) const {
  FirstTouch first{.fraction = kNoContact, .tool_ball = 0};
  double min_m = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    const double r_t = tool_.balls[t].radius_m;
    const Vector3 m = to[t] - from[t];
    bone_.ForEachBallNear(from[t], to[t], r_t, [&](std::uint32_t, const BallBone::LiveBall& ball) {
      const double s = printed::ContactFraction(ball.center_m - from[t], m, r_t + ball.radius_m);
      if (s < 0.0 || s * m.norm() >= min_m) return;
      min_m = s * m.norm();
      first = {.fraction = s, .tool_ball = t};
    });
  }
  return first.fraction <= 1.0 ? std::optional(first) : std::nullopt;
}

// Equation 4, summed over the contact sphere with twice its radius and the tool spheres whose centres lie in
// this enlarged sphere.
Vector3 PaperEngine::PrintedNormal(const ToolPoints& at, std::size_t contact_ball) const {
  const double enlarged = 2.0 * tool_.balls[contact_ball].radius_m;
  Vector3 n = Vector3::Zero();
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    if ((at[t] - at[contact_ball]).norm() > enlarged) continue;
    const double r_t = t == contact_ball ? enlarged : tool_.balls[t].radius_m;
    bone_.ForEachBallNear(at[t], at[t], r_t, [&](std::uint32_t, const BallBone::LiveBall& ball) {
      const Vector3 out = at[t] - ball.center_m;
      const double d = out.norm();
      if (d > 0.0)  // the printed equation is evaluated in millimetres
        n += printed::LensVolume(1e3 * r_t, 1e3 * ball.radius_m, 1e3 * d) * ball.density_kg_per_m3 / d * out;
    });
  }
  const double size = n.norm();
  return size > 0.0 ? Vector3(n / size) : Vector3::Zero();
}

// Equation 5, in millimetres, for the bone balls that the contact sphere touches on its path from a to b.
void PaperEngine::PrintedRemoval(const Vector3& a, const Vector3& b, double radius_m, MethodFrame& frame) {
  bone_.ForEachBallNear(a, b, radius_m, [&](std::uint32_t i, const BallBone::LiveBall& ball) {
    const Vector3 d_c = ClosestOnSegment(ball.center_m, a, b) - ball.center_m;
    if (d_c.norm() >= radius_m + ball.radius_m) return;  // "for each colliding bone sphere"
    Vector3 center_mm = 1e3 * ball.center_m;
    double radius_mm = 1e3 * ball.radius_m;
    printed::Shrink(center_mm, radius_mm, 1e3 * d_c);
    bone_.Replace(i, 1e-3 * center_mm, std::max(0.0, 1e-3 * radius_mm));
  });
  bone_.ClearPoints(a, b, radius_m, frame.removed_m3);
}

MethodFrame PaperEngine::SolvePrinted(const Pose& X_GP, const Pose& X_GT, const FrameInput& input) {
  MethodFrame frame;
  frame.X_GP = X_GT;
  const ToolPoints start = PlaceTool(tool_, X_GP), goal = PlaceTool(tool_, X_GT);
  const auto touch = FindPrintedTouch(start, goal);
  if (!touch) return frame;

  const std::size_t c = touch->tool_ball;
  const Vector3 path = goal[c] - start[c];
  const double s = std::max(0.0, touch->fraction - kStandOff_m / path.norm());
  const ToolPoints proxy = InterpolatePoints(start, goal, s);
  frame.contact_fraction = touch->fraction;
  frame.touches = true;
  frame.touch_cuts = tool_.balls[c].cutting;
  frame.n = PrintedNormal(proxy, c);
  const Vector3 pull = proxy[c] - goal[c];
  frame.force_N = params_.stiffness_N_per_m * pull;
  if (frame.force_N.norm() > params_.max_force_N) frame.force_N *= params_.max_force_N / frame.force_N.norm();
  frame.torque_Nm = (goal[c] - goal.back()).cross(frame.force_N);
  frame.depth_m = frame.n.dot(pull);
  frame.point_m = goal[c];

  if (input.spindle_rad_per_s != 0.0 && frame.touch_cuts)
    PrintedRemoval(start[c], goal[c], tool_.balls[c].radius_m, frame);
  else
    frame.X_GP = Turned(X_GP, X_GT, s, proxy.back());
  return frame;
}

}  // namespace osteon::simulation
