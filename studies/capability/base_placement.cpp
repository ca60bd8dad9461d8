#include "studies/capability/base_placement.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/parallel.h"

namespace osteon::studies {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDegree = kTurn / 360.0;
constexpr double kFirstAngleStep = 10.0 * kDegree;  // first step of the arm angle in the compass search

// Number of grid places in a range, both ends included.
std::size_t Count(const AxisRange& range, double step) {
  return 1 + static_cast<std::size_t>(std::floor((range.to - range.from) / step + 1e-9));
}

}  // namespace

kinematics::LbrParams WithNarrowedLimits(kinematics::LbrParams params, double margin_rad) {
  for (kinematics::JointLimits& limits : params.limits) {
    limits.lower_rad += margin_rad;
    limits.upper_rad -= margin_rad;
  }
  return params;
}

BasePlacement::BasePlacement(const kinematics::ChainParams<7>& arm, const Matrix3& R_WB, const Pose& X_FT,
                             const TaskVolume& task, const CapabilityNeed& need,
                             const BasePlacementParams& params)
    : arm_(WithNarrowedLimits(kinematics::LbrParamsFrom(arm), params.joint_margin_rad)),
      force_(arm, R_WB, X_FT, need),
      R_WB_(R_WB),
      X_TF_(X_FT.inverse()),
      task_(task),
      params_(params) {}

// Returns the pose of a base at a place, turned so that its x axis (A1 = 0, the middle of A1's range) points
// toward the site.
Pose BasePlacement::Facing(const Vector3& p_WB) const {
  const Vector3 p_B_site = R_WB_.transpose() * (task_.X_WC.translation() - p_WB);
  const double turn = std::atan2(p_B_site.y(), p_B_site.x());
  Pose X_WB = Pose::Identity();
  X_WB.linear() = R_WB_ * ExpRotation({0.0, 0.0, turn});
  X_WB.translation() = p_WB;
  return X_WB;
}

// Returns the angle by which the base is turned about its own axis, from R_WB.
double BasePlacement::TurnOf(const Pose& X_WB) const {
  const Matrix3 R = R_WB_.transpose() * X_WB.linear();
  return std::atan2(R(1, 0), R(0, 0));
}

bool BasePlacement::IsClearOfSite(const Vector3& p_WB) const {
  const Vector3 p_B_site = R_WB_.transpose() * (task_.X_WC.translation() - p_WB);
  return std::hypot(p_B_site.x(), p_B_site.y()) >= params_.clearance_m;
}

// Every configuration that belongs to one arm angle puts the links into the same places, so the factor is
// computed for one of them. If the links' centres of mass lie off the axes, the configurations differ
// slightly; Forces() accounts for that exactly.
BaseFigure BasePlacement::JudgeAt(const Pose& X_WB, double arm_angle_rad, const std::vector<Pose>& poses,
                                  double least) const {
  BaseFigure figure{.X_WB = X_WB, .arm_angle_rad = arm_angle_rad};
  const Pose X_BW = X_WB.inverse();
  const double turn = TurnOf(X_WB);
  double factor = poses.empty() ? 0.0 : HUGE_VAL;
  unsigned allowed = 0xff;  // bit c: configuration c has reached all poses so far
  for (const Pose& X_WT : poses) {
    const kinematics::LbrSolutions solutions = arm_.Solve(X_BW * X_WT * X_TF_, arm_angle_rad);
    if (!solutions.reachable()) return figure;
    for (unsigned c = 0; c < kinematics::LbrSolutions::kConfigurations; ++c) {
      const kinematics::LbrSolution& solution = solutions.configuration[c];
      if (!solution.valid() || std::abs(solution.q[3]) < params_.min_bend_rad ||
          std::abs(solution.q[5]) < params_.min_bend_rad)
        allowed &= ~(1u << c);
    }
    if (allowed == 0) return figure;
    const unsigned first = static_cast<unsigned>(std::countr_zero(allowed));
    const kinematics::JointVector& q = solutions.configuration[first].q;
    const ArmForce::ElbowAndWrist centers = force_.ElbowAndWristAt(q);
    const safety::WorkspaceParams& space = task_.workspace;
    for (const Vector3& p_B : {centers.p_B_elbow, centers.p_B_wrist})
      if (space.plane_normal_W.dot(X_WB * p_B) < space.plane_offset_m) return figure;
    factor = std::min(factor, force_.NeedFactor(q, turn));
    if (factor < least) return figure;
  }
  figure.configurations = allowed;
  figure.factor = factor;
  return figure;
}

BaseFigure BasePlacement::Judge(const Vector3& p_WB, double arm_angle_rad) const {
  if (!IsClearOfSite(p_WB)) return {.X_WB = Facing(p_WB), .arm_angle_rad = arm_angle_rad};
  return JudgeAt(Facing(p_WB), arm_angle_rad, TaskPoses(task_, {}, DirectionOf(task_, p_WB)), 0.0);
}

BaseFigure BasePlacement::Judge(const Vector3& p_WB) const {
  BaseFigure best{.X_WB = Facing(p_WB)};
  if (!IsClearOfSite(p_WB)) return best;
  const std::vector<Pose> poses = TaskPoses(task_, kCoarseTask, DirectionOf(task_, p_WB));
  for (int k = 0; k < params_.arm_angles; ++k) {
    const double angle = kTurn * (static_cast<double>(k) / params_.arm_angles - 0.5);
    const BaseFigure figure = JudgeAt(best.X_WB, angle, poses, best.factor);
    if (figure.configurations != 0 && figure.factor > best.factor) best = figure;
  }
  return best;
}

double BasePlacement::Score(const BaseFigure& figure) const {
  const double way_m = (figure.X_WB.translation() - params_.now_W_m).norm();
  return figure.factor * std::max(0.0, 1.0 - params_.moving_share_per_m * way_m);
}

std::optional<BaseFigure> BasePlacement::Best(const std::function<bool()>& stop) const {
  // Judge the grid in parallel. Each place writes its own element, so the result does not depend on the
  // threads.
  const std::size_t nx = Count(params_.x_m, params_.step_m), ny = Count(params_.y_m, params_.step_m),
                    nz = Count(params_.z_m, params_.step_m);
  std::vector<BaseFigure> grid(nx * ny * nz);
  simulation::ParallelFor(
      grid.size(), params_.threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !stop(); ++i)
          grid[i] = Judge({params_.x_m.from + static_cast<double>(i % nx) * params_.step_m,
                           params_.y_m.from + static_cast<double>(i / nx % ny) * params_.step_m,
                           params_.z_m.from + static_cast<double>(i / nx / ny) * params_.step_m});
      },
      64);
  std::vector<std::size_t> order(grid.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return Score(grid[a]) > Score(grid[b]); });
  order.resize(std::min(order.size(), static_cast<std::size_t>(params_.starts)));

  // Refine the best places by compass search: along one axis after the other, in steps that halve.
  std::vector<BaseFigure> refined(order.size());
  const auto within = [](const AxisRange& range, double value) {
    return std::clamp(value, range.from, range.to);
  };
  simulation::ParallelFor(
      order.size(), params_.threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const BaseFigure& start = grid[order[i]];
          if (start.configurations == 0) continue;
          BaseFigure best = Judge(start.X_WB.translation(), start.arm_angle_rad);
          double step_m = 0.5 * params_.step_m, step_rad = kFirstAngleStep;
          while (step_m >= params_.final_step_m && !stop()) {
            bool better = false;
            for (int axis = 0; axis < 4; ++axis)
              for (const double sign : {1.0, -1.0}) {
                Vector3 p_WB = best.X_WB.translation();
                double angle = best.arm_angle_rad;
                if (axis < 3)
                  p_WB[axis] += sign * step_m;
                else
                  angle = std::remainder(angle + sign * step_rad, kTurn);
                p_WB = {within(params_.x_m, p_WB.x()), within(params_.y_m, p_WB.y()),
                        within(params_.z_m, p_WB.z())};
                const BaseFigure figure = Judge(p_WB, angle);
                if (figure.configurations == 0 || !(Score(figure) > Score(best))) continue;
                best = figure;
                better = true;
              }
            if (better) continue;
            step_m *= 0.5;
            step_rad *= 0.5;
          }
          // Round the result as the file will state it.
          const Vector3 rounded = (1e3 * best.X_WB.translation()).array().round() * 1e-3;
          refined[i] = Judge(rounded, kDegree * std::round(best.arm_angle_rad / kDegree));
        }
      },
      1);
  const auto best =
      std::max_element(refined.begin(), refined.end(),
                       [this](const BaseFigure& a, const BaseFigure& b) { return Score(a) < Score(b); });
  if (best == refined.end() || best->configurations == 0) return std::nullopt;
  return *best;
}

BaseFigure BasePlacement::Centred(const BaseFigure& figure) const {
  const Pose X_BW = figure.X_WB.inverse();
  const double first_rad = DirectionOf(task_, figure.X_WB.translation());
  const auto solve = [&](const Pose& X_WT) { return arm_.Solve(X_BW * X_WT * X_TF_, figure.arm_angle_rad); };

  // Take the one of the base's configurations whose joints are nearest to zero at the task's start.
  const Pose X_WT_start = TiltCone(task_, task_.X_WC * Vector3(0.0, 0.0, task_.top_m), 0, 0.0).front();
  const kinematics::LbrSolutions start = solve(X_WT_start);
  std::size_t configuration = 0;
  double nearest = HUGE_VAL;
  for (std::size_t c = 0; c < kinematics::LbrSolutions::kConfigurations; ++c) {
    const double distance = start.configuration[c].q.squaredNorm();
    if ((figure.configurations & (1u << c)) == 0 || !(distance < nearest)) continue;
    nearest = distance;
    configuration = c;
  }

  // Find A1's range over the task, and turn the base by the distance from the middle of A1's limits to the
  // middle of this range.
  double min_q1 = HUGE_VAL, max_q1 = -HUGE_VAL;
  for (const Pose& X_WT : TaskPoses(task_, {}, first_rad)) {
    const double q1 = solve(X_WT).configuration[configuration].q[0];
    min_q1 = std::min(min_q1, q1);
    max_q1 = std::max(max_q1, q1);
  }
  const kinematics::JointLimits& limits = arm_.params().limits[0];
  const double middle = 0.5 * (min_q1 + max_q1) - 0.5 * (limits.lower_rad + limits.upper_rad);
  const double yaw = TurnOf(figure.X_WB) + middle;
  BaseFigure centred = figure;
  centred.configurations = 1u << configuration;
  centred.X_WB.linear() = R_WB_ * ExpRotation({0.0, 0.0, kDegree * std::round(yaw / kDegree)});
  return centred;
}

ToolForce BasePlacement::Forces(const BaseFigure& figure) const {
  ToolForce worst;
  const Pose X_BW = figure.X_WB.inverse();
  const double turn = TurnOf(figure.X_WB);
  const auto configuration = static_cast<std::size_t>(std::countr_zero(figure.configurations));
  for (const Pose& X_WT : TaskPoses(task_, {}, DirectionOf(task_, figure.X_WB.translation()))) {
    const kinematics::LbrSolutions solutions = arm_.Solve(X_BW * X_WT * X_TF_, figure.arm_angle_rad);
    worst.LowerTo(force_.ForceAt(solutions.configuration[configuration].q, turn));
  }
  return worst;
}

}  // namespace osteon::studies
