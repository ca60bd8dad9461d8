#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "config/check_registration.h"
#include "config/load.h"
#include "config/load_robot.h"
#include "config/read_devices.h"
#include "config/read_injections.h"
#include "config/read_operator.h"
#include "config/read_pose.h"
#include "config/read_script.h"
#include "kinematics/payload.h"

namespace osteon::config {
namespace {

void ReadStart(Reader section, StartConfig& start) {
  start.height_m = section.Number("height_mm", 0, 500);
  start.tool_yaw_rad = section.Number("tool_yaw_deg", -360, 360);
  start.arm_angle_rad = section.Number("arm_angle_deg", -180, 180);
  start.path.speed_share = section.Number("speed_ratio", 0.01, 1);
  start.path.acceleration_share = section.Number("acceleration_ratio", 0.01, 1);
  start.path.tool_speed_m_per_s =
      section.Number("tool_speed_mm_per_s", 1, 1e3 * control::kReducedSpeed_m_per_s);
  start.path.pause_s = section.Number("pause_ms", 50, 5000);
}

void ReadLimits(Reader section, control::ServoParams& servo) {
  servo.wrench.max_force_N = section.Number("max_force_N", 1, safety::kForceCeiling_N);
  servo.wrench.max_torque_Nm = section.Number("max_torque_Nm", 0.1, 50);
  servo.sensor_force.margin_N = section.Number("sensor_margin_N", 1, 200);
  servo.sensor_force.ticks = section.Whole("sensor_trip_count", 1, 100);
  servo.twist.max_speed_m_per_s = section.Number("max_tool_speed_mm_per_s", 1, 1000);
  servo.twist.max_turn_rad_per_s = section.Number("max_tool_turn_deg_per_s", 1, 360);
  servo.stop_deceleration_m_per_s2 = section.Number("stop_deceleration_mm_per_s2", 100, 20000);
  servo.stop_deceleration_rad_per_s2 = section.Number("stop_deceleration_rad_per_s2", 0.5, 100);
  servo.joint_stop_s = section.Number("joint_stop_ms", 10, 1000);
  servo.joints.position_margin_rad = section.Number("joint_margin_deg", 0, 30);
  servo.joints.speed_share = section.Number("joint_speed_ratio", 0.01, 1);
  servo.joints.jump_rad = section.Number("joint_jump_deg", 0.1, 30);
  servo.max_tracking_error_m = section.Number("max_tracking_error_mm", 1, 200);
  servo.arm_angle_rate_rad_per_s = section.Number("arm_angle_rate_deg_per_s", 0.1, 57);
  servo.model_sight_m = section.Number("model_sight_mm", 0.01, 100);
}

void ReadPosture(Reader section, control::ServoParams& servo) {
  kinematics::PosturePreferenceParams& posture = servo.posture;
  posture.limit_zone_rad = section.Number("limit_zone_deg", 0.1, 120);
  posture.limit_speed_rad_per_s = section.Number("limit_deg_per_s", 0, 100);
  posture.singular_zone_m = section.Number("singular_zone_mm", 1, 500);
  posture.singular_speed_rad_per_s = section.Number("singular_deg_per_s", 0, 100);
  servo.posture_load.lateral_N = section.Number("lateral_force_N", 0, safety::kForceCeiling_N);
  posture.load_zone = section.Number("load_zone_ratio", 1.05, 5);
  posture.load_speed_rad_per_s = section.Number("load_deg_per_s", 0, 100);
  servo.joint_acceleration_share = section.Number("joint_acceleration_ratio", 0.1, 100);
}

void ReadWorkspace(Reader section, safety::WorkspaceParams& workspace) {
  workspace.sphere_center_W_m = section.Triple("sphere_center_mm", -5000, 5000);
  workspace.sphere_radius_m = section.Number("sphere_radius_mm", 10, 2000);
  workspace.plane_normal_W = section.Direction("plane_normal_axis");
  workspace.plane_offset_m = section.Number("plane_offset_mm", -5000, 5000);
}

void ReadWatchdog(Reader section, safety::WatchdogParams& watchdog) {
  watchdog.model_stop_s = section.Number("model_stop_ms", 1, 1000);
  watchdog.sensor_full_s = section.Number("sensor_full_ms", 1, 1000);
  watchdog.sensor_stop_s = section.Number("sensor_stop_ms", 1, 1000);
  watchdog.arm_misses = section.Whole("arm_miss_count", 1, 100);
}

void ReadAdmittance(Reader section, control::AdmittanceParams& admittance) {
  admittance.mass_kg = section.Triple("mass_kg", 0.1, 50);
  admittance.inertia_kg_m2 = section.Triple("inertia_kg_m2", 0.001, 5);
  admittance.damping_Ns_per_m = section.Triple("damping_Ns_per_m", 1, 2000);
  admittance.damping_Nms_per_rad = section.Triple("damping_Nms_per_rad", 0.01, 100);
  admittance.dead_zone_N = section.Number("dead_zone_N", 0, 50);
  admittance.dead_zone_Nm = section.Number("dead_zone_Nm", 0, 5);
}

void ReadVibration(Reader section, control::VibrationParams& vibration) {
  vibration.acts = section.Bool("acts");
  vibration.low_hz = section.Number("low_hz", 2, 20);
  vibration.high_hz = section.Number("high_hz", 21, 200);
  vibration.floor_N = section.Number("floor_N", 0.01, 20);
  vibration.alert_index = section.Number("alert_ratio", 0, 1);
  vibration.rise_s = section.Number("rise_ms", 1, 1000);
  vibration.decay_ratio = section.Number("decay_ratio", 1, 1000);
  vibration.most_damping = section.Number("damping_ratio", 1, 1000);
  vibration.most_mass = section.Number("mass_ratio", 1, 100);
  vibration.notch_hz = section.Number("notch_hz", 0, 20);
}

void ReadSensorBias(Reader section, control::BiasParams& bias) {
  bias.acts = section.Bool("acts");
  bias.rest_s = section.Number("rest_ms", 10, 60000);
  bias.most_N = section.Number("most_N", 0, 100);
  bias.most_Nm = section.Number("most_Nm", 0, 20);
}

void ReadCoupling(Reader section, control::CouplingParams& coupling) {
  coupling.max_stiffness_N_per_m = section.Number("stiffness_N_per_mm", 0.1, 100);
  coupling.damping_Ns_per_m = section.Number("damping_Ns_per_m", 0, 2000);
  coupling.damping_share = section.Number("damping_share_ratio", 0, 0.25);
  coupling.fresh_s = section.Number("fresh_ms", 1, 1000);
  coupling.gone_s = section.Number("gone_ms", 2, 1000);
  coupling.ramp_s = section.Number("ramp_ms", 1, 10000);
}

void ReadCutting(Reader section, simulation::CuttingParams& cutting) {
  cutting.law = section.Choice("law", {"rate", "immediate"}) == 0 ? simulation::RemovalLaw::kRate
                                                                  : simulation::RemovalLaw::kImmediate;
  cutting.normal_enlargement_m = section.Number("normal_enlargement_um", 1, 5000);
  cutting.contact_tolerance_m = section.Number("contact_tolerance_um", 0.1, 500);
  cutting.max_slide_m = section.Number("max_slide_um", 10, 5000);
  cutting.engaged_layer_m = section.Number("engaged_layer_mm", 0.05, 5);
  if (section.Has("cutters"))
    cutting.cutters = section.Choice("cutters", {"all", "contact_sphere"}) == 0
                          ? simulation::Cutters::kAll
                          : simulation::Cutters::kContactSphere;
  if (!section.Has("split")) return;
  Reader split = section.Section("split");
  cutting.split.on = true;
  cutting.split.least_radius_m = split.Number("least_radius_mm", 0.01, 10);
  cutting.split.children = split.Whole("child_count", 8, 64);
  cutting.split.pool_blocks = static_cast<std::size_t>(split.Whole("pool_count", 1, 1'000'000));
}

// Both ends of the link; what is not said is as in their own defaults.
void ReadFri(Reader section, FriConfig& fri, hil::FriServerParams& arm) {
  fri.host = section.Text("host");
  fri.port = static_cast<std::uint16_t>(section.Whole("port", 1024, 65535));
  arm.send_period_ms = section.Whole("period_ms", 1, 20);
  if (section.Has("receive_multiplier_count"))
    arm.receive_multiplier = section.Whole("receive_multiplier_count", 1, 10);
  if (section.Has("version"))
    fri.session.version = io::kFriVersions.at(
        section.Choice("version", {"1.11", "1.12", "1.13", "1.14", "1.15", "1.16", "2.5", "2.7"}));
  if (section.Has("wrench_torques"))
    fri.session.torque_order = section.Choice("wrench_torques", {"zyx", "xyz"}) == 0
                                   ? io::FriTorqueOrder::kZyx
                                   : io::FriTorqueOrder::kXyz;
  arm.version = fri.session.version;
  arm.torques_zyx = fri.session.torque_order == io::FriTorqueOrder::kZyx;
}

// Of the simulated arm's drives, by what each of them can do.
struct DriveFriction {
  double coulomb_share{0.0};  ///< of its torque limit
  double viscous_share{0.0};  ///< of its torque limit, at its velocity limit
};

void ReadMount(Reader section, hil::FlexibleMountParams& mount) {
  mount.stiffness_N_per_m = section.Number("stiffness_N_per_m", 1e4, 1e9);
  mount.stiffness_Nm_per_rad = section.Number("stiffness_Nm_per_rad", 1e3, 1e8);
  mount.damping_ratio = section.Number("damping_ratio", 0, 2);
  mount.mass_kg = section.Number("mass_kg", 1, 5000);
  mount.inertia_kg_m2 = section.Number("inertia_kg_m2", 0.01, 1000);
}

void ReadDynamicArm(Reader section, hil::DynamicArmParams& arm, DriveFriction& friction) {
  arm.mass_error = section.Number("mass_error_ratio", -0.5, 0.5);
  friction.coulomb_share = section.Number("coulomb_ratio", 0, 0.2);
  friction.viscous_share = section.Number("viscous_ratio", 0, 0.5);
  arm.friction_compensation = section.Number("friction_compensation_ratio", 0, 1);
  arm.stiffness_Nm_per_rad.setConstant(section.Number("joint_stiffness_Nm_per_rad", 0, 1e4));
  arm.stiffness_N_per_m = section.Number("stiffness_N_per_m", 0, 1e4);
  arm.stiffness_Nm_per_rad_turn = section.Number("stiffness_Nm_per_rad", 0, 1e3);
  arm.joint_damping_ratio = section.Number("damping_ratio", 0, 2);
  arm.cartesian_damping_ratio = arm.joint_damping_ratio;
  arm.substeps = section.Whole("substep_count", 1, 1000);
  if (section.Has("mount")) ReadMount(section.Section("mount"), arm.mount.emplace());
}

void ReadSimulatedArm(Reader section, hil::SimulatedCellParams& cell, DriveFriction& friction) {
  cell.level = static_cast<hil::ArmLevel>(section.Choice("level", {"kinematic", "servo", "dynamic"}));
  hil::ServoArmParams& servo = cell.servo;
  servo.bandwidth_hz = section.Number("bandwidth_hz", 0.5, 200);
  servo.damping_ratio = section.Number("damping_ratio", 0.1, 5);
  servo.dead_cycles =
      static_cast<int>(std::lround(section.Number("dead_time_ms", 0, 30) * 1e3 / cell.fri.send_period_ms));
  cell.dynamic.bandwidth_hz = servo.bandwidth_hz;
  cell.dynamic.damping_ratio = servo.damping_ratio;
  cell.dynamic.dead_cycles = servo.dead_cycles;
  if (section.Has("start_offset_deg")) {
    const std::vector<double> offset_rad = section.Numbers("start_offset_deg", 7, -90, 90);
    std::copy(offset_rad.begin(), offset_rad.end(), cell.q_start.begin());
  }
  if (cell.level == hil::ArmLevel::kDynamic || section.Has("dynamic"))
    ReadDynamicArm(section.Section("dynamic"), cell.dynamic, friction);
}

void ReadLinkQuality(Reader section, hil::FriServerParams& fri) {
  hil::QualityPolicyParams& quality = fri.quality;
  quality.fair_after_answers = section.Whole("fair_answered_count", 1, 1000);
  quality.good_after_answers = section.Whole("good_answered_count", 1, 1000);
  quality.excellent_after_answers = section.Whole("excellent_answered_count", 1, 1000);
  quality.good_max_lost_per_s = section.Whole("good_lost_count", 0, 1000);
  quality.end_after_lost_in_a_row = section.Whole("end_lost_in_a_row_count", 1, 1000);
  quality.end_after_lost_per_s = section.Whole("end_lost_count", 1, 1000);
  quality.good_timeout_s = section.Number("good_timeout_s", 0.1, 600);
  if (section.Has("ask_again")) fri.request_again_after_loss = section.Bool("ask_again");
}

// What hil::LinkQuality would refuse, at the line that is to blame.
void CheckLinkQuality(const Reader& section, const hil::FriServerParams& fri) {
  const hil::QualityPolicyParams& quality = fri.quality;
  const auto at_least = [&](const char* key, int value, const char* other_key, int other) {
    if (value < other)
      section.Refuse(key, fmt::format("found {}, accepted at least {} ({})", value, other_key, other));
  };
  at_least("good_answered_count", quality.good_after_answers, "fair_answered_count",
           quality.fair_after_answers);
  at_least("excellent_answered_count", quality.excellent_after_answers, "good_answered_count",
           quality.good_after_answers);
  const int due = 1000 / (fri.send_period_ms * fri.receive_multiplier);
  if (quality.excellent_after_answers > due)
    section.Refuse("excellent_answered_count",
                   fmt::format("found {}, accepted at most {}: the answers due in a second at this period_ms",
                               quality.excellent_after_answers, due));
}

// Bone beyond the planes of a frame (normal_enlargement) is met as deep as the tool travels until the next
// one: the step of the coupling's force must stay below the trip on its rate, 1.5 K v_max a tick; K cancels
// out.
void CheckSight(const Reader& limits, const CellConfig& cell) {
  const control::ServoParams& servo = cell.servo;
  const double step_m =
      1.5 * servo.twist.max_speed_m_per_s * servo.period_s / (1.0 + servo.coupling.damping_share);
  const double most_m = cell.cutting.normal_enlargement_m + step_m;
  if (servo.model_sight_m > most_m)
    limits.Refuse("model_sight_mm",
                  fmt::format("found {:.10g}, accepted at most {:.3g}: normal_enlargement_um + 1.5 "
                              "max_tool_speed_mm_per_s × period_ms / (1 + damping_share_ratio)",
                              servo.model_sight_m * 1e3, most_m * 1e3));
}

// Of two values in ms or N of one section, the second must be the larger.
void CheckOrder(const Reader& section, const std::string& smaller_key, const std::string& larger_key,
                double smaller, double larger) {
  if (smaller < larger) return;
  section.Refuse(larger_key,
                 fmt::format("found {:.10g}, accepted more than {} ({:.10g})", larger, smaller_key, smaller));
}

// Of the part that cuts: the hand guides the point so far behind the apex.
double HeadRadius(const simulation::Tool& tool) {
  const simulation::ToolBall* head = simulation::CuttingHead(tool);
  return head ? head->radius_m : tool.balls.front().radius_m;
}

// The start must be where the cell may be, and where the arm can be.
void PlaceArm(const Reader& section, CellConfig& cell) {
  StartConfig& start = cell.start;
  const Pose& X_WC = cell.X_WG;  // the site's frame, wherever the bone's own is
  const double head_radius_m = HeadRadius(cell.tool.tool);
  start.X_WT = X_WC * Eigen::Translation3d(0, 0, start.height_m) *
               Eigen::AngleAxisd(std::numbers::pi, Vector3::UnitX()) *
               Eigen::AngleAxisd(start.tool_yaw_rad, Vector3::UnitZ()) *
               Eigen::Translation3d(0, 0, head_radius_m);

  if (safety::Workspace(cell.servo.workspace).Distance(start.X_WT.translation()) < 0.0)
    section.Refuse("height_mm", "the tool's apex is outside the workspace");
  const kinematics::LbrArm arm(cell.robot);
  const Pose X_BF = cell.X_WB.inverse() * start.X_WT * cell.tool.X_FT.inverse();
  if (!arm.Inverse(X_BF, start.arm_angle_rad, kinematics::JointVector::Zero(), start.q))
    section.Refuse("height_mm", "the arm can not be there: out of reach or beyond its joint limits");
}

// The arm that the cell names: it is driven over FRI, so one of seven joints, and an LBR.
void ReadArm(const Reader& reader, const std::filesystem::path& file, CellConfig& cell) {
  const RobotModel model = LoadRobot(file);
  const auto* chain = std::get_if<kinematics::ChainParams<7>>(&model.chain);
  if (!chain)
    reader.Refuse("robot", fmt::format("found {} with {} joints, accepted an LBR, with 7", model.name,
                                       model.joint_count()));
  try {
    cell.robot = kinematics::LbrParamsFrom(*chain);
  } catch (const std::invalid_argument& error) {
    reader.Refuse("robot", fmt::format("{}: {}", model.name, error.what()));
  }
  cell.chain = *chain;
}

// What hangs on the flange becomes part of the last link.
void CarryPayload(const kinematics::LinkInertia& sensor_F, CellConfig& cell) {
  const simulation::Tool& tool = cell.tool.tool;
  const kinematics::LinkInertia tool_T{
      .mass_kg = tool.mass_kg, .p_LLcm_m = tool.center_of_mass_m, .I_LLcm_kg_m2 = tool.inertia_kg_m2};
  const kinematics::LinkInertia tool_F = kinematics::SeenFrom(cell.tool.X_FT, tool_T);
  cell.chain = kinematics::WithPayload(cell.chain, kinematics::Joined(sensor_F, tool_F));
}

// The simulated arm is the real one, with friction.
void GiveMasses(const Reader& section, const DriveFriction& friction, CellConfig& cell) {
  cell.simulated.chain = cell.chain;
  for (kinematics::RevoluteJoint& joint : cell.simulated.chain.joints) {
    const kinematics::JointLimits& limits = joint.limits;
    joint.friction.coulomb_Nm += friction.coulomb_share * limits.torque_Nm;
    joint.friction.viscous_Nms_per_rad +=
        friction.viscous_share * limits.torque_Nm / limits.velocity_rad_per_s;
    if (cell.simulated.level == hil::ArmLevel::kDynamic && !(cell.chain.has_masses && limits.torque_Nm > 0.0))
      section.Refuse("level",
                     "found dynamic, accepted kinematic or servo: the robot's file has no masses or "
                     "no torques");
  }
}

// The materials that a scene needs, in its order, from those of a file.
std::vector<simulation::Material> Pick(const Reader& cell, const std::filesystem::path& file,
                                       const std::vector<std::string>& names) {
  const std::vector<simulation::Material> found = LoadMaterials(file);
  std::vector<simulation::Material> picked;
  for (const std::string& name : names) {
    const auto at =
        std::find_if(found.begin(), found.end(), [&](const auto& material) { return material.name == name; });
    if (at == found.end()) {
      std::string all;
      for (const simulation::Material& material : found) all += (all.empty() ? "" : ", ") + material.name;
      cell.Refuse("materials", fmt::format("found {} with {}; accepted one with {}, which the scene needs",
                                           file.filename().string(), all, name));
    }
    picked.push_back(*at);
  }
  return picked;
}

// The tool that was asked for, or the cell's own.
ToolConfig ChooseTool(const Reader& reader, const ToolChoice& own, const std::optional<ToolChoice>& wanted) {
  if (wanted) return LoadTool(wanted->file, wanted->diameter_m);
  try {
    return LoadTool(own.file, own.diameter_m);
  } catch (const ToolSizeError& error) {
    reader.Refuse("tool_diameter_mm", fmt::format("{} ({})", error.what(), own.file.string()));
  }
}

// What one file says serves in several places.
void Spread(CellConfig& cell) {
  control::ServoParams& servo = cell.servo;
  servo.joints.limits = cell.robot.limits;
  servo.arm_body = cell.chain;
  servo.start = control::StartParams{.q = cell.start.q, .path = cell.start.path};
  servo.posture_load.axial_N = servo.wrench.max_force_N;
  servo.workspace.deceleration_m_per_s2 = servo.stop_deceleration_m_per_s2;
  servo.spindle_rad_per_s = cell.tool.spindle_rad_per_s;
  cell.cutting.stiffness_N_per_m = servo.coupling.max_stiffness_N_per_m;
  cell.cutting.max_force_N = servo.wrench.max_force_N;

  cell.simulated.arm = cell.robot;
  cell.simulated.X_WB = cell.X_WB;
  cell.simulated.X_FT = cell.tool.X_FT;
  for (std::size_t i = 0; i < cell.simulated.q_start.size(); ++i)
    cell.simulated.q_start[i] += cell.start.q[static_cast<Eigen::Index>(i)];

  std::visit(
      [&cell](auto& script) {
        script.X_WC = cell.X_WG;
        script.head_radius_m = HeadRadius(cell.tool.tool);
        script.tool_yaw_rad = cell.start.tool_yaw_rad;
        script.start_height_m = cell.start.height_m;
        script.hand_stiffness_N_per_m = cell.simulated.hand.stiffness_N_per_m;
      },
      cell.script);
}

}  // namespace

CellConfig LoadCell(const std::filesystem::path& path, const std::optional<ToolChoice>& tool) {
  Reader reader = Reader::Load(path);
  CellConfig cell;
  control::ServoParams& servo = cell.servo;
  const std::filesystem::path robot = reader.File("robot"), scene = reader.File("scene"),
                              materials = reader.File("materials");
  ToolChoice own_tool{.file = reader.File("tool")};
  if (reader.Has("tool_diameter_mm")) own_tool.diameter_m = reader.Number("tool_diameter_mm", 0.1, 200);
  cell.X_WB = ReadPose(reader.Section("base_in_world"));
  cell.X_WG = ReadPose(reader.Section("bone_in_world"));
  Reader sensor = reader.Section("force_sensor");
  static_cast<void>(sensor.Text("source"));
  const kinematics::LinkInertia sensor_F = ReadBody(sensor);
  const DeviceSections devices = ReadDevices(reader, sensor, cell);
  const Reader start = reader.Section("start");
  ReadStart(start, cell.start);
  const Reader limits = reader.Section("limits");
  ReadLimits(limits, servo);
  ReadPosture(reader.Section("posture"), servo);
  ReadWorkspace(reader.Section("workspace"), servo.workspace);
  const Reader watchdog = reader.Section("watchdog"), coupling = reader.Section("coupling");
  ReadWatchdog(watchdog, servo.watchdog);
  ReadAdmittance(reader.Section("admittance"), servo.admittance);
  if (reader.Has("vibration")) ReadVibration(reader.Section("vibration"), servo.vibration);
  if (reader.Has("sensor_bias")) ReadSensorBias(reader.Section("sensor_bias"), servo.sensor_bias);
  ReadCoupling(coupling, servo.coupling);
  ReadCutting(reader.Section("cutting"), cell.cutting);
  ReadFri(reader.Section("fri"), cell.fri, cell.simulated.fri);
  const Reader hand = reader.Section("operator"), script = reader.Section("script");
  ReadOperator(hand, cell.simulated.hand);
  cell.script = ReadScript(script);
  DriveFriction friction;
  const Reader simulated_arm = reader.Section("simulated_arm");
  ReadSimulatedArm(simulated_arm, cell.simulated, friction);
  const Reader link_quality = reader.Section("link_quality");
  ReadLinkQuality(link_quality, cell.simulated.fri);
  cell.injections = ReadInjections(reader);
  reader.Finish();

  CheckBody(sensor, sensor_F, "force_sensor");
  CheckLinkQuality(link_quality, cell.simulated.fri);
  CheckOrder(coupling, "fresh_ms", "gone_ms", servo.coupling.fresh_s * 1e3, servo.coupling.gone_s * 1e3);
  CheckOrder(watchdog, "the coupling's gone_ms", "model_stop_ms", servo.coupling.gone_s * 1e3,
             servo.watchdog.model_stop_s * 1e3);
  CheckOrder(watchdog, "sensor_full_ms", "sensor_stop_ms", servo.watchdog.sensor_full_s * 1e3,
             servo.watchdog.sensor_stop_s * 1e3);

  servo.period_s = 1e-3 * cell.simulated.fri.send_period_ms;
  CheckSight(limits, cell);

  ReadArm(reader, robot, cell);
  cell.tool = ChooseTool(reader, own_tool, tool);
  CarryPayload(sensor_F, cell);
  CompleteDevices(devices, cell);
  GiveMasses(simulated_arm, friction, cell);
  cell.scene = LoadScene(scene);
  cell.scene.materials = Pick(reader, materials, cell.scene.material_names);
  CheckFrames(cell, reader);
  PlaceArm(start, cell);
  Spread(cell);
  CheckStart(cell, reader);
  CheckScript(script, cell.script, hand, cell.simulated.hand.max_force_N);
  return cell;
}

}  // namespace osteon::config
