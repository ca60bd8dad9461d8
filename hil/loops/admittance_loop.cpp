#include "hil/loops/admittance_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "control/laws/admittance_law.h"
#include "control/sensing/tool_inertia.h"

namespace osteon::hil {
namespace {

constexpr int kMaxDelay = 1000;  // [ticks]: one second at 1 kHz

// A tool whose axes differ from the world's axes, so that the law's transformations between frames are part
// of the loop.
const Matrix3& TurnedTool() {
  static const Matrix3 R = ExpRotation({0.3, -0.4, 0.2});
  return R;
}

}  // namespace

void Validate(const AdmittanceLoopParams& params) {
  const auto require = [](const char* name, double found, bool ok, const char* accepted) {
    if (!ok || !std::isfinite(found))
      throw std::invalid_argument(
          fmt::format("admittance loop: {}: found {:g}, accepted {}", name, found, accepted));
  };
  require("hand stiffness_N_per_m", params.hand.stiffness_N_per_m, params.hand.stiffness_N_per_m >= 0.0,
          ">= 0");
  require("hand damping_Ns_per_m", params.hand.damping_Ns_per_m, params.hand.damping_Ns_per_m >= 0.0, ">= 0");
  require("felt_mass_kg", params.felt_mass_kg, params.felt_mass_kg >= 0.0, ">= 0");
  require("hand mass_kg", params.hand.mass_kg, params.hand.mass_kg >= 0.0, ">= 0");
  require("mass_kg", params.mass_kg, params.mass_kg > 0.0, "> 0");
  require("damping_Ns_per_m", params.damping_Ns_per_m, params.damping_Ns_per_m > 0.0, "> 0");
  require("wall stiffness_N_per_m", params.wall.stiffness_N_per_m, params.wall.stiffness_N_per_m >= 0.0,
          ">= 0");
  require("wall damping_Ns_per_m", params.wall.damping_Ns_per_m, params.wall.damping_Ns_per_m >= 0.0, ">= 0");
  require("wall age_ticks", params.wall.age_ticks,
          params.wall.age_ticks >= 0 && params.wall.age_ticks <= kMaxDelay, "0 … 1000");
  require("tool_mass_kg", params.tool_mass_kg, params.tool_mass_kg >= 0.0, ">= 0");
  require("inertia_share", params.inertia_share, params.inertia_share >= 0.0, ">= 0");
  require("acceleration_hz", params.acceleration_hz, params.acceleration_hz >= 1.0, ">= 1");
  require("sensor_delay", params.sensor_delay, params.sensor_delay >= 0 && params.sensor_delay <= kMaxDelay,
          "0 … 1000");
}

AdmittanceLoop::AdmittanceLoop(const AdmittanceLoopParams& params) : params_(params) {
  Validate(params);
  const HeldArm held = ArmHeldBy(params.hand, params.felt_mass_kg, params.arm);
  command_gain_ = held.command_gain;
  linear_arm_ = LinearArm(held.arm, params.period_s);
  // the velocity at an old commanded pose is the difference of two samples, so one more sample is stored
  const int oldest = params.wall.on == WallOn::kCommanded ? params.wall.age_ticks + 1 : 0;
  arm_ = std::max({1, linear_arm_.history(), 1 + oldest});
  speed_ = arm_ + 3;
  felt_ = speed_ + 1;
  motion_ = felt_ + params.sensor_delay;
}

// The parts of the state s are listed at size(); arm_ … motion_ are their first indices.
Eigen::VectorXd AdmittanceLoop::Step(const Eigen::VectorXd& s) const {
  const GridHand& hand = params_.hand;
  const double x = s[arm_], v = s[arm_ + 1];

  // present load of hand and tool on the sensor, and the law's input, which is older by the sensor's delay
  const double a = (v - s[arm_ + 2]) / params_.period_s;
  const double felt_N =
      -(hand.stiffness_N_per_m * x + hand.damping_Ns_per_m * v + (hand.mass_kg + params_.tool_mass_kg) * a);
  double law_input_N = params_.sensor_delay == 0 ? felt_N : s[felt_ + params_.sensor_delay - 1];
  control::MeasuredMotion motion;
  if (params_.inertia_share > 0.0) {
    motion.X.translation().x() = s[motion_];
    motion.V.v.x() = s[motion_ + 1];
    motion.A.v.x() = s[motion_ + 2];
    Pose X_now = Pose::Identity();
    X_now.translation().x() = x;
    control::StepMotion(X_now, params_.acceleration_hz, params_.period_s, motion);
    law_input_N += params_.inertia_share * params_.tool_mass_kg * motion.A.v.x();
  }

  // the wall's force: s[0] is the commanded position now, s[i] that of i ticks ago
  const LoopWall& wall = params_.wall;
  const int age = wall.age_ticks;
  const double wall_N =
      wall.on == WallOn::kMeasured
          ? -wall.stiffness_N_per_m * x - wall.damping_Ns_per_m * v
          : -wall.stiffness_N_per_m * s[age] -
                wall.damping_Ns_per_m * (age == 0 ? s[speed_] : (s[age] - s[age + 1]) / params_.period_s);

  // one step of the shipped law, along the tool's z
  const Vector3 axis_W = TurnedTool().col(2);
  control::AdmittanceParams law;
  law.mass_kg.z() = params_.mass_kg;
  law.damping_Ns_per_m.z() = params_.damping_Ns_per_m;
  control::AdmittanceState tool;
  tool.X_WT.linear() = TurnedTool();
  tool.X_WT.translation() = s[0] * axis_W;
  tool.V_WT.v = s[speed_] * axis_W;
  const Wrench F_T_W{.f = (law_input_N + wall_N) * axis_W, .t = Vector3::Zero()};
  if (!control::StepAdmittance(law, F_T_W, params_.period_s, tool))
    return Eigen::VectorXd::Constant(size(), std::numeric_limits<double>::infinity());

  // the next state: shift the commands, advance the arm, shift the stored sensor loads
  Eigen::VectorXd next(size());
  next[0] = axis_W.dot(tool.X_WT.translation());
  for (int i = 1; i < arm_; ++i) next[i] = s[i - 1];
  // the command that was sent `ago` ticks before the present one
  const auto sent = [&](int ago) { return command_gain_ * (ago == 0 ? next[0] : s[ago - 1]); };
  const double earlier = linear_arm_.split ? sent(linear_arm_.whole + 1) : 0.0;
  next.segment<2>(arm_) = linear_arm_.step * Eigen::Vector4d(x, v, earlier, sent(linear_arm_.whole));
  next[arm_ + 2] = v;
  next[speed_] = axis_W.dot(tool.V_WT.v);
  for (int i = 0; i < params_.sensor_delay; ++i) next[felt_ + i] = i == 0 ? felt_N : s[felt_ + i - 1];
  if (params_.inertia_share > 0.0)
    next.segment<3>(motion_) << motion.X.translation().x(), motion.V.v.x(), motion.A.v.x();
  return next;
}

Eigen::MatrixXd AdmittanceLoop::Matrix() const {
  return LoopMatrix([this](const Eigen::VectorXd& s) { return Step(s); }, size());
}

Boundary MaxWallStiffness(AdmittanceLoopParams params, const BoundaryScan& scan) {
  return FirstCrossing(
      [&](double stiffness) {
        params.wall.stiffness_N_per_m = stiffness;
        return AdmittanceLoop(params).SpectralRadius() < 1.0;
      },
      scan);
}

double MinDrag(AdmittanceLoopParams params, const BoundaryScan& scan) {
  // scan 1 / b upward, which scans the drag b downward
  const Boundary found = FirstCrossing(
      [&](double inverse) {
        params.damping_Ns_per_m = 1.0 / inverse;
        return AdmittanceLoop(params).SpectralRadius() < 1.0;
      },
      {.from = 1.0 / scan.to, .to = 1.0 / scan.from, .factor = scan.factor, .tolerance = scan.tolerance});
  if (!found.crossed) return 0.0;
  return found.value == 0.0 ? std::numeric_limits<double>::infinity() : 1.0 / found.value;
}

}  // namespace osteon::hil
