#include "studies/capability/capability_task.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <variant>

#include <fmt/format.h>

namespace osteon::studies {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// The depth at which the hand pushes with its full force, for a reaming script. The hand's goals in the
// script lie deeper, since the hand pulls the tool toward them by a spring.
std::optional<double> FullForceDepth(const hil::ScriptParams& script) {
  return std::visit(
      [](const auto& params) -> std::optional<double> {
        if constexpr (std::is_same_v<std::decay_t<decltype(params)>, hil::ReamingScriptParams>)
          return params.full_force_depth_m;
        else
          return std::nullopt;
      },
      script);
}

}  // namespace

TaskVolume TaskOf(const config::CellConfig& cell, const std::optional<double>& radius_m) {
  const hil::HandScript script = hil::MakeScript(cell.script);
  TaskVolume task{.X_WC = cell.X_WG,
                  .bottom_m = script.start().height_m,
                  .top_m = script.start().height_m,
                  .head_radius_m = script.head_radius_m(),
                  .tool_yaw_rad = cell.start.tool_yaw_rad,
                  .workspace = cell.servo.workspace};
  double swing_m = script.start().swing_m;
  for (const hil::HandPhase& phase : script.phases()) {
    task.bottom_m = std::min(task.bottom_m, phase.end.height_m);
    task.top_m = std::max(task.top_m, phase.end.height_m);
    task.tilt_rad = std::max(task.tilt_rad, phase.end.tilt_rad);
    swing_m = std::max(swing_m, phase.end.swing_m);
  }
  if (const auto depth_m = FullForceDepth(cell.script)) task.bottom_m = std::max(task.bottom_m, -*depth_m);
  task.radius_m = radius_m.value_or(task.head_radius_m + swing_m);
  return task;
}

CapabilityNeed NeedOf(const config::CellConfig& cell) {
  return {.axial_N = std::min(cell.servo.wrench.max_force_N, safety::kForceCeiling_N),
          .lateral_N = cell.servo.posture_load.lateral_N,
          .lateral_from = "the cell's posture: lateral_force_N"};
}

double DirectionOf(const TaskVolume& task, const Vector3& p_WB) {
  const Vector3 p_C = task.X_WC.inverse() * p_WB;
  return std::atan2(p_C.y(), p_C.x());
}

std::vector<Pose> TiltCone(const TaskVolume& task, const Vector3& p_W_head, int azimuths, double first_rad) {
  const Matrix3 R_CT = ExpRotation({std::numbers::pi, 0.0, 0.0}) * ExpRotation({0.0, 0.0, task.tool_yaw_rad});
  const Matrix3 R_WC = task.X_WC.linear();
  // The tool's pose, tilted by `tilt` toward the azimuth.
  const auto pose = [&](double tilt, double azimuth) {
    Pose X_WT = Pose::Identity();
    const Vector3 turn_C(-std::sin(azimuth), std::cos(azimuth), 0.0);
    X_WT.linear() = R_WC * R_CT * ExpRotation(tilt * (R_CT.transpose() * turn_C));
    X_WT.translation() = p_W_head + task.head_radius_m * X_WT.linear().col(2);
    return X_WT;
  };
  std::vector<Pose> poses{pose(0.0, 0.0)};
  if (task.tilt_rad > 0.0)
    for (int k = 0; k < azimuths; ++k) poses.push_back(pose(task.tilt_rad, first_rad + kTurn * k / azimuths));
  return poses;
}

int SampledPoses(const TaskVolume& task, const TaskFineness& fineness) {
  const int places = fineness.heights * (task.radius_m > 0.0 ? 1 + fineness.around : 1);
  return places * (task.tilt_rad > 0.0 ? 1 + fineness.azimuths : 1);
}

std::vector<Pose> TaskPoses(const TaskVolume& task, const TaskFineness& fineness, double first_rad) {
  std::vector<Pose> poses;
  const safety::Workspace workspace(task.workspace);
  const auto add = [&](const Vector3& p_C) {
    for (const Pose& X_WT : TiltCone(task, task.X_WC * p_C, fineness.azimuths, first_rad))
      if (workspace.Distance(X_WT.translation()) >= 0.0) poses.push_back(X_WT);
  };
  for (int h = 0; h < fineness.heights; ++h) {
    const double height_m =
        std::lerp(task.bottom_m, task.top_m, static_cast<double>(h) / (fineness.heights - 1));
    add({0.0, 0.0, height_m});
    for (int k = 0; task.radius_m > 0.0 && k < fineness.around; ++k) {
      const double angle = first_rad + kTurn * k / fineness.around;
      add({task.radius_m * std::cos(angle), task.radius_m * std::sin(angle), height_m});
    }
  }
  return poses;
}

}  // namespace osteon::studies
