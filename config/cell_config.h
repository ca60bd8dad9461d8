#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/scene_config.h"
#include "kinematics/lbr_arm.h"
#include "simulation/cutting_engine.h"
#include "simulation/material.h"
#include "simulation/tool.h"

// What the files under config/ say, in SI. Plain data; the accepted ranges are in the loaders (load.h).

namespace osteon::config {

struct ToolConfig {
  simulation::Tool tool;
  Pose X_FT{Pose::Identity()};  ///< tool in the flange's frame
  double spindle_rad_per_s{0.0};
};

/// Where the arm begins.
struct StartConfig {
  Pose X_WT{Pose::Identity()};
  double arm_angle_rad{0.0};
  /// The same as joints [rad]: of the arm's solutions the nearest to zero.
  kinematics::JointVector q{kinematics::JointVector::Zero()};
};

struct LimitsConfig {
  double max_force_N{0.0};  ///< of the coupling wrench
  double max_torque_Nm{0.0};
  double sensor_margin_N{0.0};  ///< trip of the hand's force, above max_force_N
  int sensor_trip_ticks{0};     ///< in a row
  double max_tool_speed_m_per_s{0.0};
  double max_tool_turn_rad_per_s{0.0};
  double stop_deceleration_m_per_s2{0.0};
  double joint_margin_rad{0.0};
  double joint_speed_share{0.0};
  double joint_jump_rad{0.0};
  double max_tracking_error_m{0.0};
};

/// Bounds of the tool's apex, in W.
struct WorkspaceConfig {
  Vector3 sphere_center_W_m{Vector3::Zero()};
  double sphere_radius_m{0.0};
  Vector3 plane_normal_W{Vector3::UnitZ()};  ///< unit
  double plane_offset_m{0.0};                ///< keep in: normal·p >= offset
};

struct WatchdogConfig {
  double model_full_s{0.0}, model_stop_s{0.0};
  double sensor_full_s{0.0}, sensor_stop_s{0.0};
  int arm_misses{0};
};

/// The virtual tool.
struct AdmittanceConfig {
  double mass_kg{0.0};
  double inertia_kg_m2{0.0};
  double damping_Ns_per_m{0.0};
  double rotational_damping_Nms_per_rad{0.0};
};

struct CouplingConfig {
  double stiffness_N_per_m{0.0};
  double damping_Ns_per_m{0.0};
};

struct FriConfig {
  std::string host;
  std::uint16_t port{0};
  double period_s{0.0};
};

/// The simulated operator.
struct OperatorConfig {
  double stiffness_N_per_m{0.0}, damping_Ns_per_m{0.0}, mass_kg{0.0};
  double rotational_stiffness_Nm_per_rad{0.0}, rotational_damping_Nms_per_rad{0.0};
  double push_force_N{0.0};
  double tilt_rad{0.0}, tilt_rate_hz{0.0};
};

/// The servo of the simulated arm.
struct SimulatedArmConfig {
  double bandwidth_hz{0.0};
  double damping_ratio{0.0};
  double dead_time_s{0.0};
};

/// A cell, with the files it names already read.
struct CellConfig {
  kinematics::LbrParams robot;
  ToolConfig tool;
  SceneConfig scene;
  std::vector<simulation::Material> materials;
  Pose X_WB{Pose::Identity()}, X_WG{Pose::Identity()};
  StartConfig start;
  LimitsConfig limits;
  WorkspaceConfig workspace;
  WatchdogConfig watchdog;
  AdmittanceConfig admittance;
  CouplingConfig coupling;
  simulation::CuttingParams cutting;  ///< stiffness and force limit as the coupling's and the cell's
  FriConfig fri;
  OperatorConfig hand;
  SimulatedArmConfig simulated_arm;
};

}  // namespace osteon::config
