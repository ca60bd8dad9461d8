#include "studies/regress/plane_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace osteon::studies {

using simulation::ContactModel;

PlaneEngine::PlaneEngine(simulation::Tool tool, const Vector3& p_W, const Vector3& n_W,
                         const simulation::CuttingParams& params)
    : tool_(std::move(tool)), p_W_(p_W), n_W_(n_W), params_(params) {
  if (tool_.balls.empty()) throw std::invalid_argument("plane engine: a tool without balls");
  if (!(std::abs(n_W.norm() - 1.0) < 1e-9)) throw std::invalid_argument("plane engine: no unit normal");
}

ContactModel PlaneEngine::Step(const simulation::FrameInput& input) {
  ContactModel model;
  const Pose X_WT(input.X_WT);
  if (!X_WT.matrix().allFinite() || !std::isfinite(input.dt_s)) {
    model.status = simulation::EngineStatus::kBadInput;
    return model;
  }
  model.frame = ++frame_;
  model.pose_stamp = input.stamp;

  // Find the ball that is deepest in the plane, and its deepest point.
  double gap_m = std::numeric_limits<double>::infinity();
  Vector3 p_TP = Vector3::Zero();
  const Vector3 n_T = X_WT.linear().transpose() * n_W_;
  for (const simulation::ToolBall& ball : tool_.balls) {
    const Vector3 p = Vector3(ball.center_m) - ball.radius_m * n_T;
    const double gap = n_W_.dot(X_WT * p - p_W_);
    if (gap >= gap_m) continue;
    gap_m = gap;
    p_TP = p;
  }

  const double depth_m = std::max(0.0, -gap_m);
  model.X_WP = Pose(Eigen::Translation3d(depth_m * n_W_) * X_WT);
  if (gap_m > params_.normal_enlargement_m) return model;
  const Vector3 arm_W = X_WT.linear() * p_TP;
  simulation::Contact& contact = model.contacts.front();
  model.contact_count = 1;
  contact.p_TP_m = p_TP;
  contact.n_W = n_W_;
  contact.p_W_m = Vector3(X_WT.translation() + arm_W - gap_m * n_W_);
  contact.gap_m = gap_m;
  contact.stiffness_N_per_m = params_.stiffness_N_per_m;
  contact.weight = 1.0;
  if (depth_m == 0.0) return model;
  model.n_W = n_W_;
  const Vector3 f = params_.stiffness_N_per_m * depth_m * n_W_;
  model.F_T_W = Wrench{.f = f, .t = arm_W.cross(f)};
  return model;
}

simulation::CarvedState PlaneEngine::Snapshot() const {
  simulation::CarvedState state;
  state.frame = frame_;
  return state;
}

}  // namespace osteon::studies
