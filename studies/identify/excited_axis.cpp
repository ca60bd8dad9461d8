#include "studies/identify/excited_axis.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/SVD>
#include <nlohmann/json.hpp>

#include "base/percentile.h"
#include "config/reading/tool_mobility.h"
#include "kinematics/serial_chain.h"
#include "safety/watchdog.h"

namespace osteon::studies {
namespace {

// First words of the text of the event that records an excitation.
constexpr const char* kEvent = "excitation: ";
constexpr double kSpeedShare = 0.2, kAccelerationFactor = 2.0;  // factors on the joints' published limits
// Changes of the force that end a run: in free air, or with a hand at the handle.
constexpr double kFreeForce_N = 30.0, kHeldForce_N = 60.0;
constexpr double kMinSingular = 0.02;  // least singular value of the Jacobian along the axis
// Limits of the tool's motion while one joint moves.
constexpr double kToolSpeed_m_per_s = 0.1, kToolAcceleration_m_per_s2 = 8.0;

using Jacobian = Eigen::Matrix<double, 6, control::kJoints>;

// Jacobian of the tool's apex in W at the cell's start: rows of the velocity, then of the rotation. Columns
// beyond the arm's N joints are zero.
template <int N>
Jacobian JacobianOf(const kinematics::ChainParams<N>& chain, const config::CellConfig& cell) {
  const kinematics::SerialChain<N> arm(chain);
  const kinematics::JointVectorN<N> q = cell.start.q.template head<N>();
  const auto posture = arm.ComputePosture(q);
  const Vector3 p_B = posture.X_BF * cell.tool.X_FT.translation();
  const kinematics::JacobianN<N> J_B = arm.JacobianAt(posture, p_B);
  const Matrix3 R_WB = cell.X_WB.linear();
  Jacobian J_W = Jacobian::Zero();
  J_W.template topLeftCorner<3, N>() = R_WB * J_B.template topRows<3>();
  J_W.template bottomLeftCorner<3, N>() = R_WB * J_B.template bottomRows<3>();
  return J_W;
}

// The limits of each joint of the cell's arm.
std::vector<kinematics::JointLimits> LimitsOf(const config::CellConfig& cell) {
  std::vector<kinematics::JointLimits> limits;
  const auto take = [&](const auto& chain) {
    for (const auto& joint : chain.joints) limits.push_back(joint.limits);
  };
  if (const config::LbrConfig* lbr = cell.robot.lbr())
    take(lbr->chain);
  else
    take(cell.robot.six_axis()->chain);
  return limits;
}

// Lowers the path's speed and acceleration so that every joint keeps its factor of its limits (kSpeedShare,
// kAccelerationFactor).
void LimitPath(const std::vector<kinematics::JointLimits>& limits, control::ExcitedHoldParams& hold) {
  for (std::size_t j = 0; j < limits.size(); ++j) {
    const double per_m = std::abs(hold.direction[j]);  // joint motion per motion along the path
    if (!(per_m > 0.0)) continue;
    if (limits[j].velocity_rad_per_s > 0.0)
      hold.path.peak_speed_m_per_s =
          std::min(hold.path.peak_speed_m_per_s, kSpeedShare * limits[j].velocity_rad_per_s / per_m);
    if (limits[j].acceleration_rad_per_s2 > 0.0)
      hold.path.max_acceleration_m_per_s2 =
          std::min(hold.path.max_acceleration_m_per_s2,
                   kAccelerationFactor * limits[j].acceleration_rad_per_s2 / per_m);
  }
}

// The arm's impedance along the axis, from the cell's file. The force of an overlay is computed with it.
control::OverlayExcitation OverlayOf(const config::CellConfig& cell, const Vector3& axis_W) {
  const hil::DynamicArmParams& arm = cell.simulated.dynamic;
  control::OverlayExcitation overlay{.on = true, .stiffness_N_per_m = std::max(200.0, arm.stiffness_N_per_m)};
  if (const auto mobility = config::ToolMobility(cell)) {
    const Vector3 axis_B = cell.X_WB.linear().transpose() * axis_W;
    overlay.mass_kg = 1.0 / axis_B.dot(*mobility * axis_B);
  }
  overlay.damping_Ns_per_m =
      2.0 * arm.cartesian_damping_ratio * std::sqrt(overlay.stiffness_N_per_m * overlay.mass_kg);
  return overlay;
}

// Difference of the arm's sequence numbers between two consecutive messages.
int SequenceStep(const config::CellConfig& cell) {
  const io::RsiSessionParams* rsi = cell.link.rsi();
  return rsi ? rsi->ipoc_step : 1;
}

}  // namespace

int JointCount(const config::CellConfig& cell) { return static_cast<int>(LimitsOf(cell).size()); }

std::string EventText(const ExcitationRequest& request) {
  // The event of a joint has an empty axis, so that an older Osteon, which knows no joints, does not read the
  // event as that of an axis.
  nlohmann::ordered_json json{{"axis", request.joint > 0 ? std::string() : std::string(1, request.axis)},
                              {"peak_speed_m_per_s", request.peak_speed_m_per_s},
                              {"seed", request.seed},
                              {"draws", request.draws},
                              {"periods", request.periods},
                              {"held", request.held},
                              {"overlay", request.overlay},
                              {"rest_s", request.rest_s}};
  if (request.joint > 0) json["joint"] = request.joint;
  return kEvent + json.dump();
}

std::optional<ExcitationRequest> ParseEvent(const std::string& text) {
  if (!text.starts_with(kEvent)) return {};
  const auto json = nlohmann::json::parse(text.substr(std::string(kEvent).size()), nullptr, false);
  if (!json.is_object()) return {};
  try {
    const auto axis = json.at("axis").get<std::string>();
    const int joint = json.value("joint", 0);  // absent: an axis is excited
    const bool is_axis = axis == "x" || axis == "y" || axis == "z";
    if (is_axis ? joint != 0 : !axis.empty() || joint < 1 || joint > control::kJoints) return {};
    return ExcitationRequest{.axis = is_axis ? axis[0] : 'z',
                             .peak_speed_m_per_s = json.at("peak_speed_m_per_s").get<double>(),
                             .seed = json.at("seed").get<std::uint64_t>(),
                             .draws = json.at("draws").get<int>(),
                             .periods = json.at("periods").get<int>(),
                             .held = json.at("held").get<bool>(),
                             // absent in recordings older than the excitation by overlay
                             .overlay = json.value("overlay", false),
                             .rest_s = json.at("rest_s").get<double>(),
                             .joint = joint};
  } catch (const nlohmann::json::exception&) {
    return {};  // the file's text may be anything
  }
}

namespace {

// Sets the joints' motion to the smallest one that moves the apex along the axis without rotation.
// @returns an error at a singular posture
tl::expected<void, std::string> AimAlongAxis(const Jacobian& J, control::ExcitedHoldParams& hold) {
  Eigen::Matrix<double, 6, 1> motion = Eigen::Matrix<double, 6, 1>::Zero();
  motion.head<3>() = hold.axis_W;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  if (!(svd.singularValues()[5] >= kMinSingular))
    return tl::unexpected(
        fmt::format("the start's posture is singular: found a least singular value of {:.3g} m, "
                    "accepted {:g} m or more",
                    svd.singularValues()[5], kMinSingular));
  const Eigen::VectorXd direction = svd.solve(motion);
  for (std::size_t j = 0; j < hold.direction.size(); ++j)
    hold.direction[j] = direction[static_cast<Eigen::Index>(j)];
  return {};
}

// Sets the motion to that of one joint alone. @param joint  1 … kJoints
void AimAtJoint(int joint, control::ExcitedHoldParams& hold) {
  hold.joint = joint - 1;
  hold.direction[static_cast<std::size_t>(hold.joint)] = 1.0;
  hold.path.max_travel_m = kMaxJointTravel_rad;
  // A tool on the joint's axis would not move at all: use a minimum, to avoid a division by zero.
  const double tool_m_per_rad = std::max(1e-3, hold.J_W.col(hold.joint).norm());
  hold.path.peak_speed_m_per_s = std::min(hold.path.peak_speed_m_per_s, kToolSpeed_m_per_s / tool_m_per_rad);
  hold.path.max_acceleration_m_per_s2 = kToolAcceleration_m_per_s2 / tool_m_per_rad;
}

}  // namespace

tl::expected<ExcitedAxis, std::string> ExcitedAxisOf(const config::CellConfig& cell,
                                                     const ExcitationRequest& request) {
  const std::vector<kinematics::JointLimits> limits = LimitsOf(cell);
  if (request.joint > static_cast<int>(limits.size()))
    return tl::unexpected(fmt::format("found joint A{}, accepted A1 … A{}", request.joint, limits.size()));
  const Jacobian J = cell.robot.lbr() ? JacobianOf(cell.robot.lbr()->chain, cell)
                                      : JacobianOf(cell.robot.six_axis()->chain, cell);
  ExcitedAxis axis;
  control::ExcitedHoldParams& hold = axis.hold;
  hold.axis_W = cell.start.X_WT.linear().col(request.axis - 'x');
  hold.J_W = J.topRows<3>();
  hold.path = {.seed = request.seed,
               .draws = request.draws,
               .periods = request.periods,
               .peak_speed_m_per_s = request.peak_speed_m_per_s,
               .pause_s = cell.start.path.pause_s};
  if (request.joint > 0)
    AimAtJoint(request.joint, hold);
  else if (auto aimed = AimAlongAxis(J, hold); !aimed)
    return tl::unexpected(std::move(aimed.error()));
  for (std::size_t j = 0; j < axis.q_start.size(); ++j)
    axis.q_start[j] = cell.start.q[static_cast<Eigen::Index>(j)];
  LimitPath(limits, hold);
  hold.period_s = cell.servo.period_s;
  hold.sequence_step = SequenceStep(cell);
  hold.max_force_N = request.held ? kHeldForce_N : kFreeForce_N;
  hold.max_sensor_age_s = cell.servo.watchdog.sensor_stop_s;
  hold.has_interlock = cell.servo.has_interlock;
  hold.rests_only = request.rest_s > 0.0;
  if (hold.rests_only) hold.wait_s = request.rest_s;
  if (request.overlay) hold.overlay = OverlayOf(cell, hold.axis_W);
  axis.axis_T = Vector3::Unit(request.axis - 'x');
  const Pose X_TS = cell.tool.X_FT.inverse() * Pose(cell.servo.sensor.X_FS);
  axis.axis_S = (cell.start.X_WT.linear() * X_TS.linear()).transpose() * hold.axis_W;
  return axis;
}

void AddExcitation(const ExcitedAxis& axis, const control::ExcitedHoldStep& step,
                   control::CommandMode command_mode, control::ArmCommand& command) OSTEON_RT {
  for (std::size_t j = 0; j < command.q.size(); ++j) command.q[j] += step.offset[j];
  if (step.f_N == 0.0) return;
  if (command_mode == control::CommandMode::kWrench) {
    const Wrench F = command.F;
    command.F = Wrench{.f = F.f + step.f_N * axis.axis_T, .t = F.t};
  }
  if (command_mode == control::CommandMode::kTorque)
    for (std::size_t j = 0; j < command.tau.size(); ++j)
      command.tau[j] += step.f_N * axis.hold.J_W.col(static_cast<Eigen::Index>(j)).dot(axis.hold.axis_W);
}

control::ExcitedTick ExcitedTickOf(const control::TickRecord& record) {
  const control::TickInput& in = record.input;
  return {
      .received = in.received == static_cast<std::uint8_t>(control::ReceiveResult::kOk),
      .sequence = in.sequence,
      .activation = in.activation,
      .active = record.session_state == static_cast<std::uint8_t>(control::SessionState::kCommandingActive),
      .lost = in.lost,
      .answers_lost = in.answers_lost,
      .q_meas = record.q_meas,
      .q_hold = record.q_cmd,
      .force_S_N = in.F_sensor_S.f,
      .sensor_age_s = record.sensor_age_s,
      .sensor_trusted = in.sensor_trusted,
      .permitted = in.permitted && in.enabled,
      .state = static_cast<safety::CellState>(record.cell_state)};
}

namespace {

// Which messages the arm got an answer to. Stores the messages in order, and the losses that the arm reports.
class AnswerLog {
 public:
  explicit AnswerLog(ExcitedRun& run) : run_(run) {}

  // Adds a message, whose sample is the newest. @param lost  number of answers that were lost since the
  // previous message
  void Add(std::uint32_t lost) {
    // The answer to the previous message has arrived. The lost answers are those directly before it.
    for (std::size_t i = 0; i < lost && i + 1 < answered_.size(); ++i)
      lost_.push_back(answered_[answered_.size() - 2 - i]);
    answered_.push_back(run_.samples.size() - 1);
  }

  // Replaces each command that never arrived by the command that the arm still held.
  void HoldLost() {
    std::vector<bool> is_lost(run_.samples.size(), true);  // a message that never came has no answer
    for (const std::size_t at : answered_) is_lost[at] = false;
    for (const std::size_t at : lost_) is_lost[at] = true;
    for (std::size_t i = 1; i < run_.samples.size(); ++i)
      if (is_lost[i]) run_.samples[i].u_m = run_.samples[i - 1].u_m;
  }

 private:
  ExcitedRun& run_;
  std::vector<std::size_t> answered_, lost_;  // indices of samples
};

// Joint speeds between two consecutive ticks [rad/s].
Eigen::Matrix<double, 7, 1> SpeedOf(const control::TickRecord& before, const control::TickRecord& now,
                                    double period_s) {
  Eigen::Matrix<double, 7, 1> speed;
  for (Eigen::Index j = 0; j < 7; ++j) {
    const auto at = static_cast<std::size_t>(j);
    speed[j] = (now.q_meas[at] - before.q_meas[at]) / period_s;
  }
  return speed;
}

// Fills in mean and 99th percentile of the messages' lateness.
// @param arrivals_s  arrival time of each message  @param steps  number of periods until that message,
// including lost messages
void FillJitter(std::vector<double> arrivals_s, double period_s, const std::vector<double>& steps,
                ExcitedSamples& samples) {
  if (arrivals_s.empty()) return;
  for (std::size_t i = 0; i < arrivals_s.size(); ++i) arrivals_s[i] -= period_s * steps[i];
  // The clocks of arm and host drift apart slowly, so lateness is measured relative to the earliest of each
  // 1000 messages.
  constexpr std::size_t kBlock = 1000;
  std::vector<double> late_s;
  for (std::size_t begin = 0; begin < arrivals_s.size(); begin += kBlock) {
    const auto first = arrivals_s.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last =
        arrivals_s.begin() + static_cast<std::ptrdiff_t>(std::min(begin + kBlock, arrivals_s.size()));
    const double earliest_s = *std::min_element(first, last);
    for (auto at = first; at != last; ++at) late_s.push_back(*at - earliest_s);
  }
  for (const double late : late_s) samples.jitter_mean_s += late / static_cast<double>(late_s.size());
  samples.jitter_p99_s = base::LowerPercentile(late_s, 0.99);
}

}  // namespace

tl::expected<ExcitedSamples, std::string> SamplesOf(const std::vector<control::TickRecord>& ticks,
                                                    const ExcitedAxis& axis) {
  ExcitedSamples samples{.run = {.period_s = axis.hold.period_s, .samples = {}}};
  control::ExcitedHold hold(axis.hold);
  AnswerLog answers(samples.run);
  std::vector<double> arrivals_s, steps;
  std::uint32_t sequence = 0, lost_before = 0;
  bool begun = false;
  // for the RMS of the joint speeds: sum of squares, and number of summed ticks
  Eigen::Matrix<double, 7, 1> squares = Eigen::Matrix<double, 7, 1>::Zero();
  double counted = 0.0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (i > 0 && ticks[i].tick != ticks[i - 1].tick + 1)
      return tl::unexpected(fmt::format("found tick {} after {}, accepted a recording without gaps",
                                        ticks[i].tick, ticks[i - 1].tick));
    const control::ExcitedTick tick = ExcitedTickOf(ticks[i]);
    const control::ExcitedHoldStep step = hold.Step(tick);
    samples.abort = step.abort;
    if (!tick.received || !step.excites) {
      if (begun && tick.received) break;
      sequence = tick.sequence;
      lost_before = tick.answers_lost;
      continue;
    }
    const auto sequence_step_seen = static_cast<std::int32_t>(tick.sequence - sequence);
    if (begun && sequence_step_seen <= 0)
      return tl::unexpected(
          fmt::format("found message {} after {}, accepted rising numbers: a link's trouble, see "
                      "osteon doctor",
                      tick.sequence, sequence));
    // A message that never came gets a sample that repeats the previous one and is marked as unseen.
    const int missing = begun ? sequence_step_seen / axis.hold.sequence_step - 1 : 0;
    for (int gap = 0; gap < missing; ++gap) {
      ExcitedSample unseen = samples.run.samples.back();
      unseen.seen = false;
      samples.run.samples.push_back(unseen);
    }
    samples.run.samples.push_back(
        {.seen = true,
         .u_m = axis.hold.overlay.on ? step.f_N / axis.hold.overlay.stiffness_N_per_m : step.x_m,
         .y_m = step.y_m,
         .f_N = axis.axis_S.dot(tick.force_S_N),
         .counted = step.path.part == control::ExcitationPart::kCounted,
         .draw = step.path.draw,
         .period = step.path.period});
    answers.Add(tick.answers_lost - lost_before);
    if (begun && sequence_step_seen == axis.hold.sequence_step && samples.run.samples.back().counted) {
      squares += SpeedOf(ticks[i - 1], ticks[i], axis.hold.period_s).cwiseAbs2();
      ++counted;
    }
    arrivals_s.push_back(1e-9 * static_cast<double>(ticks[i].input.arm_stamp));
    steps.push_back(static_cast<double>(samples.run.samples.size()));
    samples.lost_messages += static_cast<std::uint32_t>(missing);
    samples.lost_answers += tick.answers_lost - lost_before;
    if (!begun)
      for (std::size_t j = 0; j < axis.q_start.size(); ++j)
        samples.start_error_rad =
            std::max(samples.start_error_rad, std::abs(tick.q_hold[j] - axis.q_start[j]));
    begun = true;
    sequence = tick.sequence;
    lost_before = tick.answers_lost;
  }
  samples.messages = static_cast<std::uint32_t>(samples.run.samples.size());
  if (counted > 0.0) samples.joint_rms_rad_per_s = (squares / counted).cwiseSqrt();
  answers.HoldLost();
  FillJitter(std::move(arrivals_s), axis.hold.period_s, steps, samples);
  return samples;
}

}  // namespace osteon::studies
