#include <fmt/format.h>

#include "config/load.h"
#include "config/read_pose.h"

namespace osteon::config {
namespace {

StartConfig ReadStart(Reader section) {
  StartConfig start;
  start.X_WT = ReadPose(section.Section("tool_in_world"));
  start.arm_angle_rad = section.Number("arm_angle_deg", -180, 180);
  return start;
}

LimitsConfig ReadLimits(Reader section) {
  LimitsConfig limits;
  limits.max_force_N = section.Number("max_force_N", 1, 200);
  limits.max_torque_Nm = section.Number("max_torque_Nm", 0.1, 50);
  limits.sensor_margin_N = section.Number("sensor_margin_N", 1, 200);
  limits.sensor_trip_ticks = section.Whole("sensor_trip_count", 1, 100);
  limits.max_tool_speed_m_per_s = section.Number("max_tool_speed_mm_per_s", 1, 1000);
  limits.max_tool_turn_rad_per_s = section.Number("max_tool_turn_deg_per_s", 1, 360);
  limits.stop_deceleration_m_per_s2 = section.Number("stop_deceleration_mm_per_s2", 100, 20000);
  limits.joint_margin_rad = section.Number("joint_margin_deg", 0, 30);
  limits.joint_speed_share = section.Number("joint_speed_ratio", 0.01, 1);
  limits.joint_jump_rad = section.Number("joint_jump_deg", 0.1, 30);
  limits.max_tracking_error_m = section.Number("max_tracking_error_mm", 1, 200);
  return limits;
}

WorkspaceConfig ReadWorkspace(Reader section) {
  WorkspaceConfig workspace;
  workspace.sphere_center_W_m = section.Triple("sphere_center_mm", -5000, 5000);
  workspace.sphere_radius_m = section.Number("sphere_radius_mm", 10, 2000);
  workspace.plane_normal_W = section.Direction("plane_normal_axis");
  workspace.plane_offset_m = section.Number("plane_offset_mm", -5000, 5000);
  return workspace;
}

AdmittanceConfig ReadAdmittance(Reader section) {
  AdmittanceConfig admittance;
  admittance.mass_kg = section.Number("mass_kg", 0.1, 50);
  admittance.inertia_kg_m2 = section.Number("inertia_kg_m2", 0.001, 5);
  admittance.damping_Ns_per_m = section.Number("damping_Ns_per_m", 1, 2000);
  admittance.rotational_damping_Nms_per_rad = section.Number("rotational_damping_Nms_per_rad", 0.01, 100);
  return admittance;
}

// stiffness and force limit follow from the coupling and the cell
simulation::CuttingParams ReadCutting(Reader section) {
  simulation::CuttingParams cutting;
  cutting.law = section.Choice("law", {"rate", "immediate"}) == 0 ? simulation::RemovalLaw::kRate
                                                                  : simulation::RemovalLaw::kImmediate;
  cutting.normal_enlargement_m = section.Number("normal_enlargement_um", 1, 5000);
  cutting.contact_margin_m = section.Number("contact_margin_mm", 0.01, 10);
  cutting.contact_tolerance_m = section.Number("contact_tolerance_um", 0.1, 500);
  cutting.engaged_layer_m = section.Number("engaged_layer_mm", 0.05, 5);
  return cutting;
}

FriConfig ReadFri(Reader section) {
  FriConfig fri;
  fri.host = section.Text("host");
  fri.port = static_cast<std::uint16_t>(section.Whole("port", 1024, 65535));
  fri.period_s = section.Number("period_ms", 1, 100);
  return fri;
}

OperatorConfig ReadOperator(Reader section) {
  OperatorConfig hand;
  hand.stiffness_N_per_m = section.Number("hand_stiffness_N_per_m", 50, 50000);
  hand.damping_Ns_per_m = section.Number("hand_damping_Ns_per_m", 0, 1000);
  hand.mass_kg = section.Number("hand_mass_kg", 0, 10);
  hand.rotational_stiffness_Nm_per_rad = section.Number("rotational_stiffness_Nm_per_rad", 0.1, 1000);
  hand.rotational_damping_Nms_per_rad = section.Number("rotational_damping_Nms_per_rad", 0, 100);
  hand.push_force_N = section.Number("push_force_N", 0, 400);
  hand.tilt_rad = section.Number("tilt_deg", 0, 45);
  hand.tilt_rate_hz = section.Number("tilt_rate_hz", 0, 5);
  return hand;
}

SimulatedArmConfig ReadSimulatedArm(Reader section) {
  SimulatedArmConfig arm;
  arm.bandwidth_hz = section.Number("bandwidth_hz", 0.5, 200);
  arm.damping_ratio = section.Number("damping_ratio", 0.1, 5);
  arm.dead_time_s = section.Number("dead_time_ms", 0, 30);
  return arm;
}

// The age from which a value fades must come before the age at which it stops the cell.
void CheckOrder(const Reader& section, const std::string& full, const std::string& stop, double full_s,
                double stop_s) {
  if (full_s < stop_s) return;
  section.Refuse(
      stop, fmt::format("found {:.10g}, accepted more than {} ({:.10g})", stop_s * 1e3, full, full_s * 1e3));
}

}  // namespace

CellConfig LoadCell(const std::filesystem::path& path) {
  Reader reader = Reader::Load(path);
  CellConfig cell;
  const std::filesystem::path robot = reader.File("robot"), tool = reader.File("tool"),
                              scene = reader.File("scene"), materials = reader.File("materials");
  cell.X_WB = ReadPose(reader.Section("base_in_world"));
  cell.X_WG = ReadPose(reader.Section("bone_in_world"));
  Reader start = reader.Section("start");
  cell.start = ReadStart(start);
  cell.limits = ReadLimits(reader.Section("limits"));
  cell.workspace = ReadWorkspace(reader.Section("workspace"));

  Reader watchdog = reader.Section("watchdog");
  cell.watchdog.model_full_s = watchdog.Number("model_full_ms", 1, 1000);
  cell.watchdog.model_stop_s = watchdog.Number("model_stop_ms", 1, 1000);
  cell.watchdog.sensor_full_s = watchdog.Number("sensor_full_ms", 1, 1000);
  cell.watchdog.sensor_stop_s = watchdog.Number("sensor_stop_ms", 1, 1000);
  cell.watchdog.arm_misses = watchdog.Whole("arm_miss_count", 1, 100);

  cell.admittance = ReadAdmittance(reader.Section("admittance"));
  Reader coupling = reader.Section("coupling");
  cell.coupling.stiffness_N_per_m = coupling.Number("stiffness_N_per_mm", 0.1, 100);
  cell.coupling.damping_Ns_per_m = coupling.Number("damping_Ns_per_m", 0, 2000);
  cell.cutting = ReadCutting(reader.Section("cutting"));
  cell.cutting.stiffness_N_per_m = cell.coupling.stiffness_N_per_m;
  cell.cutting.max_force_N = cell.limits.max_force_N;
  cell.fri = ReadFri(reader.Section("fri"));
  cell.hand = ReadOperator(reader.Section("operator"));
  cell.simulated_arm = ReadSimulatedArm(reader.Section("simulated_arm"));
  reader.Finish();

  CheckOrder(watchdog, "model_full_ms", "model_stop_ms", cell.watchdog.model_full_s,
             cell.watchdog.model_stop_s);
  CheckOrder(watchdog, "sensor_full_ms", "sensor_stop_ms", cell.watchdog.sensor_full_s,
             cell.watchdog.sensor_stop_s);
  cell.robot = LoadRobot(robot);
  cell.tool = LoadTool(tool);
  cell.scene = LoadScene(scene);
  cell.materials = LoadMaterials(materials);

  // the start must be where the cell may be
  const Vector3 apex = cell.start.X_WT.translation();
  if ((apex - cell.workspace.sphere_center_W_m).norm() > cell.workspace.sphere_radius_m ||
      cell.workspace.plane_normal_W.dot(apex) < cell.workspace.plane_offset_m)
    start.Refuse("tool_in_world", "the apex is outside the workspace");
  const kinematics::LbrArm arm(cell.robot);
  const Pose X_BF = cell.X_WB.inverse() * cell.start.X_WT * cell.tool.X_FT.inverse();
  if (!arm.Inverse(X_BF, cell.start.arm_angle_rad, kinematics::JointVector::Zero(), cell.start.q))
    start.Refuse("tool_in_world", "the arm can not be there: out of reach or beyond its joint limits");
  return cell;
}

}  // namespace osteon::config
