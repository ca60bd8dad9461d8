#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "config/reading/apply_identified.h"
#include "config/reading/check_loop.h"
#include "config/reading/check_registration.h"
#include "config/reading/load.h"
#include "config/reading/load_robot.h"
#include "config/reading/sections/read_arm_link.h"
#include "config/reading/sections/read_bone.h"
#include "config/reading/sections/read_calibration.h"
#include "config/reading/sections/read_compliance.h"
#include "config/reading/sections/read_devices.h"
#include "config/reading/sections/read_engine_process.h"
#include "config/reading/sections/read_gains.h"
#include "config/reading/sections/read_guard.h"
#include "config/reading/sections/read_limits.h"
#include "config/reading/sections/read_pose.h"
#include "config/reading/sections/read_stabilisers.h"
#include "config/reading/select_materials.h"
#include "config/reading/simulated/read_injections.h"
#include "config/reading/simulated/read_operator.h"
#include "config/reading/simulated/read_script.h"
#include "config/reading/simulated/read_simulated_arm.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "kinematics/payload.h"

namespace osteon::config {
namespace {

// The Read functions fill their part of the cell from a section of its file. The numbers behind a key are its
// accepted range, in the unit at the key's end.

// @param lbr  whether the arm has seven joints: only then the section has an arm angle
void ReadStart(Reader section, bool lbr, StartConfig& start) {
  start.height_m = section.Number("height_mm", 0, 500);
  start.tool_yaw_rad = section.Number("tool_yaw_deg", -360, 360);
  if (lbr) start.arm_angle_rad = section.Number("arm_angle_deg", -180, 180);
  start.path.speed_share = section.Number("speed_ratio", 0.01, 1);
  start.path.acceleration_share = section.Number("acceleration_ratio", 0.01, 1);
  start.path.tool_speed_m_per_s =
      section.Number("tool_speed_mm_per_s", 1, 1e3 * control::kReducedSpeed_m_per_s);
  start.path.pause_s = section.Number("pause_ms", 50, 5000);
  if (section.Has("pause_force_N")) start.pause_force_N = section.Number("pause_force_N", 1, 500);
}

void ReadPosture(Reader section, bool lbr, control::ServoParams& servo) {
  servo.joint_acceleration_share = section.Number("joint_acceleration_ratio", 0.1, 100);
  if (!lbr) return;
  kinematics::PosturePreferenceParams& posture = servo.posture;
  posture.limit_zone_rad = section.Number("limit_zone_deg", 0.1, 120);
  posture.limit_speed_rad_per_s = section.Number("limit_deg_per_s", 0, 100);
  posture.singular_zone_m = section.Number("singular_zone_mm", 1, 500);
  posture.singular_speed_rad_per_s = section.Number("singular_deg_per_s", 0, 100);
  servo.posture_load.lateral_N = section.Number("lateral_force_N", 0, safety::kForceCeiling_N);
  posture.load_zone = section.Number("load_zone_ratio", 1.05, 5);
  posture.load_speed_rad_per_s = section.Number("load_deg_per_s", 0, 100);
}

void ReadWorkspace(Reader section, const Pose& X_WG, safety::WorkspaceParams& workspace) {
  workspace.sphere_center_W_m = section.Triple("sphere_center_mm", -5000, 5000);
  workspace.sphere_radius_m = section.Number("sphere_radius_mm", 10, 2000);
  workspace.plane_normal_W = section.Direction("plane_normal_axis");
  workspace.plane_offset_m = section.Number("plane_offset_mm", -5000, 5000);
  if (!IsInBoneFrame(section)) return;
  workspace.sphere_center_W_m = X_WG * Vector3(workspace.sphere_center_W_m);
  workspace.plane_normal_W = X_WG.linear() * Vector3(workspace.plane_normal_W);
  workspace.plane_offset_m += workspace.plane_normal_W.dot(X_WG.translation());
}

void ReadWatchdog(Reader section, safety::WatchdogParams& watchdog) {
  watchdog.model_stop_s = section.Number("model_stop_ms", 1, 1000);
  watchdog.sensor_full_s = section.Number("sensor_full_ms", 1, 1000);
  watchdog.sensor_stop_s = section.Number("sensor_stop_ms", 1, 1000);
  watchdog.arm_misses = section.WholeNumber("arm_miss_count", 1, 100);
}

void ReadImpedance(Reader section, CellConfig& cell) {
  if (section.Has("locked"))
    section.Refuse("locked",
                   "found with the impedance law, accepted in admittance: an arm that carries itself "
                   "is where the hand has it, and a wrench alone does not lock an axis");
  control::ImpedanceParams& impedance = cell.servo.impedance;
  impedance.damping_Ns_per_m = section.Triple("damping_Ns_per_m", 0, 1000);
  impedance.damping_Nms_per_rad = section.Triple("damping_Nms_per_rad", 0, 100);
  impedance.brake_Ns_per_m = section.Number("brake_Ns_per_m", 0, 2000);
  impedance.brake_Nms_per_rad = section.Number("brake_Nms_per_rad", 0, 100);
  impedance.twist_filter_s = section.Number("twist_filter_ms", 0, 100);
  impedance.follow_s = section.Number("follow_ms", 1, 10000);
  // The arm's program sets these modes. The simulated arm must have the same.
  hil::FriServerParams& arm = cell.simulated.fri;
  const bool wrench = section.Choice("overlay", {"wrench", "torque"}) == 0;
  arm.command_mode = wrench ? control::CommandMode::kWrench : control::CommandMode::kTorque;
  arm.control_mode =
      wrench ? control::ControlMode::kCartesianImpedance : control::ControlMode::kJointImpedance;
}

void ReadVibration(Reader section, control::VibrationParams& vibration) {
  vibration.acts = section.Bool("acts");
  vibration.low_hz = section.Number("low_hz", 2, 20);
  vibration.high_hz = section.Number("high_hz", 21, 200);
  vibration.floor_N = section.Number("floor_N", 0.01, 20);
  vibration.alert_index = section.Number("alert_ratio", 0, 1);
  vibration.rise_s = section.Number("rise_ms", 1, 1000);
  vibration.decay_ratio = section.Number("decay_ratio", 1, 1000);
  vibration.max_damping_factor = section.Number("damping_ratio", 1, 1000);
  vibration.max_mass_factor = section.Number("mass_ratio", 1, 100);
  vibration.notch_hz = section.Number("notch_hz", 0, 20);
  // optional, because the cells in older recordings do not have this key
  if (section.Has("tremor_N")) vibration.reference.tremor_N = section.Number("tremor_N", 0, 50);
}

void ReadSensorBias(Reader section, control::BiasParams& bias) {
  bias.acts = section.Bool("acts");
  bias.rest_s = section.Number("rest_ms", 10, 60000);
  bias.max_bias_N = section.Number("max_N", 0, 100);
  bias.max_bias_Nm = section.Number("max_Nm", 0, 20);
  if (section.Has("max_creep_mm_per_s"))
    bias.max_creep_m_per_s = section.Number("max_creep_mm_per_s", 0.1, 1000);
  if (section.Has("max_creep_deg_per_s"))
    bias.max_creep_rad_per_s = section.Number("max_creep_deg_per_s", 0.1, 360);
}

// Reads the section of the cell's law: exactly one of `admittance` and `impedance`.
void ReadLaw(Reader& reader, CellConfig& cell) {
  const Reader section = reader.OneSection({"admittance", "impedance"});
  if (!reader.Has("impedance")) {
    ReadAdmittance(section, cell.servo.admittance);
    return;
  }
  cell.servo.law = control::Law::kImpedance;
  if (!cell.link.fri())
    reader.Refuse("impedance", "found beside rsi, accepted with fri: an arm over RSI takes positions alone");
  ReadImpedance(section, cell);
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
  if (section.Has("edge_force")) cutting.edge_force = section.Bool("edge_force");
  if (!section.Has("split")) return;
  Reader split = section.Section("split");
  cutting.split.on = true;
  cutting.split.min_radius_m = split.Number("min_radius_mm", 0.01, 10);
  cutting.split.children = split.WholeNumber("child_count", 8, 64);
  cutting.split.pool_blocks = static_cast<std::size_t>(split.WholeNumber("pool_count", 1, 1'000'000));
}

// Limits model_sight. A frame's planes describe the bone up to normal_enlargement from the tool. Until the
// next frame, the tool may enter bone farther away by the rest of model_sight, so the next frame makes the
// coupling's force step. The step must stay below the one that latches kWrenchRate, 1.5 K v_max dt. The
// stiffness K cancels out.
void CheckSight(const Reader& limits, const CellConfig& cell) {
  const control::ServoParams& servo = cell.servo;
  const double step_m =
      1.5 * servo.twist.max_speed_m_per_s * servo.period_s / (1.0 + servo.coupling.damping_share);
  const double max_m = cell.cutting.normal_enlargement_m + step_m;
  if (servo.model_sight_m > max_m)
    limits.Refuse("model_sight_mm",
                  fmt::format("found {:.10g}, accepted at most {:.3g}: normal_enlargement_um + 1.5 "
                              "max_tool_speed_mm_per_s × period_ms / (1 + damping_share_ratio)",
                              servo.model_sight_m * 1e3, max_m * 1e3));
}

// Limits max_slide. A frame moves the proxy by at most max_slide, and the coupling follows within its return
// time. The resulting change of force in one tick, damping included, must stay below the one that latches
// kWrenchRate (CheckSight).
void CheckSlide(const Reader& cutting, const CellConfig& cell) {
  const control::ServoParams& servo = cell.servo;
  const double hand_over_s = std::max(servo.coupling.return_s, servo.period_s);
  const double max_m =
      1.5 * servo.twist.max_speed_m_per_s * hand_over_s / (1.0 + servo.coupling.damping_share);
  if (cell.cutting.max_slide_m > max_m)
    cutting.Refuse(
        "max_slide_um",
        fmt::format("found {:.10g}, accepted at most {:.4g}: what a hand-over of {:g} ms takes without a "
                    "trip, 1.5 max_tool_speed_mm_per_s ({:g}) × {:g} ms / (1 + damping_share_ratio)",
                    cell.cutting.max_slide_m * 1e6, max_m * 1e6, hand_over_s * 1e3,
                    servo.twist.max_speed_m_per_s * 1e3, hand_over_s * 1e3));
}

// Refuses `larger_key` unless its value exceeds that of `smaller_key`, both in the same unit.
void CheckOrder(const Reader& section, const std::string& smaller_key, const std::string& larger_key,
                double smaller, double larger) {
  if (smaller < larger) return;
  section.Refuse(larger_key,
                 fmt::format("found {:.10g}, accepted more than {} ({:.10g})", larger, smaller_key, smaller));
}

// Radius [m] of the cutting head. The head's centre, which the hand guides, lies this far behind the apex.
double HeadRadius(const simulation::Tool& tool) {
  const simulation::ToolBall* head = simulation::CuttingHead(tool);
  return head ? head->radius_m : tool.balls.front().radius_m;
}

// Finds the joints start.q at which the flange is at X_BF. False if the arm cannot reach this pose.
bool PlaceArm(const LbrConfig& arm, const Pose& X_BF, StartConfig& start) {
  return kinematics::LbrArm(arm.params)
      .Inverse(X_BF, start.arm_angle_rad, kinematics::JointVector::Zero(), start.q);
}

bool PlaceArm(const SixAxisConfig& arm, const Pose& X_BF, StartConfig& start) {
  constexpr double kQuarter = std::numbers::pi / 2.0;
  kinematics::JointVectorN<6> q, usual;  // among several solutions, the one nearest to `usual` is used
  usual << 0.0, -kQuarter, kQuarter, 0.0, kQuarter, 0.0;
  if (!kinematics::OrthoParallelArm(arm.params).Inverse(X_BF, usual, q)) return false;
  start.q << q, 0.0;
  return true;
}

// Computes start.X_WT and start.q. Returns why the arm cannot be there; empty if it can.
std::string TryPlaceAtStart(CellConfig& cell) {
  StartConfig& start = cell.start;
  const Pose& X_WC = cell.X_WG;  // the site's frame, which may differ from the bone's own
  const double head_radius_m = HeadRadius(cell.tool.tool);
  start.X_WT = X_WC * Eigen::Translation3d(0, 0, start.height_m) *
               Eigen::AngleAxisd(std::numbers::pi, Vector3::UnitX()) *
               Eigen::AngleAxisd(start.tool_yaw_rad, Vector3::UnitZ()) *
               Eigen::Translation3d(0, 0, head_radius_m);

  if (safety::Workspace(cell.servo.workspace).Distance(start.X_WT.translation()) < 0.0)
    return "the tool's apex is outside the workspace";
  const Pose X_BF = cell.X_WB.inverse() * start.X_WT * cell.tool.X_FT.inverse();
  if (!std::visit([&](const auto& arm) { return PlaceArm(arm, X_BF, start); }, cell.robot.arm))
    return "the arm can not be there: out of reach or beyond its joint limits";
  return {};
}

void PlaceAtStart(const Reader& reader, CellConfig& cell) {
  if (const std::string wrong = TryPlaceAtStart(cell); !wrong.empty())
    RefuseStart(cell, reader, wrong, [](CellConfig& other) { return TryPlaceAtStart(other).empty(); });
}

// Reads the arm that the cell names.
void ReadRobot(const Reader& reader, const std::filesystem::path& file, RobotConfig& robot) {
  const RobotModel model = LoadRobot(file);
  robot.name = model.name;
  try {
    if (const auto* chain = std::get_if<kinematics::ChainParams<7>>(&model.chain)) {
      robot.arm = LbrConfig{.params = kinematics::LbrParamsFrom(*chain), .chain = *chain};
    } else {
      const auto& six = std::get<kinematics::ChainParams<6>>(model.chain);
      robot.arm = SixAxisConfig{
          .params = model.ortho_parallel ? *model.ortho_parallel : kinematics::OrthoParallelParamsFrom(six),
          .chain = six};
    }
  } catch (const std::invalid_argument& error) {
    reader.Refuse("robot", fmt::format("{}: {}", model.name, error.what()));
  }
}

// Adds the load on the flange to the last link, if the links have masses.
void CarryPayload(const kinematics::LinkInertia& sensor_F, CellConfig& cell) {
  auto* lbr = std::get_if<LbrConfig>(&cell.robot.arm);
  if (!lbr) return;
  const simulation::Tool& tool = cell.tool.tool;
  const kinematics::LinkInertia tool_T{
      .mass_kg = tool.mass_kg, .p_LLcm_m = tool.center_of_mass_m, .I_LLcm_kg_m2 = tool.inertia_kg_m2};
  const kinematics::LinkInertia tool_F = kinematics::SeenFrom(cell.tool.X_FT, tool_T);
  lbr->chain = kinematics::WithPayload(lbr->chain, kinematics::Joined(sensor_F, tool_F));
}

// Selects the materials that a scene needs, in its order, from those of a file.
std::vector<simulation::Material> SceneMaterials(const Reader& cell, const std::filesystem::path& file,
                                                 const std::vector<std::string>& names) {
  const std::vector<simulation::Material> found = LoadMaterials(file);
  auto selected = SelectMaterials(found, names);
  if (!selected) {
    std::string all;
    for (const simulation::Material& material : found) all += (all.empty() ? "" : ", ") + material.name;
    cell.Refuse("materials", fmt::format("found {} with {}; accepted one with {}, which the scene needs",
                                         file.filename().string(), all, selected.error()));
  }
  return std::move(*selected);
}

// Refuses edge_force unless the tool's file counts the edges (edge_count) and a material states
// edge_force_N_per_mm.
void CheckEdgeForce(const Reader& cutting, const CellConfig& cell) {
  if (!cell.cutting.edge_force) return;
  if (simulation::CuttingEdges(cell.tool.tool) == 0)
    cutting.Refuse("edge_force", fmt::format("found true with {}, accepted with a tool that has edge_count",
                                             cell.tool_file.filename().string()));
  if (std::ranges::none_of(cell.scene.materials,
                           [](const simulation::Material& m) { return m.edge_force_N_per_m > 0.0; }))
    cutting.Refuse("edge_force",
                   "found true, accepted with a scene of which a material has edge_force_N_per_mm");
}

// Loads the requested tool, or else the cell's own.
ToolConfig ChooseTool(const Reader& reader, const ToolChoice& own,
                      const std::optional<ToolChoice>& requested) {
  if (requested) return LoadTool(requested->file, requested->diameter_m);
  try {
    return LoadTool(own.file, own.diameter_m);
  } catch (const ToolSizeError& error) {
    reader.Refuse("tool_diameter_mm", fmt::format("{} ({})", error.what(), own.file.string()));
  }
}

// Copies values that several parts of the configuration need from the file that states them to the other
// parts.
void PropagateSharedValues(CellConfig& cell) {
  control::ServoParams& servo = cell.servo;
  std::visit(
      [&](const auto& arm) {
        std::copy(arm.params.limits.begin(), arm.params.limits.end(), servo.joints.limits.begin());
      },
      cell.robot.arm);
  if (const LbrConfig* lbr = cell.robot.lbr()) servo.arm_body = lbr->chain;
  servo.start = control::StartParams{
      .q = cell.start.q, .path = cell.start.path, .pause_force_N = cell.start.pause_force_N};
  servo.posture_load.axial_N = servo.wrench.max_force_N;
  servo.workspace.deceleration_m_per_s2 = servo.stop_deceleration_m_per_s2;
  servo.spindle_rad_per_s = cell.tool.spindle_rad_per_s;
  // The cell's file states these limits as ratios of the tool's own values, because the cell may be used with
  // other tools.
  if (const double rated_Nm = cell.tool.drive.rated_torque_Nm * cell.tool.drive.gear_ratio; rated_Nm > 0.0) {
    servo.spindle_limits.max_torque_Nm *= rated_Nm;
    servo.spindle_limits.max_speed_rad_per_s *= cell.tool.spindle_rad_per_s;
  } else {
    servo.spindle_limits = {};
  }
  cell.cutting.stiffness_N_per_m = servo.coupling.max_stiffness_N_per_m;
  cell.cutting.max_force_N = servo.wrench.max_force_N;

  cell.simulated.X_WB = cell.X_WB;
  // Until here, q_start is the simulated arm's offset from the start.
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

// The three sections that a cell for a real arm may omit. Either all three are present or none.
struct SimulationSections {
  Reader hand, script;
  SimulatedArmSection arm;
};

std::optional<SimulationSections> ReadSimulation(Reader& reader, CellConfig& cell) {
  if (!cell.has_simulation) return std::nullopt;
  const Reader hand = reader.Section("operator"), script = reader.Section("script");
  ReadOperator(hand, cell.simulated.hand);
  cell.script = ReadScript(script);
  return SimulationSections{hand, script, ReadSimulatedArm(reader.Section("simulated_arm"), cell)};
}

CellConfig ReadCell(Reader reader, const std::optional<ToolChoice>& tool, const std::filesystem::path& gains,
                    const std::filesystem::path& identified_instead) {
  CellConfig cell;
  control::ServoParams& servo = cell.servo;
  const std::filesystem::path robot = reader.File("robot", "robots"),
                              materials = reader.File("materials", "materials");
  std::filesystem::path scene = reader.File("scene", "scenes");
  if (reader.Has("bone")) cell.bone = ReadBone(reader.Section("bone"), scene);
  cell.has_simulation = reader.Has("operator") || reader.Has("script") || reader.Has("simulated_arm");
  ToolChoice own_tool{.file = reader.File("tool", "tools")};
  std::optional<std::filesystem::path> calibration;
  if (reader.Has("calibration")) calibration = reader.File("calibration");
  std::optional<std::filesystem::path> identified;
  if (reader.Has("identified")) identified = reader.File("identified");
  if (!identified_instead.empty()) identified = identified_instead;
  if (reader.Has("tool_diameter_mm")) own_tool.diameter_m = reader.Number("tool_diameter_mm", 0.1, 200);
  cell.X_WB = ReadPose(reader.Section("base_in_world"));
  cell.X_WG = ReadPose(reader.Section("bone_in_world"));
  Reader sensor = reader.Section("force_sensor");
  static_cast<void>(sensor.Text("source"));
  const kinematics::LinkInertia sensor_F = ReadBody(sensor);
  const DeviceSections devices = ReadDevices(reader, sensor, cell);
  const ArmLinkSections link = ReadArmLink(reader, cell);
  if (reader.Has("guard")) cell.guard = ReadGuard(reader, cell.link);
  std::optional<EngineProcessSection> engine_process;
  if (reader.Has("simulation")) engine_process = ReadEngineProcess(reader.Section("simulation"));
  const bool lbr = cell.link.fri() != nullptr;
  const Reader start = reader.Section("start");
  ReadStart(start, lbr, cell.start);
  const Reader limits = reader.Section("limits");
  ReadLimits(limits, lbr, servo);
  ReadPosture(reader.Section("posture"), lbr, servo);
  ReadWorkspace(reader.Section("workspace"), cell.X_WG, servo.workspace);
  ReadZones(reader, cell.X_WG, servo.workspace);
  ReadDepthLimit(reader, cell.X_WG, servo.depth);
  const std::optional<Reader> compliance = ReadCompliance(reader, cell);
  const Reader watchdog = reader.Section("watchdog"), coupling = reader.Section("coupling");
  ReadWatchdog(watchdog, servo.watchdog);
  ReadLaw(reader, cell);
  // default for a cell without section `vibration`; docs/tuning.md gives the reason
  servo.vibration.acts = false;
  if (reader.Has("console"))
    cell.pause_when_operator_leaves = reader.Section("console").Bool("pause_when_operator_leaves");
  if (reader.Has("vibration")) ReadVibration(reader.Section("vibration"), servo.vibration);
  ReadStabilisers(reader, servo.law, servo.stabilisers);
  if (reader.Has("sensor_bias")) ReadSensorBias(reader.Section("sensor_bias"), servo.sensor_bias);
  ReadCoupling(coupling, servo.coupling);
  const Reader cutting = reader.Section("cutting");
  ReadCutting(cutting, cell.cutting);
  const std::optional<SimulationSections> simulation = ReadSimulation(reader, cell);
  cell.injections = ReadInjections(reader);
  reader.Finish();

  // All keys of the cell's file have been read. Check its values against each other, then load the files that
  // it names.
  CheckDepthLimit(reader, servo.depth, servo.coupling.max_stiffness_N_per_m);
  cell.own_gains = control::GainsOf(servo.admittance, servo.coupling);
  if (!gains.empty()) ApplyGainsFile(gains, servo.law, servo.admittance, servo.coupling);

  CompleteForceLimit(limits, servo);
  CheckBody(sensor, sensor_F, "force_sensor");
  CheckArmLink(link, cell);
  if (engine_process) cell.engine_process = CheckEngineProcess(*engine_process);
  CheckOrder(coupling, "fresh_ms", "gone_ms", servo.coupling.fresh_s * 1e3, servo.coupling.gone_s * 1e3);
  CheckOrder(watchdog, "the coupling's gone_ms", "model_stop_ms", servo.coupling.gone_s * 1e3,
             servo.watchdog.model_stop_s * 1e3);
  CheckOrder(watchdog, "sensor_full_ms", "sensor_stop_ms", servo.watchdog.sensor_full_s * 1e3,
             servo.watchdog.sensor_stop_s * 1e3);

  CheckSight(limits, cell);
  CheckSlide(cutting, cell);

  ReadRobot(reader, robot, cell.robot);
  CompleteArmLink(reader, cell);
  cell.tool = ChooseTool(reader, own_tool, tool);
  cell.tool_file = tool ? tool->file : own_tool.file;
  cell.simulated.X_FT = cell.tool.X_FT;  // the simulated arm keeps the value of the tool's file; only the
                                         // loop uses a calibrated apex
  servo.stabilisers.age_governor.tool_radius_m = HeadRadius(cell.tool.tool);
  CarryPayload(sensor_F, cell);
  CompleteDevices(devices, cell);
  if (calibration) ApplyCalibration(*calibration, cell);
  if (simulation) CompleteSimulatedArm(simulation->arm, cell);
  cell.scene = LoadScene(scene);
  cell.scene.materials = SceneMaterials(reader, materials, cell.scene.material_names);
  CheckEdgeForce(cutting, cell);
  CompleteCompliance(compliance, cell);
  CheckFrames(cell, reader);
  PlaceAtStart(reader, cell);
  PropagateSharedValues(cell);
  if (identified) ApplyIdentified(*identified, cell);
  CheckLoop(reader, servo);
  CheckStart(cell, reader);
  if (simulation)
    CheckScript(simulation->script, cell.script, simulation->hand, cell.simulated.hand.max_force_N);
  return cell;
}

}  // namespace

void RequireSimulation(const CellConfig& cell, const std::filesystem::path& path) {
  if (!cell.has_simulation) throw ConfigError(path.string(), 0, kWithoutSimulation);
}

CellConfig LoadCell(const std::filesystem::path& path, const std::optional<ToolChoice>& tool,
                    const std::filesystem::path& gains, const std::filesystem::path& identified) {
  const Reader reader = Reader::LoadExtending(path, "cells");
  try {
    return ReadCell(reader, tool, gains, identified);
  } catch (const ConfigError& error) {
    if (reader.Extended().empty() || error.file() != reader.Extended().string()) throw;
    throw error.With(fmt::format(" ({} extends it: set the value there)", path.string()));
  }
}

}  // namespace osteon::config
