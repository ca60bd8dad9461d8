#include "tests/studies/stability/compliant_loop.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "control/compliance/bone_mount.h"
#include "control/compliance/compliant_link.h"
#include "control/laws/admittance_law.h"

namespace osteon::hil {
namespace {

// Returns the parameters, or throws std::invalid_argument.
const CompliantLoopParams& Validated(const CompliantLoopParams& params) {
  Validate(params.loop);
  if (params.loop.wall.on != WallOn::kCommanded || params.loop.wall.age_ticks != 0)
    throw std::invalid_argument("compliant loop: wall: accepted planes that are evaluated in the tick");
  if (params.link && !(params.link->tau_s > 0.0 && params.link->compliance_m_per_N >= 0.0))
    throw std::invalid_argument(
        fmt::format("compliant loop: link: found {:g} m/N and {:g} s, accepted >= 0 and > 0",
                    params.link->compliance_m_per_N, params.link->tau_s));
  if (params.mount && !(params.mount->mass_kg > 0.0 && params.mount->frequency_hz > 0.0 &&
                        params.mount->late_ticks >= 0 && params.mount->late_ticks <= 1000))
    throw std::invalid_argument(
        "compliant loop: mount: accepted mass and frequency > 0, 0 … 1000 ticks late");
  return params;
}

// The parameters of the shipped mount with this mass and frequency.
control::BoneMountParams MountOf(const LoopMount& mount) {
  const double w = 2.0 * std::numbers::pi * mount.frequency_hz;
  control::BoneMountParams params;
  params.mass_kg = mount.mass_kg;
  params.stiffness_N_per_m.setConstant(mount.mass_kg * w * w);
  params.damping_ratio = mount.damping_ratio;
  return params;
}

// Transition of the shipped servo in one period, without dead time: from (x_r, x_r', command) to (x_r, x_r')
// at its end. Each column is found by stepping the servo from a unit state.
Eigen::Matrix<double, 2, 3> ServoTransition(ServoArmParams params, double period_s) {
  params.dead_cycles = 0;
  std::array<kinematics::JointLimits, 7> unlimited;
  for (kinematics::JointLimits& limits : unlimited)
    limits.velocity_rad_per_s = std::numeric_limits<double>::max();
  const auto joint = [&](double q) { return kinematics::JointVector::Constant(q).eval(); };
  ServoArm released(params, unlimited, period_s, joint(1.0)),
      commanded(params, unlimited, period_s, joint(0.0));
  released.Step(joint(0.0));
  const Eigen::Vector2d first(released.q()[0], released.qd()[0]);
  released.Step(joint(0.0));
  const Eigen::Vector2d second(released.q()[0], released.qd()[0]);
  commanded.Step(joint(1.0));
  Eigen::Matrix<double, 2, 3> step;
  step.col(0) = first;
  step.col(1) = (second - first[0] * first) / first[1];
  step.col(2) << commanded.q()[0], commanded.qd()[0];
  return step;
}

// Dead time in whole periods.
int DeadTicks(const ServoArmParams& params) { return static_cast<int>(std::lround(params.dead_cycles)); }

}  // namespace

// The state: commands x_c, newest first; the arm's x_r and x_r'; the virtual tool's speed; earlier measured
// forces; the link's deflection e; the mount's displacement d, d' and earlier d; x_r' one period before.
CompliantLoop::CompliantLoop(const CompliantLoopParams& params)
    : params_(Validated(params)), arm_step_(ServoTransition(params.loop.arm, params.loop.period_s)) {
  arm_ = 1 + DeadTicks(params.loop.arm);
  speed_ = arm_ + 2;
  felt_ = speed_ + 1;
  link_ = felt_ + params.loop.sensor_delay;
  mount_ = link_ + (params.link ? 1 : 0);
  before_ = mount_ + (params.mount ? 2 + params.mount->late_ticks : 0);
  size_ = before_ + (params.mean_acceleration ? 1 : 0);
}

Eigen::VectorXd CompliantLoop::Step(const Eigen::VectorXd& s) const {
  const AdmittanceLoopParams& p = params_.loop;
  const double T = p.period_s, w = 2.0 * std::numbers::pi * p.arm.bandwidth_hz;
  const double x = s[arm_], v = s[arm_ + 1], target = s[DeadTicks(p.arm)];
  const double a = params_.mean_acceleration ? (v - s[before_]) / T
                                             : w * w * (target - x) - 2.0 * p.arm.damping_ratio * w * v;
  const double felt_N = -(p.hand.stiffness_N_per_m * x + p.hand.damping_Ns_per_m * v + p.hand.mass_kg * a);
  const double told_N = p.sensor_delay == 0 ? felt_N : s[felt_ + p.sensor_delay - 1];

  const double e = params_.link ? s[link_] : 0.0;
  const int late = params_.mount ? params_.mount->late_ticks : 0;
  const double d = params_.mount ? s[mount_ + (late == 0 ? 0 : 1 + late)] : 0.0;
  const double wall_N = -p.wall.stiffness_N_per_m * (s[0] + e - d);

  control::AdmittanceParams law;
  law.mass_kg.setConstant(p.mass_kg);
  law.damping_Ns_per_m.setConstant(p.damping_Ns_per_m);
  control::AdmittanceState tool;
  tool.V_WT.v.z() = s[speed_];
  if (!control::StepAdmittance(law, {.f = {0.0, 0.0, told_N + wall_N}, .t = Vector3::Zero()}, T, tool))
    return Eigen::VectorXd::Constant(size_, std::numeric_limits<double>::infinity());

  Eigen::VectorXd next(size_);
  next[0] = s[0] + T * tool.V_WT.v.z();
  for (int i = 1; i < arm_; ++i) next[i] = s[i - 1];
  next.segment<2>(arm_) = arm_step_ * Eigen::Vector3d(x, v, target);
  next[speed_] = tool.V_WT.v.z();
  for (int i = 0; i < p.sensor_delay; ++i) next[felt_ + i] = i == 0 ? felt_N : s[felt_ + i - 1];
  if (params_.mean_acceleration) next[before_] = v;
  if (params_.link) {
    using Scalar = Eigen::Matrix<double, 1, 1>;
    next[link_] = control::StepMassless<1>(Scalar(e), Scalar(params_.link->compliance_m_per_N * wall_N), T,
                                           params_.link->tau_s)[0];
  }
  if (params_.mount) {
    control::BoneMountState state;
    state.d[2] = s[mount_];
    state.v[2] = s[mount_ + 1];
    control::StepMount(MountOf(*params_.mount), {.f = {0.0, 0.0, wall_N}, .t = Vector3::Zero()}, T, state);
    next[mount_] = state.d[2];
    next[mount_ + 1] = state.v[2];
    for (int i = 0; i < late; ++i) next[mount_ + 2 + i] = i == 0 ? s[mount_] : s[mount_ + 1 + i];
  }
  return next;
}

double CompliantLoop::SpectralRadius() const {
  return hil::SpectralRadius(LoopMatrix([this](const Eigen::VectorXd& s) { return Step(s); }, size_));
}

double MinLinkTime_s(CompliantLoopParams params) {
  double low_s = 1e-5, high_s = 1.0;
  for (int i = 0; i < 40; ++i) {
    const double middle_s = std::sqrt(low_s * high_s);
    params.link->tau_s = middle_s;
    (CompliantLoop(params).SpectralRadius() < 1.0 ? high_s : low_s) = middle_s;
  }
  return high_s;
}

}  // namespace osteon::hil
