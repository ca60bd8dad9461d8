#include "tests/property/wild_cell.h"

#include <algorithm>

#include <fmt/format.h>

#include "config/reading/load_robot.h"
#include "kinematics/payload.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::property {
namespace {

using control::JointArray;
using control::SessionState;

constexpr double kTool_m = 0.2;  // from the flange to the tool's apex
constexpr double kSpindle_rad_per_s = 26.0;
// Distance by which a lagging arm cuts the corners of the commanded joint path: (0.25 m/s × 30 ms)^2 over a
// reach of 1 m is 60 um.
constexpr double kLag_m = 1e-3;

// Start postures [rad]: ready, stretched, folded, near the limits of two joints, near a singularity of the
// wrist.
constexpr std::array<JointArray, 5> kStarts{{{0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2},
                                             {-0.4, 0.9, 0.2, -0.35, 0.3, 0.6, -0.5},
                                             {0.3, 0.2, -0.1, -2.0, 0.2, 1.0, 0.4},
                                             {0.0, 0.5, 0.0, -1.4, 2.93, 0.9, 3.02},
                                             {0.2, 0.7, -0.2, -1.2, 0.4, 0.02, 0.1}}};

// One set of limits; an elbow speed of 0 is no limit.
struct LimitChoice {
  double speed_m_per_s, force_N, torque_Nm, elbow_m_per_s;
};
constexpr std::array<LimitChoice, 4> kLimits{
    {{0.25, 200.0, 20.0, 0.0}, {0.5, 150.0, 20.0, 0.0}, {0.1, 20.0, 2.0, 0.25}, {0.25, 200.0, 20.0, 0.05}}};

Pose FlangeToTool() {
  Pose X_FT = Pose::Identity();
  X_FT.translation().z() = kTool_m;
  return X_FT;
}

// The arm with its masses and a tool of 2 kg.
const kinematics::ChainParams<7>& ArmWithPayload() {
  static const auto body = kinematics::WithPayload(
      std::get<kinematics::ChainParams<7>>(
          config::LoadRobot(OSTEON_SOURCE_DIR "/config/robots/lbr_iiwa_14_r820.yaml").chain),
      {.mass_kg = 2.0, .p_LLcm_m = {0.0, 0.0, 0.08}, .I_LLcm_kg_m2 = 0.004 * Matrix3::Identity()});
  return body;
}

const JointArray& StartOf(const Choice& choice) { return kStarts[static_cast<std::size_t>(choice.start)]; }

// The limits of the chosen cell. The workspace lies around the tool's place at the start.
CaseLimits CaseLimitsOf(const Choice& choice) {
  const ArmPoints start = PointsOfIiwa(StartOf(choice), kTool_m);
  const LimitChoice& limits = kLimits[static_cast<std::size_t>(choice.limits)];
  CaseLimits allowed;
  allowed.law = choice.law < 2 ? control::Law::kAdmittance : control::Law::kImpedance;
  allowed.joints = kinematics::Iiwa14().limits;
  allowed.speed_m_per_s = limits.speed_m_per_s;
  allowed.force_N = limits.force_N;
  allowed.torque_Nm = limits.torque_Nm;
  allowed.elbow_speed_m_per_s = limits.elbow_m_per_s;
  allowed.spindle_rad_per_s = (choice.devices & 1) != 0 ? kSpindle_rad_per_s : 0.0;
  allowed.tool_m = kTool_m;
  if (choice.law >= 1) allowed.body = &ArmWithPayload();
  allowed.sphere_m = start.p_tool_m;
  allowed.radius_m = 0.2;
  allowed.floor_m = start.p_tool_m.z() - 0.2;
  switch (choice.workspace) {
    case 1:  // a bound directly in front of the tool
      allowed.sphere_m -= 0.019 * start.R_flange.col(2);
      allowed.radius_m = 0.02;
      break;
    case 2:  // a corner
      allowed.radius_m = 0.004;
      allowed.floor_m = start.p_tool_m.z() - 0.001;
      break;
    case 3:  // a bound on the flange as well
      allowed.radius_m = 0.05;
      allowed.flange_floor_m = start.p_flange_m.z() - 0.001;
      break;
    case 4:
    case 5:
      allowed.zone = ZoneOf(choice.zone, start);
      break;
    default:
      break;
  }
  return allowed;
}

// Sets the loop's own limits to those that the oracle checks.
control::ServoParams ParamsOf(const Choice& choice, const CaseLimits& allowed) {
  control::ServoParams params;
  params.law = allowed.law;
  params.joints.limits = allowed.joints;
  params.twist.max_speed_m_per_s = allowed.speed_m_per_s;
  // With the default sight, the age of the simulation's frames would limit the tool to 0.25 m/s.
  if (allowed.speed_m_per_s > 0.25) params.model_sight_m = 2e-3;
  params.wrench = {.max_force_N = allowed.force_N, .max_torque_Nm = allowed.torque_Nm};
  params.workspace.sphere_center_W_m = allowed.sphere_m;
  params.workspace.sphere_radius_m = allowed.radius_m;
  params.workspace.plane_offset_m = allowed.floor_m;
  if (choice.workspace == 3)
    params.workspace.zones.push_back(
        {.point = safety::ZonePoint::kFlange, .p_W_m = Vector3(0.0, 0.0, allowed.flange_floor_m)});
  if (allowed.zone) params.workspace.zones.push_back(*allowed.zone);
  if (allowed.elbow_speed_m_per_s > 0.0) params.max_elbow_speed_m_per_s = allowed.elbow_speed_m_per_s;
  params.spindle_rad_per_s = allowed.spindle_rad_per_s;
  params.has_spindle = (choice.devices & 1) != 0;
  params.has_interlock = (choice.devices & 2) != 0;
  if (allowed.body) params.arm_body = *allowed.body;
  if (choice.law >= 2) params.coupling.max_stiffness_N_per_m = 10e3;
  params.coupling.ramp_s = 0.002;  // instead of 0.1 s: a case lasts 0.05 s
  return params;
}

control::ServoLoop LoopOf(const Choice& choice, const CaseLimits& allowed) {
  const kinematics::LbrArm arm(kinematics::Iiwa14());
  return {ParamsOf(choice, allowed), arm, Pose::Identity(), FlangeToTool(),
          arm.ArmAngle(Eigen::Map<const kinematics::JointVector>(StartOf(choice).data()))};
}

std::unique_ptr<hil::SimulatedArm> ArmOf(const Choice& choice, hil::ArmLevel level) {
  hil::SimulatedArmParams params{.level = level, .lbr = kinematics::Iiwa14()};
  if (level == hil::ArmLevel::kDynamic) params.chain = ArmWithPayload();
  params.p_FT_m = FlangeToTool().translation();
  params.q_start = Eigen::Map<const kinematics::JointVector>(StartOf(choice).data());
  return hil::MakeSimulatedArm(params, 1e-3);
}

}  // namespace

void showValue(const Choice& s, std::ostream& out) {
  out << fmt::format("law {} start {} workspace {} limits {} devices {} mode {}", s.law, s.start, s.workspace,
                     s.limits, s.devices, s.mode);
  if (s.workspace >= 4) showValue(s.zone, out << " zone ");
}

rc::Gen<Choice> AnyChoice() {
  // any of 0 … count - 1, in every case: resize makes inRange use its whole range at once
  const auto one_of = [](int count) { return rc::gen::resize(100, rc::gen::inRange(0, count)); };
  return rc::gen::build<Choice>(
      rc::gen::set(&Choice::law, one_of(4)), rc::gen::set(&Choice::start, one_of(5)),
      rc::gen::set(&Choice::workspace, one_of(6)), rc::gen::set(&Choice::limits, one_of(4)),
      rc::gen::set(&Choice::devices, one_of(4)), rc::gen::set(&Choice::mode, one_of(2)),
      rc::gen::set(&Choice::zone, AnyZone(0, 3)));
}

WildCell::WildCell(const Choice& choice, hil::ArmLevel level)
    : allowed_(CaseLimitsOf(choice)),
      loop_(LoopOf(choice, allowed_)),
      oracle_(allowed_),
      arm_(ArmOf(choice, level)) {
  state_.q_meas = state_.q_ipo = StartOf(choice);
  state_.has_ipo = true;
  state_.activation = 1;
  state_.command_mode = choice.law == 2   ? control::CommandMode::kWrench
                        : choice.law == 3 ? control::CommandMode::kTorque
                                          : control::CommandMode::kPosition;
  state_.operation_mode = 2;
  drive_.control = choice.law == 2   ? control::ControlMode::kCartesianImpedance
                   : choice.law == 3 ? control::ControlMode::kJointImpedance
                                     : control::ControlMode::kPosition;
  state_.control_mode = drive_.control;
  if (choice.mode == 1) operation_mode_ = 0;
  drive_.q_cmd = arm_->q();
  const ArmPoints start = PointsOfIiwa(StartOf(choice), kTool_m);
  feed_W_ = start.R_flange.col(2);
  plane_W_m_ = start.p_tool_m + 0.002 * feed_W_;
  contact_.n_W = Vector3(-feed_W_);
  contact_.stiffness_N_per_m = 10e3;
}

// Sets this tick's inputs to those of a cell without errors, except for lasting conditions.
void WildCell::SetNormalInputs() {
  clock_ += rt::kMillisecond;
  now_ = clock_;
  received_ = control::ReceiveResult::kOk;
  asked_ = {};
  state_.stamp = now_;
  ++state_.sequence;
  state_.session = session_;
  state_.period_s = allowed_.period_s;
  state_.safety_state = 0;
  state_.operation_mode = operation_mode_;
  state_.quality = 3;
  state_.drives_active = true;
  state_.tau_ext = {};
  std::copy_n(arm_->q().data(), 7, state_.q_meas.begin());
  if (session_ != SessionState::kCommandingActive) state_.q_ipo = state_.q_meas;
  if (sensor_lives_) readings_.force = {.stamp = now_, .F_S = push_S_};
  readings_.spindle = {
      .stamp = now_, .speed_rad_per_s = loop_.cell_commands().spindle_rad_per_s, .ready = true};
  readings_.interlock = {
      .stamp = now_, .permitted = plc_permits_, .enabled = plc_permits_, .spindle_permitted = plc_permits_};
  if (simulation_lives_ && ticks_ % 2 == 0) {
    const simulation::ToolCommand seen = loop_.tool_command();
    model_ = {};
    model_.frame = static_cast<std::uint64_t>(ticks_ + 1);
    model_.pose_stamp = seen.stamp > 0 ? seen.stamp : now_;
    model_.X_WP = seen.X_WT;
    model_.contact_count = 1;
    model_.contacts[0] = contact_;
    model_.contacts[0].p_W_m = plane_W_m_;
    model_.contacts[0].gap_m = feed_W_.dot(plane_W_m_ - Vector3(seen.X_WT.p));
  }
}

// Operations 20 … 31: errors of the arm's message and session.
void WildCell::DisturbArm(const Op& op) {
  const auto joint = static_cast<std::size_t>(op.which);
  switch (op.what) {
    case 20:
      state_.q_meas[joint] = op.value;
      arm_lied_ = true;
      break;
    case 21:
      state_.q_meas[joint] += 0.01 * op.value;
      arm_lied_ = true;
      break;
    case 22:
      state_.q_ipo[joint] += 0.01 * op.value;
      arm_lied_ = true;
      break;
    case 23:
      received_ = op.which == 0 ? control::ReceiveResult::kClosed : control::ReceiveResult::kTimeout;
      break;
    case 24:
      session_ = state_.session = static_cast<SessionState>(op.which % 5);
      if (op.which == 4) ++state_.activation;
      break;
    case 25:
      state_.period_s = op.value;
      break;
    case 26:
      state_.safety_state = static_cast<std::uint8_t>(op.which);
      break;
    case 27:
      state_.command_mode = static_cast<control::CommandMode>(op.which);
      break;
    case 28:
      state_.operation_mode = static_cast<std::uint8_t>(op.which % 3);
      break;
    case 29:
      state_.sequence += static_cast<std::uint32_t>(1 << 5 * op.which);
      break;
    case 30:
      state_.has_ipo = !state_.has_ipo;
      break;
    case 31:
      state_.activation += static_cast<std::uint32_t>(op.which);
      break;
    default:
      break;
  }
}

// Operations 32 … 43: errors of the simulation's contact model.
void WildCell::DisturbModel(const Op& op) {
  simulation::Contact& contact = model_.contacts[static_cast<std::size_t>(op.which)];
  switch (op.what) {
    case 32:
      plane_W_m_ += 1e-3 * std::clamp(op.value, -10.0, 10.0) * feed_W_;
      break;
    case 33:
      contact.n_W = Vector3(op.value, 0.5, -op.value);
      model_.contact_count = op.which + 1;
      break;
    case 34:
      contact.stiffness_N_per_m = 1e4 * op.value;
      break;
    case 35:
      contact.p_W_m.x = op.value;
      break;
    case 36:
      contact.p_TP_m.z = op.value;
      break;
    case 37:
      contact.mu = op.value;
      break;
    case 38:
      contact.advance_m_per_s = op.value;
      break;
    case 39:
      model_.contact_count = op.which == 0 ? -1 : 3 * op.which;
      break;
    case 40:
      simulation_lives_ = !simulation_lives_;
      break;
    case 41:
      model_.status = static_cast<simulation::EngineStatus>(op.which % 4);
      break;
    case 42:
      model_.pose_stamp -= static_cast<rt::Nanoseconds>(op.which) * 50 * rt::kMillisecond;
      break;
    case 43:
      model_.X_WP.p.x = op.value;
      model_.X_WP.R[0] = op.value;
      break;
    default:
      break;
  }
}

// Operations 6 … 19: errors of sensor, PLC, spindle and clock; the operator's requests and changes of gains.
void WildCell::DisturbDevices(const Op& op) {
  switch (op.what) {
    case 10:
      sensor_lives_ = !sensor_lives_;
      break;
    case 11:
      readings_.force.trusted = false;
      break;
    case 12:
      (op.which < 3 ? readings_.force.F_S.f : readings_.force.F_S.t) = Vector3::Constant(op.value);
      break;
    case 13:
      plc_permits_ = !plc_permits_;
      break;
    case 14:
      readings_.spindle.speed_rad_per_s = op.value;
      readings_.spindle.torque_Nm = op.value;
      readings_.spindle.fault = op.which == 6;
      break;
    case 15: {
      control::Gains gains = control::GainsOf({}, {});
      gains.max_stiffness_N_per_m = 5e3;
      (op.which < 3 ? gains.mass_kg : gains.damping_Ns_per_m) = Vector3::Constant(op.value);
      try {
        loop_.RequestGains(gains);
      } catch (const std::invalid_argument&) {
        // the request itself refuses these gains, so the loop never gets them
      }
      break;
    }
    case 16:
      if (op.which == 0) loop_.RequestStop();
      break;
    case 6:  // a jump of the estimated external torque, in a single tick
      state_.tau_ext[static_cast<std::size_t>(op.which)] = 10.0 * op.value;
      break;
    case 7:  // a lasting change of the estimated external torque
      operation_mode_ = state_.operation_mode = static_cast<std::uint8_t>(op.which % 3);
      break;
    case 8:
      asked_.pause = true;
      loop_.RequestPause();
      break;
    case 9:
      asked_.resume = true;
      loop_.RequestResume();
      break;
    case 17:
      asked_.recover = true;
      loop_.RequestRecovery();
      break;
    case 18:  // a lasting jump of the clock, in either direction
      clock_ += std::isnan(op.value) ? -rt::kSecond
                                     : static_cast<rt::Nanoseconds>(std::clamp(op.value, -1e3, 1e3) * 1e6);
      now_ = clock_;
      break;
    case 19:
      now_ += static_cast<rt::Nanoseconds>(op.which - 3) * rt::kSecond;
      break;
    default:
      break;
  }
}

void WildCell::Disturb(const Op& op) {
  if (op.what >= kPushes) {  // the hand: pushes anywhere, harder than some cells permit
    (op.which < 6 ? push_S_.f : push_S_.t)[op.which % 3] =
        std::clamp(100.0 * op.value, -240.0, 240.0) * (op.which < 6 ? 1.0 : 0.05);
    return;
  }
  DisturbDevices(op);
  DisturbArm(op);
  DisturbModel(op);
}

// Steps the arm with the loop's command. As the real link does, the arm ignores a command that names another
// activation than the arm's own.
void WildCell::MoveArm() {
  if (session_ == SessionState::kCommandingActive && received_ == control::ReceiveResult::kOk &&
      command_.activation == state_.activation) {
    drive_.q_cmd = Eigen::Map<const kinematics::JointVector>(command_.q.data());
    drive_.tau_Nm = Eigen::Map<const kinematics::JointVector>(command_.tau.data());
    const Matrix3 R_BT = PointsOfIiwa(state_.q_meas, kTool_m).R_flange;
    drive_.F_T_B = {.f = R_BT * Vector3(command_.F.f), .t = R_BT * Vector3(command_.F.t)};
  } else {
    drive_.tau_Nm.setZero();
    drive_.F_T_B = {};
  }
  arm_->Step(drive_, {});
}

// Checks that the simulated arm itself stays within workspace and joint limits, up to its lag. An arm that
// sent false positions is not checked. @returns the violation; empty if there is none
std::string WildCell::CheckArmPlace() const {
  if (arm_lied_ || allowed_.law != control::Law::kAdmittance) return {};
  JointArray q{};
  std::copy_n(arm_->q().data(), 7, q.begin());
  const ArmPoints points = PointsOfIiwa(q, kTool_m);
  const double out_m = std::max((points.p_tool_m - allowed_.sphere_m).norm() - allowed_.radius_m,
                                allowed_.floor_m - points.p_tool_m.z());
  if (!(out_m <= kLag_m)) return fmt::format("the arm's tool is {} m outside", out_m);
  for (std::size_t i = 0; i < 7; ++i)
    if (!(q[i] >= allowed_.joints[i].lower_rad && q[i] <= allowed_.joints[i].upper_rad))
      return fmt::format("the arm's joint {} is at {} rad", i + 1, q[i]);
  return {};
}

std::string WildCell::Tick(const Op& op) {
  SetNormalInputs();
  Disturb(op);
  oracle_.BeforeTick(loop_, state_, received_, asked_);
  const control::TickRecord record = loop_.Tick(
      {.state = state_, .received = received_, .readings = readings_, .model = model_, .now = now_},
      command_);
  ++ticks_;
  if (std::string wrong = oracle_.AfterTick(loop_, record, command_); !wrong.empty()) return wrong;
  MoveArm();
  return CheckArmPlace();
}

}  // namespace osteon::property
