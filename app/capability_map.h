#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "app/arm_force.h"
#include "app/base_search.h"

// What the arm can give over the cell's workspace, from the base that it has.

namespace osteon::app {

/// Two planes through the site's centre.
enum class MapPlane : std::uint8_t {
  kVertical,    ///< through the base's axis and along W's z: to W's +x side, y up
  kHorizontal,  ///< W's x and y, at the site's height
};

/// Of the tilt cone with the head's centre at a node: the worst of its poses. NaN where a pose of the cone
/// has no posture.
struct MapPanel {
  MapPlane plane{};
  Vector3 origin_W{Vector3::Zero()}, u_W{Vector3::UnitX()}, v_W{Vector3::UnitY()};
  double u_from_m{0.0}, v_from_m{0.0}, step_m{0.0};
  int nu{0}, nv{0};
  std::vector<double> axial_N, lateral_N;          ///< each pose at its best arm angle
  std::vector<double> own_axial_N, own_lateral_N;  ///< at the cell's arm angle and configuration

  /// Where the node of element i lies, in W [m].
  [[nodiscard]] Vector3 Node(std::size_t i) const;
};

/// The cell's base and tool.
class CapabilityMap {
 public:
  CapabilityMap(const config::CellConfig& cell, const TaskVolume& task, const CapabilityNeed& need,
                int threads);

  /// Over the workspace's sphere, so many nodes across.
  [[nodiscard]] MapPanel Panel(MapPlane plane, int nodes, const std::function<bool()>& stop) const;

  /// The worst over the task, and how many of its poses have no posture.
  struct Task {
    ToolForce force;
    std::size_t poses{0}, unreachable{0};
  };
  [[nodiscard]] Task AtBestArmAngle() const;
  /// At the arm angle and the configuration that the cell's start has.
  [[nodiscard]] Task AtOwnArmAngle() const;

 private:
  /// Best by the factor of the need; nothing where the pose has no posture.
  [[nodiscard]] std::optional<ToolForce> Best(const Pose& X_WT) const;
  [[nodiscard]] std::optional<ToolForce> Own(const Pose& X_WT) const;

  kinematics::LbrArm arm_;  ///< its limits drawn in by the cell's margin
  ArmForce force_;
  Pose X_BW_, X_TF_;
  TaskVolume task_;
  double own_arm_angle_rad_;
  std::size_t own_configuration_;
  double first_rad_;  ///< where the tilts' directions begin
  int threads_;
};

}  // namespace osteon::app
