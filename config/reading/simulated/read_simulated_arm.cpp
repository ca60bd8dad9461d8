#include "config/reading/simulated/read_simulated_arm.h"

#include <algorithm>
#include <cmath>

#include "config/reading/sections/read_arm_link.h"

namespace osteon::config {
namespace {

// Reads the flexible mount under the arm's base.
void ReadMount(Reader section, hil::FlexibleMountParams& mount) {
  mount.stiffness_N_per_m = section.Number("stiffness_N_per_m", 1e4, 1e9);
  mount.stiffness_Nm_per_rad = section.Number("stiffness_Nm_per_rad", 1e3, 1e8);
  mount.damping_ratio = section.Number("damping_ratio", 0, 2);
  mount.mass_kg = section.Number("mass_kg", 1, 5000);
  mount.inertia_kg_m2 = section.Number("inertia_kg_m2", 0.01, 1000);
}

// Reads section `dynamic`. Friction is stated as a share of the robot's torque limits, which are not known
// yet: `kept` stores the shares.
void ReadDynamicArm(Reader section, hil::DynamicArmParams& arm, SimulatedArmSection& kept) {
  arm.mass_error = section.Number("mass_error_ratio", -0.5, 0.5);
  kept.coulomb_share = section.Number("coulomb_ratio", 0, 0.2);
  kept.viscous_share = section.Number("viscous_ratio", 0, 0.5);
  arm.friction_compensation = section.Number("friction_compensation_ratio", 0, 1);
  arm.stiffness_Nm_per_rad.setConstant(section.Number("joint_stiffness_Nm_per_rad", 0, 1e4));
  arm.stiffness_N_per_m = section.Number("stiffness_N_per_m", 0, 1e4);
  arm.stiffness_Nm_per_rad_turn = section.Number("stiffness_Nm_per_rad", 0, 1e3);
  arm.joint_damping_ratio = section.Number("damping_ratio", 0, 2);
  arm.cartesian_damping_ratio = arm.joint_damping_ratio;
  arm.substeps = section.WholeNumber("substep_count", 1, 1000);
  if (section.Has("mount")) ReadMount(section.Section("mount"), arm.mount.emplace());
}

// Reads the keys of a KUKA controller with RSI, and of the operator at its smartPAD.
void ReadRsiArm(Reader& section, io::RsiCorrection kind, hil::RsiArmParams& arm) {
  arm.controller.range = ReadCorrectionRange(section, "monitor", kind);
  if (section.Has("delay_in_a_row")) arm.controller.delay_in_a_row = section.Bool("delay_in_a_row");
  if (section.Has("ask_again")) arm.start_again_after_loss = section.Bool("ask_again");
  if (section.Has("start_again_s")) arm.start_again_s = section.Number("start_again_s", 0, 60);
}

}  // namespace

SimulatedArmSection ReadSimulatedArm(Reader section, CellConfig& cell) {
  SimulatedArmSection kept{.section = section};
  hil::SimulatedCellParams& arm = cell.simulated;
  kept.level = static_cast<hil::ArmLevel>(section.Choice("level", {"kinematic", "servo", "dynamic"}));
  hil::ServoArmParams servo;
  servo.bandwidth_hz = section.Number("bandwidth_hz", 0.5, 200);
  servo.damping_ratio = section.Number("damping_ratio", 0.1, 5);
  servo.dead_cycles = section.Number("dead_time_ms", 0, 30) / cell.servo.period_s;
  // The division leaves a rounding error. Round a number that is almost whole.
  if (const double whole = std::round(servo.dead_cycles); std::abs(servo.dead_cycles - whole) < 1e-9)
    servo.dead_cycles = whole;
  if (section.Has("start_offset_deg")) {
    const std::vector<double> offset_rad =
        section.Numbers("start_offset_deg", arm.kr ? 6 : control::kJoints, -90, 90);
    std::copy(offset_rad.begin(), offset_rad.end(), arm.q_start.begin());
  }
  arm.servo = servo;
  if (arm.kr) {
    arm.kr->controller.servo = servo;
    ReadRsiArm(section, cell.link.rsi()->kind, *arm.kr);
    return kept;
  }
  if (section.Has("sensor_feels_inertia")) {
    arm.sensor_feels_inertia = section.Bool("sensor_feels_inertia");
    if (arm.sensor_feels_inertia && kept.level == hil::ArmLevel::kKinematic)
      section.Refuse(
          "sensor_feels_inertia",
          "found true with the level kinematic, accepted with servo or dynamic: an arm that jumps to "
          "its commands has no acceleration");
  }
  arm.level = kept.level;
  arm.dynamic.bandwidth_hz = servo.bandwidth_hz;
  arm.dynamic.damping_ratio = servo.damping_ratio;
  arm.dynamic.dead_cycles = static_cast<int>(std::lround(servo.dead_cycles));
  if (kept.level == hil::ArmLevel::kDynamic || section.Has("dynamic"))
    ReadDynamicArm(section.Section("dynamic"), arm.dynamic, kept);
  return kept;
}

void CompleteSimulatedArm(const SimulatedArmSection& section, CellConfig& cell) {
  const bool dynamic = section.level == hil::ArmLevel::kDynamic;
  const auto refuse_dynamic = [&](const char* why) {
    section.section.Refuse("level", std::string("found dynamic, accepted kinematic or servo: ") + why);
  };
  const LbrConfig* lbr = cell.robot.lbr();
  if (!lbr) {
    if (dynamic) refuse_dynamic("no masses and torques of an arm of six axes are published");
    cell.simulated.kr->controller.level = section.level;
    return;
  }
  if (cell.servo.law == control::Law::kImpedance && !dynamic)
    section.section.Refuse("level", "found an arm without masses, accepted dynamic: impedance moves them");
  cell.simulated.arm = lbr->params;
  cell.simulated.chain = lbr->chain;
  for (kinematics::RevoluteJoint& joint : cell.simulated.chain.joints) {
    const kinematics::JointLimits& limits = joint.limits;
    joint.friction.coulomb_Nm += section.coulomb_share * limits.torque_Nm;
    joint.friction.viscous_Nms_per_rad +=
        section.viscous_share * limits.torque_Nm / limits.velocity_rad_per_s;
    if (dynamic && !(lbr->chain.has_masses && limits.torque_Nm > 0.0))
      refuse_dynamic("the robot's file has no masses or no torques");
  }
}

}  // namespace osteon::config
