#include "studies/failures/cutting/single_contact.h"

#include <utility>

#include "simulation/contact/cutting_math.h"

namespace osteon::studies {

SingleContact::SingleContact(std::vector<simulation::Ball> balls, const simulation::Tool& tool,
                             const SingleContactParams& params)
    : balls_(std::move(balls)), tool_(tool), params_(params) {}

SingleContact::FirstHit SingleContact::FirstContact(const Pose& X_GA, const Pose& X_GB) const {
  FirstHit hit{.fraction = simulation::kNoContact, .bone_ball = 0, .tool_ball = 0};
  for (std::size_t t = 0; t < tool_.balls.size(); ++t) {
    const Vector3 from = X_GA * Vector3(tool_.balls[t].center_m),
                  to = X_GB * Vector3(tool_.balls[t].center_m);
    for (std::size_t b = 0; b < balls_.size(); ++b) {
      if (balls_[b].radius_m <= 0.0) continue;
      const Vector3 D = Vector3(balls_[b].center_m) - from;
      const double R = balls_[b].radius_m + tool_.balls[t].radius_m;
      if (params_.positive_roots_only && D.squaredNorm() < R * R) continue;
      const double s = simulation::FirstContactFraction(D, to - from, R);
      if (s < hit.fraction) hit = {.fraction = s, .bone_ball = b, .tool_ball = t};
    }
  }
  return hit;
}

SingleContactFrame SingleContact::Step(const Pose& X_GT) {
  if (!has_proxy_) X_GP_ = X_GT;
  has_proxy_ = true;
  SingleContactFrame frame;
  Pose X_from = X_GP_, X_to = X_GT;
  Vector3 touching = Vector3::Zero();
  for (int leg = 0; leg <= params_.slides; ++leg) {
    const FirstHit hit = FirstContact(X_from, X_to);
    if (hit.fraction > 1.0) {
      X_from = X_to;
      break;
    }
    Pose X_met = X_to;
    X_met.translation() = X_from.translation() + hit.fraction * (X_to.translation() - X_from.translation());
    const simulation::ToolBall& ball = tool_.balls[hit.tool_ball];
    frame.touching = true;
    frame.n = (X_met * Vector3(ball.center_m) - Vector3(balls_[hit.bone_ball].center_m)).normalized();
    touching = X_met * Vector3(ball.center_m) - ball.radius_m * frame.n;
    const Vector3 rest = X_to.translation() - X_met.translation();
    X_from = X_met;
    X_to.translation() = X_met.translation() + rest - frame.n.dot(rest) * frame.n;
  }
  X_GP_ = X_from;
  frame.p_G = X_GP_.translation();
  if (!frame.touching) return frame;
  frame.F_T_G.f = params_.stiffness_N_per_m * (frame.p_G - X_GT.translation());
  frame.F_T_G.t = (touching - X_GP_ * Vector3(tool_.center_of_mass_m)).cross(frame.F_T_G.f);
  return frame;
}

}  // namespace osteon::studies
