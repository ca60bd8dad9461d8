#include "studies/transparency/handle_bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "control/loop/servo_loop.h"
#include "hil/arm/sensor_load.h"
#include "kinematics/lbr_arm.h"

namespace osteon::studies {
namespace {

using kinematics::JointVector;

constexpr double kTau = 2.0 * std::numbers::pi;

// Throws std::invalid_argument unless low <= value <= high.
void Require(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw std::invalid_argument(std::string("handle ") + name + ": found " + base::NumberText(value) +
                                ", accepted " + base::NumberText(low) + " … " + base::NumberText(high));
}

// Result of fitting bias, drift, sine and cosine to a uniformly sampled signal by least squares, and the
// residual.
struct SineFit {
  std::complex<double> phasor;  // fitted value = Re(phasor exp(i w t))
  double residual_rms{0.0};
};

// Fits the values with index `first` and later. @param w  angular frequency [rad/s]
SineFit FitSine(const std::vector<double>& values, double w, double dt_s, std::size_t first) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right_side = Eigen::Vector4d::Zero();
  const double span_s = static_cast<double>(values.size()) * dt_s;
  const auto row = [&](std::size_t i) {
    const double t = static_cast<double>(i) * dt_s;
    return Eigen::Vector4d(1.0, t / span_s, std::cos(w * t), -std::sin(w * t));
  };
  for (std::size_t i = first; i < values.size(); ++i) {
    const Eigen::Vector4d a = row(i);
    normal += a * a.transpose();
    right_side += values[i] * a;
  }
  const Eigen::Vector4d coefficients = normal.ldlt().solve(right_side);
  SineFit fit{.phasor = {coefficients[2], coefficients[3]}};
  double sum = 0.0;
  for (std::size_t i = first; i < values.size(); ++i)
    sum += std::pow(values[i] - row(i).dot(coefficients), 2);
  fit.residual_rms = std::sqrt(sum / static_cast<double>(values.size() - first));
  return fit;
}

}  // namespace

HandlePoint Shake(const HandleBenchParams& params, const HandleShake& shake,
                  const std::optional<HandleWall>& wall) {
  Require("axis", shake.axis, 0, 5);
  Require("frequency_hz", shake.frequency_hz, 1e-3, 0.45 / params.servo.period_s);
  Require("amplitude", shake.amplitude, 1e-6, 1e3);
  Require("periods", shake.periods, 1, 1000);
  Require("settle_periods", shake.settle_periods, 0, 1000);
  Require("sensor_delay_ticks", params.sensor_delay_ticks, 0, 100);

  control::ServoParams servo = params.servo;
  servo.has_spindle = servo.has_interlock = false;
  servo.start.reset();
  if (!params.sensor_feels_inertia) servo.sensor = {};
  servo.vibration.acts = false;  // the vibration index would treat the shaking as vibration and damp it
  const kinematics::LbrArm arm(params.arm.lbr);
  control::ServoLoop loop(servo, arm, params.X_WB, params.X_FT, params.arm_angle_rad);
  const auto body = hil::MakeSimulatedArm(params.arm, servo.period_s);

  const double dt_s = servo.period_s, w = kTau * shake.frequency_hz;
  const auto period_ns = static_cast<rt::Nanoseconds>(std::lround(1e9 * dt_s));
  const double settle_s = std::max(shake.min_settle_s, shake.settle_periods / shake.frequency_hz);
  const auto first = static_cast<std::size_t>(std::lround(settle_s / dt_s));
  const auto count =
      first + static_cast<std::size_t>(std::lround(shake.periods / (shake.frequency_hz * dt_s)));

  const auto tool_pose = [&] {
    return params.X_WB * body->X_BBnow() * arm.FlangePose(body->q()) * params.X_FT;
  };
  const Pose X_WT_start = tool_pose();
  const Pose X_TF = params.X_FT.inverse();
  const Vector3 u_W = X_WT_start.linear().col(shake.axis % 3);
  const bool turns = shake.axis >= 3;  // the load is a torque about the axis, not a force along it

  simulation::ContactModel model;
  if (wall) {
    model.contact_count = 1;
    model.contacts[0].p_W_m = X_WT_start.translation();
    model.contacts[0].n_W = Vector3(-X_WT_start.linear().col(2));
    model.contacts[0].stiffness_N_per_m = wall->stiffness_N_per_m;
  }
  control::ArmState state;
  state.session = control::SessionState::kCommandingActive;
  state.period_s = dt_s;
  state.has_ipo = true;
  control::ArmCommand command;
  struct Load {
    Wrench F_T_W;
    Twist V_WT, A_WT;  // motion of the tool, since the sensor measures the tool's inertia
  };
  std::vector<Load> loads(static_cast<std::size_t>(params.sensor_delay_ticks) + 1);  // newest first
  const auto tool_twist = [&]() -> Twist {
    const Eigen::Matrix<double, 6, 1> V_B = arm.JacobianAt(body->q(), params.X_FT.translation()) * body->qd();
    return {.v = params.X_WB.linear() * V_B.head<3>(), .w = params.X_WB.linear() * V_B.tail<3>()};
  };
  Twist V_WT_before;
  std::vector<double> motion;
  motion.reserve(count);
  HandlePoint point;
  point.frequency_hz = shake.frequency_hz;
  for (std::size_t i = 0; i < count; ++i) {
    // Store the tool's motion since the start, along or about the shaken axis.
    const Pose X_WT = tool_pose();
    const Vector3 d_W = X_WT.translation() - X_WT_start.translation();
    const Eigen::AngleAxisd turn(X_WT.linear() * X_WT_start.linear().transpose());
    motion.push_back(u_W.dot(turns ? Vector3(turn.angle() * turn.axis()) : d_W));

    // Compute the hand's wrench, and the sensor's reading of the load sensor_delay_ticks ago.
    const double value = shake.bias + shake.amplitude * std::cos(w * static_cast<double>(i) * dt_s);
    Wrench F_T_W;
    (turns ? F_T_W.t : F_T_W.f) = value * u_W;
    std::rotate(loads.begin(), loads.end() - 1, loads.end());
    const Twist V_WT = tool_twist(), V_before = i == 0 ? V_WT : V_WT_before;
    V_WT_before = V_WT;
    loads.front() = {F_T_W, V_WT, {.v = (V_WT.v - V_before.v) / dt_s, .w = (V_WT.w - V_before.w) / dt_s}};
    const Pose X_WF = X_WT * X_TF;
    const Load& felt = loads.back();
    Wrench F_S = hil::SensorLoad(servo.sensor, X_WT, X_WF, felt.F_T_W);
    if (params.sensor_feels_inertia)
      F_S = hil::SubtractInertia(servo.sensor, F_S,
                                 {.X_WT = X_WT, .X_WF = X_WF, .V_WT = felt.V_WT, .A_WT = felt.A_WT});

    // Run a tick of the shipped loop, then move the arm by a period with the loop's command.
    const rt::Nanoseconds now = rt::kSecond + static_cast<rt::Nanoseconds>(i) * period_ns;
    state.stamp = now;
    ++state.sequence;
    std::copy_n(body->q().data(), control::kJoints, state.q_meas.begin());
    state.q_ipo = state.q_meas;
    model.frame = i + 1;
    model.pose_stamp = now;
    const control::CellReadings readings{.force = {.stamp = now, .F_S = F_S}};
    const control::TickRecord record = loop.Tick({.state = state,
                                                  .received = control::ReceiveResult::kOk,
                                                  .readings = readings,
                                                  .model = model,
                                                  .now = now},
                                                 command);
    point.fault |= record.faults != 0;

    const Matrix3 R_BW = params.X_WB.linear().transpose();
    body->Step({.q_cmd = Eigen::Map<const JointVector>(command.q.data())},
               {.f = R_BW * F_T_W.f, .t = R_BW * F_T_W.t});
  }

  const SineFit fit = FitSine(motion, w, dt_s, first);
  point.travel = std::abs(fit.phasor);
  point.harmonics = point.travel > 0.0 ? fit.residual_rms / (point.travel / std::numbers::sqrt2) : 0.0;
  point.impedance = shake.amplitude / (std::complex<double>(0.0, w) * fit.phasor);
  return point;
}

std::complex<double> AskedImpedance(const control::AdmittanceParams& law, int axis, double frequency_hz) {
  const std::complex<double> jw(0.0, kTau * frequency_hz);
  const Eigen::Matrix<std::complex<double>, 6, 6> Z =
      jw * control::MassMatrix(law).cast<std::complex<double>>() +
      control::DampingMatrix(law).cast<std::complex<double>>();
  return 1.0 / Z.inverse()(axis, axis);
}

std::vector<HandlePoint> SweepFree(const HandleBenchParams& params, const HandleSweep& sweep,
                                   const std::function<void(double)>& progress) {
  std::vector<HandlePoint> points;
  for (const double hz : sweep.frequencies_hz) {
    const double z = std::abs(AskedImpedance(params.servo.admittance, sweep.axis, hz));
    const double speed = std::min(sweep.max_speed, sweep.max_travel * kTau * hz);
    points.push_back(
        Shake(params,
              {.axis = sweep.axis, .frequency_hz = hz, .amplitude = std::min(sweep.max_wrench, z * speed)}));
    if (progress)
      progress(static_cast<double>(points.size()) / static_cast<double>(sweep.frequencies_hz.size()));
  }
  return points;
}

HandleFit FitMassAndDrag(const std::vector<HandlePoint>& points, double max_hz) {
  // Real and imaginary part are fitted separately: b to Re Z, m w to Im Z. Each residual is weighted by 1 /
  // |Z|.
  double drag = 0.0, drag_weight = 0.0, mass = 0.0, mass_weight = 0.0;
  for (const HandlePoint& point : points) {
    if (point.frequency_hz > max_hz || point.fault) continue;
    const double weight = 1.0 / std::norm(point.impedance), w = kTau * point.frequency_hz;
    drag += weight * point.impedance.real();
    drag_weight += weight;
    mass += weight * w * point.impedance.imag();
    mass_weight += weight * w * w;
  }
  HandleFit fit;
  if (drag_weight == 0.0) return fit;
  fit.drag = drag / drag_weight;
  fit.mass = mass / mass_weight;
  double sum = 0.0;
  int count = 0;
  for (const HandlePoint& point : points) {
    if (point.frequency_hz > max_hz || point.fault) continue;
    const std::complex<double> model(fit.drag, kTau * point.frequency_hz * fit.mass);
    sum += std::norm(point.impedance - model) / std::norm(point.impedance);
    ++count;
  }
  fit.residual = std::sqrt(sum / count);
  return fit;
}

}  // namespace osteon::studies
