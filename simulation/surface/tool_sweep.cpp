#include "simulation/surface/tool_sweep.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "simulation/surface/millimetres.h"
#include "simulation/tools/thin_path.h"
#include "simulation/tools/tool_path.h"

namespace osteon::surface {
namespace {

/// Distance of p from the segment between a and b.
double DistanceFromChord(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp(along.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

/// Whether one of the kept balls contains the ball. If so, the ball sweeps nothing that the kept ball does
/// not sweep.
bool IsCovered(const simulation::ToolBall& ball, const std::vector<simulation::ToolBall>& kept) {
  return std::any_of(kept.begin(), kept.end(), [&](const simulation::ToolBall& other) {
    return (Vector3(ball.center_m) - Vector3(other.center_m)).norm() + ball.radius_m <= other.radius_m;
  });
}

/// Whether no point of the tool has moved by more than a micrometre. Such a frame is skipped: it sweeps less
/// than the error of the thinning, and a tool at rest has thousands of these frames.
bool Dwells(double lever_m, const Pose& before, const Pose& now) {
  constexpr double kStill_m = 1e-6;
  // the difference of two rotation matrices that are an angle a apart has the norm sqrt(8) sin(a / 2)
  const double turn_rad = (now.linear() - before.linear()).norm() / std::numbers::sqrt2;
  return (now.translation() - before.translation()).norm() + lever_m * turn_rad <= kStill_m;
}

}  // namespace

ToolFrame MakeToolFrame(const simulation::ContactModel& model, double spindle_rad_per_s) {
  if (model.status != simulation::EngineStatus::kOk) return {};
  return {.X_WP = model.X_WP,
          .p_WS_m = model.p_WS_m,
          .cuts = spindle_rad_per_s != 0.0,
          .frame = model.frame,
          .touches = model.contact_count > 0 || model.engaged_area_m2 > 0.0,
          .pose_stamp = model.pose_stamp};
}

ToolSweep::ToolSweep(const simulation::Tool& tool, const Pose& X_WG)
    : X_GW_(X_WG.inverse()), lever_m_(simulation::ToolLever(tool)) {
  std::vector<simulation::ToolBall> balls;
  for (const simulation::ToolBall& ball : tool.balls)
    if (ball.cutting) balls.push_back(ball);
  std::stable_sort(balls.begin(), balls.end(),
                   [](const auto& a, const auto& b) { return a.radius_m > b.radius_m; });
  for (const simulation::ToolBall& ball : balls)
    if (!IsCovered(ball, cutters_)) cutters_.push_back(ball);
}

bool ToolSweep::Add(const ToolFrame& frame) {
  const Pose X_GP = X_GW_ * Pose(frame.X_WP);
  if (frame.frame == 0 || !X_GP.matrix().allFinite()) return false;
  frame_ = frame.frame;
  if (!frame.cuts || !X_GP_) {
    EndPath();
    X_GP_ = X_GP;
    return !capsules_.empty();
  }
  // The pose after the slide: the frame's new rotation, and T's origin before the bone yielded.
  Pose slid = X_GP;
  const Vector3 p_GS = X_GW_ * Vector3(frame.p_WS_m);
  if (p_GS.allFinite()) slid.translation() = p_GS;
  if (!Dwells(lever_m_, *X_GP_, slid) || !Dwells(lever_m_, *X_GP_, X_GP)) AddPath(slid, X_GP);
  if (++frames_ < kBatchFrames) return false;
  EndPath();
  return true;
}

void ToolSweep::AddPath(const Pose& slid, const Pose& X_GP) {
  if (way_.empty()) way_.push_back(*X_GP_);
  const int parts = simulation::SubframeCount(lever_m_, *X_GP_, slid);
  for (int k = 1; k < parts; ++k) way_.push_back(simulation::PoseBetween(*X_GP_, slid, k, parts));
  way_.push_back(slid);
  way_.push_back(X_GP);
  X_GP_ = X_GP;
}

void ToolSweep::EndPath() {
  for (const simulation::ToolBall& ball : cutters_) {
    std::vector<Vector3> centres;
    centres.reserve(way_.size());
    for (const Pose& X_GP : way_) centres.push_back(X_GP * Vector3(ball.center_m));
    const std::vector<Vector3> thin = simulation::ThinPath(centres, kTolerance_m, DistanceFromChord);
    for (std::size_t i = 1; i < thin.size(); ++i)
      capsules_.push_back({.a_mm = ToMillimetres(thin[i - 1]),
                           .b_mm = ToMillimetres(thin[i]),
                           .radius_mm = static_cast<float>(1e3 * ball.radius_m)});
  }
  way_.clear();
  frames_ = 0;
}

std::vector<Capsule> ToolSweep::TakeCapsules() {
  EndPath();
  return std::exchange(capsules_, {});
}

float VoxelFor(const simulation::Tool& tool) {
  constexpr float kMin_mm = 0.1F, kMax_mm = 0.5F;
  const simulation::ToolBall* head = simulation::CuttingHead(tool);
  const float quarter_mm = head ? static_cast<float>(0.25e3 * head->radius_m) : kMax_mm;
  return std::clamp(quarter_mm, kMin_mm, kMax_mm);
}

}  // namespace osteon::surface
