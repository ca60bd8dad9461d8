#include "simulation/removal/cut_metrics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/removal/swept_volume.h"

namespace osteon::simulation {
namespace {

// The ball whose apex is measured: the largest cutting ball, or the first ball of a tool that does not cut.
ToolBall Head(const Tool& tool) {
  const ToolBall* head = CuttingHead(tool);
  return head ? *head : tool.balls.front();
}

}  // namespace

std::optional<double> FirstHit(std::span<const Ball> balls, const Vector3& origin_m,
                               const Vector3& direction) {
  std::optional<double> first;
  for (const Ball& ball : balls) {
    const Vector3 D = Vector3(ball.center_m) - origin_m;
    const double along = D.dot(direction), gap = D.squaredNorm() - ball.radius_m * ball.radius_m;
    if (ball.radius_m <= 0.0) continue;
    if (gap <= 0.0) return 0.0;
    const double discriminant = along * along - gap;
    if (along <= 0.0 || discriminant < 0.0) continue;
    const double t = along - std::sqrt(discriminant);
    if (!first || t < *first) first = t;
  }
  return first;
}

std::vector<Ball> LiveBalls(const CarvedState& state) {
  std::vector<Ball> balls;
  // four: centre and radius [mm]
  const auto add = [&balls](const float* four) {
    if (four[3] > 0.0f)
      balls.push_back({.center_m = 1e-3 * Vector3(four[0], four[1], four[2]), .radius_m = 1e-3 * four[3]});
  };
  for (std::size_t i = 0; i + 3 < state.balls.size(); i += 4) add(&state.balls[i]);
  const std::size_t slots =
      state.split_balls.empty() ? 0 : state.split_slots.size() / state.split_balls.size();
  for (std::size_t j = 0; j < state.split_balls.size(); ++j)
    for (std::size_t k = 0; state.split_cuts[j] == 0 && k + 3 < slots; k += 4)
      add(&state.split_slots[j * slots + k]);
  return balls;
}

ApexDepth::ApexDepth(const Bone& bone, const Tool& tool)
    : cup_(bone.site),
      head_T_m_(Head(tool).center_m),
      head_radius_m_(Head(tool).radius_m),
      floor_m_(
          FirstHit(bone.balls, bone.site.center_m, -Vector3(bone.site.axis)).value_or(bone.site.radius_m)) {}

double ApexDepth::DepthAt(const Pose& X_GP) const {
  const double along = Vector3(cup_.axis).dot(X_GP * head_T_m_ - Vector3(cup_.center_m));
  return head_radius_m_ - along - floor_m_;
}

ReamedDepth::ReamedDepth(const Bone& bone, const Tool& tool, const Pose& X_WG)
    : apex_(bone, tool), X_GW_(X_WG.inverse()) {
  constexpr double kMinShare = 0.005, kMinArea_m2 = 0.2e-6;
  const double radius_m = Head(tool).radius_m;
  min_area_m2_ = std::max(kMinArea_m2, kMinShare * std::numbers::pi * radius_m * radius_m);
}

void ReamedDepth::Add(const FrameRecord& frame) {
  constexpr double kStep_m = 0.25e-3;
  if (frame.model.frame == 0 || frame.model.status != EngineStatus::kOk) return;
  const double depth_now_m = apex_.DepthAt(X_GW_ * Pose(frame.model.X_WP));
  if (!std::isfinite(depth_now_m)) return;
  removed_m3_ = frame.model.removed_volume_m3;
  if (!touched_) {
    touched_ = Vector3(frame.model.F_T_W.f).norm() > 0.0;
    from_m_ = deepest_m_ = depth_now_m;
    from_m3_ = removed_m3_;
    return;
  }
  deepest_m_ = std::max(deepest_m_, depth_now_m);
  if (deepest_m_ - from_m_ < kStep_m) return;
  cuts_ = Cuts();
  if (cuts_) reamed_m_ += deepest_m_ - from_m_;
  from_m_ = deepest_m_;
  from_m3_ = removed_m3_;
}

bool ReamedDepth::Cuts() const { return removed_m3_ - from_m3_ >= min_area_m2_ * (deepest_m_ - from_m_); }

double ReamedDepth::depth_m() const {
  // the last depth is less than a step: it counts if the step before it counted, or if enough bone was
  // removed in it
  return deepest_m_ > from_m_ && (cuts_ || Cuts()) ? reamed_m_ + (deepest_m_ - from_m_) : reamed_m_;
}

double SweptVolume(const Solid& solid, const Tool& tool, std::span<const Pose> X_GP, double cell_m,
                   int threads) {
  return SweptVolume(solid, SweptTool(tool, X_GP), cell_m, threads);
}

}  // namespace osteon::simulation
