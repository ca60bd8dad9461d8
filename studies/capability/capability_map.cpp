#include "studies/capability/capability_map.h"

#include <cmath>

#include "base/parallel.h"
#include "kinematics/best_arm_angle.h"

namespace osteon::studies {
namespace {

constexpr double kMargin = 1.04;  // size of a map over that of the workspace

}  // namespace

Vector3 MapPanel::Node(std::size_t i) const {
  const auto column = static_cast<double>(i % static_cast<std::size_t>(nu));
  const auto row = static_cast<double>(i / static_cast<std::size_t>(nu));
  return origin_W + (u_from_m + column * step_m) * u_W + (v_from_m + row * step_m) * v_W;
}

CapabilityMap::CapabilityMap(const config::CellConfig& cell, const TaskVolume& task,
                             const CapabilityNeed& need, int threads)
    : arm_(WithNarrowedLimits(cell.robot.lbr()->params, cell.servo.joints.position_margin_rad)),
      force_(cell.robot.lbr()->chain, cell.X_WB.linear(), cell.tool.X_FT, need),
      X_BW_(cell.X_WB.inverse()),
      X_TF_(cell.tool.X_FT.inverse()),
      task_(task),
      own_arm_angle_rad_(cell.start.arm_angle_rad),
      own_configuration_(static_cast<std::size_t>(kinematics::LbrArm::Configuration(cell.start.q))),
      first_rad_(DirectionOf(task, cell.X_WB.translation())),
      threads_(threads) {}

std::optional<ToolForce> CapabilityMap::Best(const Pose& X_WT) const {
  const kinematics::BestArmAngle best = kinematics::FindBestArmAngle(
      arm_, X_BW_ * X_WT * X_TF_, [this](const kinematics::JointVector& q) { return force_.NeedFactor(q); });
  if (!best.found) return std::nullopt;
  return force_.ForceAt(best.q);
}

std::optional<ToolForce> CapabilityMap::Own(const Pose& X_WT) const {
  const kinematics::LbrSolutions solutions = arm_.Solve(X_BW_ * X_WT * X_TF_, own_arm_angle_rad_);
  const kinematics::LbrSolution& solution = solutions.configuration[own_configuration_];
  if (!solutions.reachable() || !solution.valid()) return std::nullopt;
  return force_.ForceAt(solution.q);
}

CapabilityMap::Task CapabilityMap::AtBestArmAngle() const {
  const std::vector<Pose> poses = TaskPoses(task_, {}, first_rad_);
  std::vector<std::optional<ToolForce>> forces(poses.size());
  simulation::ParallelFor(
      poses.size(), threads_,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) forces[i] = Best(poses[i]);
      },
      16);
  Task task{.force = {}, .poses = poses.size(), .unreachable = 0};
  for (const std::optional<ToolForce>& force : forces) {
    if (force)
      task.force.LowerTo(*force);
    else
      ++task.unreachable;
  }
  return task;
}

CapabilityMap::Task CapabilityMap::AtOwnArmAngle() const {
  Task task;
  for (const Pose& X_WT : TaskPoses(task_, {}, first_rad_)) {
    ++task.poses;
    if (const auto force = Own(X_WT))
      task.force.LowerTo(*force);
    else
      ++task.unreachable;
  }
  return task;
}

MapPanel CapabilityMap::Panel(MapPlane plane, int nodes, const std::function<bool()>& stop) const {
  const safety::WorkspaceParams& space = task_.workspace;
  MapPanel panel;
  panel.plane = plane;
  panel.origin_W = task_.X_WC.translation();
  if (plane == MapPlane::kVertical) {
    const Vector3 base_W = X_BW_.inverse().translation();
    Vector3 out = task_.X_WC.translation() - base_W;
    out.z() = 0.0;
    if (out.x() < 0.0) out = -out;  // left and right as in the horizontal section
    panel.u_W = out.norm() > 1e-9 ? out.normalized() : Vector3::UnitX();
    panel.v_W = Vector3::UnitZ();
  }
  // The panel is a square around the workspace's sphere, shifted from the apex to the head's centre. Its
  // nodes are at whole steps from the site's centre.
  const Vector3 p_apex_head = task_.head_radius_m * task_.X_WC.linear().col(2);
  const Vector3 center = space.sphere_center_W_m + p_apex_head - panel.origin_W;
  const double u = center.dot(panel.u_W), v = center.dot(panel.v_W), r = kMargin * space.sphere_radius_m;
  panel.step_m = 2.0 * r / (nodes - 1);
  panel.u_from_m = panel.step_m * std::floor((u - r) / panel.step_m);
  panel.v_from_m = panel.step_m * std::floor((v - r) / panel.step_m);
  panel.nu = panel.nv = nodes + 1;
  const auto count = static_cast<std::size_t>(panel.nu) * static_cast<std::size_t>(panel.nv);
  for (std::vector<double>* values :
       {&panel.axial_N, &panel.lateral_N, &panel.own_axial_N, &panel.own_lateral_N})
    values->assign(count, std::nan(""));

  // Keep the smallest value over the tilt cone; NaN if a pose of the cone has no posture.
  const auto worst = [&](const std::vector<Pose>& cone, const auto& force_of, double& axial,
                         double& lateral) {
    ToolForce force;
    for (const Pose& X_WT : cone) {
      const std::optional<ToolForce> at = force_of(X_WT);
      if (!at) return;
      force.LowerTo(*at);
    }
    axial = force.axial_N;
    lateral = force.lateral_N;
  };
  simulation::ParallelFor(
      count, threads_,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !stop(); ++i) {
          const std::vector<Pose> cone = TiltCone(task_, panel.Node(i), TaskFineness{}.azimuths, first_rad_);
          worst(
              cone, [this](const Pose& X) { return Best(X); }, panel.axial_N[i], panel.lateral_N[i]);
          worst(
              cone, [this](const Pose& X) { return Own(X); }, panel.own_axial_N[i], panel.own_lateral_N[i]);
        }
      },
      16);
  return panel;
}

}  // namespace osteon::studies
