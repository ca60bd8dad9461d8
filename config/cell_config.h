#pragma once

#include <cstdint>
#include <string>

#include "control/servo_loop.h"
#include "kinematics/lbr_arm.h"
#include "simulation/cutting_engine.h"
#include "simulation/scenes.h"
#include "simulation/tool.h"

// What the files under config/ say, in SI: the parameters of the libraries, filled in, and what has no
// library's type. Plain data; the accepted ranges are in the loaders (load.h).

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

struct FriConfig {
  std::string host;  ///< dotted IPv4 to listen on
  std::uint16_t port{0};
  double period_s{0.0};
};

/// The simulated operator: an arm that holds the tool, and what it is told to do.
struct OperatorConfig {
  double stiffness_N_per_m{0.0}, damping_Ns_per_m{0.0}, mass_kg{0.0};
  double stiffness_Nm_per_rad{0.0}, damping_Nms_per_rad{0.0}, inertia_kg_m2{0.0};
  double max_force_N{0.0}, max_torque_Nm{0.0};  ///< what the hand can do at all
  double push_force_N{0.0}, approach_force_N{0.0};
  double tilt_rad{0.0}, whirl_period_s{0.0};  ///< of the whirlwind about the cup's axis
  double retract_height_m{0.0};  ///< of the head's centre above the cup's, along the cup's axis, at the end
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
  simulation::AcetabulumParams scene;  ///< with the cell's materials
  Pose X_WB{Pose::Identity()};         ///< robot base in world
  Pose X_WG{Pose::Identity()};         ///< bone in world
  StartConfig start;
  control::ServoParams servo;         ///< with the robot's limits and the tool's spindle speed
  simulation::CuttingParams cutting;  ///< with the coupling's stiffness and the cell's force limit
  FriConfig fri;
  OperatorConfig hand;
  SimulatedArmConfig simulated_arm;
};

}  // namespace osteon::config
