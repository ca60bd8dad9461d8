#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "studies/capability/arm_force.h"
#include "studies/capability/base_placement.h"

// The force capability of the arm over the cell's workspace, from its present base.

namespace osteon::studies {

/// Two section planes through the site's centre.
enum class MapPlane : std::uint8_t {
  kVertical,    ///< contains the base's axis; the panel's x points toward W's +x side, its y along W's z
  kHorizontal,  ///< W's x and y, at the site's height
};

/// Forces on a grid of one plane. The tool head's centre is at the node, and the node's value is the smallest
/// over the tilt cone; NaN if the arm has no posture for a pose of the cone.
struct MapPanel {
  MapPlane plane{};
  Vector3 origin_W{Vector3::Zero()}, u_W{Vector3::UnitX()}, v_W{Vector3::UnitY()};
  double u_from_m{0.0}, v_from_m{0.0}, step_m{0.0};
  int nu{0}, nv{0};
  std::vector<double> axial_N, lateral_N;          ///< with the best arm angle at each pose
  std::vector<double> own_axial_N, own_lateral_N;  ///< at the cell's arm angle and configuration

  /// Returns the position of element i's node, in W [m].
  [[nodiscard]] Vector3 Node(std::size_t i) const;
};

/// Computes the maps for the cell's base and tool.
class CapabilityMap {
 public:
  CapabilityMap(const config::CellConfig& cell, const TaskVolume& task, const CapabilityNeed& need,
                int threads);

  /// Maps the workspace's sphere with `nodes` nodes across.
  [[nodiscard]] MapPanel Panel(MapPlane plane, int nodes, const std::function<bool()>& stop) const;

  /// The smallest figures over the task, and the number of its poses that the arm has no posture for.
  struct Task {
    ToolForce force;
    std::size_t poses{0}, unreachable{0};
  };
  /// Evaluates the task, each pose at its best arm angle.
  [[nodiscard]] Task AtBestArmAngle() const;
  /// Evaluates the task at the arm angle and configuration of the cell's start.
  [[nodiscard]] Task AtOwnArmAngle() const;

 private:
  /// Returns the figures at the arm angle with the best factor of the need; nothing without a posture.
  [[nodiscard]] std::optional<ToolForce> Best(const Pose& X_WT) const;
  /// Returns the figures at the arm angle and configuration of the cell's start; nothing without a posture.
  [[nodiscard]] std::optional<ToolForce> Own(const Pose& X_WT) const;

  kinematics::LbrArm arm_;  ///< limits narrowed by the cell's margin
  ArmForce force_;
  Pose X_BW_, X_TF_;
  TaskVolume task_;
  double own_arm_angle_rad_;
  std::size_t own_configuration_;
  double first_rad_;  ///< azimuth of the first tilt
  int threads_;
};

}  // namespace osteon::studies
