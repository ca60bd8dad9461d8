#include "hil/arm/servo_arm.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "hil/arm/second_order_step.h"

namespace osteon::hil {
ServoArm::ServoArm(const ServoArmParams& params, const std::array<kinematics::JointLimits, 7>& limits,
                   double period_s, const kinematics::JointVector& q_start)
    : max_acceleration_rad_per_s2_(params.max_acceleration_rad_per_s2),
      q_(q_start),
      qd_(kinematics::JointVector::Zero()) {
  const auto refuse = [](const char* name, double found, const char* accepted) {
    throw std::invalid_argument(std::string("simulated arm: ") + name + ": found " + base::NumberText(found) +
                                ", accepted " + accepted);
  };
  if (!(params.bandwidth_hz > 0.0 && params.bandwidth_hz <= 1000.0))
    refuse("bandwidth_hz", params.bandwidth_hz, "0 … 1000, not 0");
  if (!(params.damping_ratio >= 0.0 && params.damping_ratio <= 10.0))
    refuse("damping_ratio", params.damping_ratio, "0 … 10");
  if (!(params.dead_cycles >= 0.0 && params.dead_cycles <= kMaxDeadCycles))
    refuse("dead_cycles", params.dead_cycles, "0 … 32");
  if (!(params.max_acceleration_rad_per_s2 > 0.0))
    refuse("max_acceleration_rad_per_s2", params.max_acceleration_rad_per_s2, "> 0");
  if (!(period_s > 0.0 && period_s <= 0.1)) refuse("period_s", period_s, "0 … 0.1, not 0");
  for (int i = 0; i < 7; ++i) {
    max_speed_rad_per_s_[i] = limits[static_cast<std::size_t>(i)].velocity_rad_per_s;
    if (!(max_speed_rad_per_s_[i] > 0.0)) refuse("velocity limit [rad/s]", max_speed_rad_per_s_[i], "> 0");
  }
  // makes a part of a period in which one command acts, with the closed-form transition over it
  const auto part = [&](double duration_s) {
    return Part{duration_s, SecondOrderStep(2.0 * std::numbers::pi * params.bandwidth_hz,
                                            params.damping_ratio, duration_s)};
  };
  // the dead time as whole periods and a remaining fraction of a period
  const double whole = std::floor(params.dead_cycles), rest = params.dead_cycles - whole;
  first_ = part(rest > 0.0 ? rest * period_s : period_s);
  if (rest > 0.0) second_ = part((1.0 - rest) * period_s);
  delay_size_ = static_cast<std::size_t>(std::ceil(params.dead_cycles)) + 1;
  delay_.fill(q_start);
}

void ServoArm::Step(const kinematics::JointVector& q_cmd) OSTEON_RT {
  // Store the newest command, and use the command that came ceil(dead_cycles) periods earlier.
  delay_[next_] = q_cmd;
  next_ = (next_ + 1) % delay_size_;
  Advance(first_, delay_[next_]);
  if (second_.duration_s > 0.0) Advance(second_, delay_[(next_ + 1) % delay_size_]);
}

void ServoArm::Advance(const Part& part, const kinematics::JointVector& target) OSTEON_RT {
  for (int i = 0; i < 7; ++i) {
    const Eigen::Vector2d x = part.transition * Eigen::Vector2d(q_[i] - target[i], qd_[i]);
    // x: distance from the target, and speed, at the end of the part if no limit acts
    const double wanted = (x[1] - qd_[i]) / part.duration_s;  // mean acceleration over the part
    // mean velocity over the part; checked too, because the velocity's peak may lie within the part
    const double speed = (target[i] + x[0] - q_[i]) / part.duration_s;
    if (std::abs(wanted) <= max_acceleration_rad_per_s2_ && std::abs(x[1]) <= max_speed_rad_per_s_[i] &&
        std::abs(speed) <= max_speed_rad_per_s_[i]) {
      q_[i] = target[i] + x[0];
      qd_[i] = x[1];
      continue;
    }
    const double a = std::clamp(wanted, -max_acceleration_rad_per_s2_, max_acceleration_rad_per_s2_);
    const double qd =
        std::clamp(qd_[i] + a * part.duration_s, -max_speed_rad_per_s_[i], max_speed_rad_per_s_[i]);
    q_[i] += 0.5 * (qd_[i] + qd) * part.duration_s;
    qd_[i] = qd;
  }
}

}  // namespace osteon::hil
