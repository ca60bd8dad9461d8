#include "hil/stability/admittance_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "control/admittance_law.h"
#include "control/virtual_coupling.h"

namespace osteon::hil {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDied = 1e-9;      // of the greatest motion: below, rounding is what is left
constexpr double kOutgrown = 0.5;   // of the preload: nearer to it the wall is no longer a linear spring
constexpr double kFarFree_m = 0.1;  // without a wall: a kick of .1 mm/s has become this

// The newest values of the past, the present one first.
class History {
 public:
  explicit History(int oldest) : values_(static_cast<std::size_t>(oldest) + 1, 0.0) {}
  void Push(double value) {
    values_.push_front(value);
    values_.pop_back();
  }
  [[nodiscard]] double at(int ticks_ago) const { return values_[static_cast<std::size_t>(ticks_ago)]; }

 private:
  std::deque<double> values_;
};

// Growth of an oscillation, from its first to its last turning point in the second half of a run; of a motion
// that does not turn, from the middle to the end.
class Envelope {
 public:
  explicit Envelope(int ticks) : middle_(ticks / 2), end_(ticks - 1) {}

  void Add(int tick, double x) {
    const double size = std::abs(x);
    most_ = std::max(most_, size);
    if (tick == middle_) first_ = {tick, size};
    if (tick == end_) last_ = {tick, size};
    if (tick > middle_ && before_ > before_that_ && before_ >= size) {
      if (turns_++ == 0) first_turn_ = {tick - 1, before_};
      last_turn_ = {tick - 1, before_};
    }
    before_that_ = std::exchange(before_, size);
  }
  [[nodiscard]] double Growth() const {
    const auto [from, to] = turns_ >= 2 ? std::pair(first_turn_, last_turn_) : std::pair(first_, last_);
    if (!(to.size > kDied * most_)) return -kInfinity;
    return std::log(to.size / from.size) / (to.tick - from.tick);
  }

 private:
  struct Point {
    int tick{0};
    double size{0.0};
  };
  int middle_, end_, turns_{0};
  double before_{0.0}, before_that_{0.0}, most_{0.0};
  Point first_, last_, first_turn_, last_turn_;
};

// One axis of the shipped arm, with room for any speed.
ServoArm Arm(const AdmittanceLoopParams& loop) {
  std::array<kinematics::JointLimits, 7> unlimited;
  for (kinematics::JointLimits& limits : unlimited)
    limits.velocity_rad_per_s = std::numeric_limits<double>::max();
  return {loop.arm, unlimited, loop.period_s, kinematics::JointVector::Zero()};
}

// The plane z = 0 of a turned frame, as an engine would report it, never older than the tick.
simulation::ContactModel Plane(const Vector3& n_W, double stiffness_N_per_m) {
  simulation::ContactModel model;
  model.frame = 1;
  model.contact_count = 1;
  model.contacts[0].n_W = n_W;
  model.contacts[0].stiffness_N_per_m = stiffness_N_per_m;
  return model;
}

}  // namespace

double SimulatedGrowth(const AdmittanceRunParams& params) {
  const AdmittanceLoopParams& p = params.loop;
  Validate(p);
  if (!(params.command_loss >= 0.0 && params.command_loss < 1.0))
    throw std::invalid_argument(
        fmt::format("admittance run: command_loss: found {:g}, accepted 0 … 1, not 1", params.command_loss));
  const double T = p.period_s, w = 2.0 * std::numbers::pi * p.arm.bandwidth_hz;
  const bool wall = p.wall.stiffness_N_per_m > 0.0;
  const double preload_N = wall ? params.preload_N : 0.0;
  const double rest_m = wall ? -preload_N / p.wall.stiffness_N_per_m : 0.0;  // x where all is at rest

  const Matrix3 R_WT = ExpRotation({0.3, -0.4, 0.2});
  const Vector3 axis_W = R_WT.col(2);
  control::AdmittanceParams law;
  law.mass_kg.z() = p.mass_kg;
  law.damping_Ns_per_m.z() = p.damping_Ns_per_m;
  control::CouplingParams coupling;
  coupling.max_stiffness_N_per_m = std::max(1.0, p.wall.stiffness_N_per_m);
  coupling.damping_Ns_per_m = p.wall.damping_Ns_per_m;
  control::CouplingState coupling_state;
  coupling_state.fade = 1.0;
  simulation::ContactModel plane = Plane(axis_W, p.wall.stiffness_N_per_m);

  // positions are seen from where all is at rest, so that what is small keeps its digits
  ServoArm arm = Arm(p);
  History targets(p.arm.dead_cycles), felt(p.sensor_delay), poses(p.wall.age_ticks), speeds(p.wall.age_ticks);
  History commands(params.command_jitter);
  double x_c = 0.0, v_c = params.kick_m_per_s, told_arm = 0.0;
  int late = 0;
  std::mt19937_64 bits(params.seed);
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };

  const int ticks = static_cast<int>(params.seconds / T);
  Envelope envelope(ticks);
  control::AdmittanceState tool;
  tool.X_WT.linear() = R_WT;
  for (int k = 0; k < ticks; ++k) {
    // the command's way to the arm
    commands.Push(x_c);
    late = params.command_jitter == 0
               ? 0
               : std::min(late + 1, static_cast<int>(uniform() * (params.command_jitter + 1)));
    if (params.command_loss == 0.0 || uniform() >= params.command_loss) told_arm = commands.at(late);
    targets.Push(told_arm);

    // hand and sensor
    const double x = arm.q()[0], v = arm.qd()[0];
    const double a = w * w * (targets.at(p.arm.dead_cycles) - x) - 2.0 * p.arm.damping_ratio * w * v;
    felt.Push(-(p.hand.stiffness_N_per_m * x + p.hand.damping_Ns_per_m * v + p.hand.mass_kg * a));

    // wall: the shipped coupling, on the pose that it acts through
    poses.Push(x_c);
    speeds.Push(v_c);
    const bool measured = p.wall.on == WallOn::kMeasured;
    double wall_N = 0.0;
    if (wall) {
      Pose X_WT = Pose::Identity();
      X_WT.linear() = R_WT;
      X_WT.translation() = (rest_m + (measured ? x : poses.at(p.wall.age_ticks))) * axis_W;
      const Twist V_WT{.v = (measured ? v : speeds.at(p.wall.age_ticks)) * axis_W, .w = Vector3::Zero()};
      const auto now = static_cast<rt::Nanoseconds>(std::llround(1e9 * T * (k + 1)));
      plane.pose_stamp = now;
      plane.frame = static_cast<std::uint64_t>(k) + 1;
      const auto out = control::EvaluateCoupling(coupling, plane, X_WT, V_WT, now, false, coupling_state);
      wall_N = axis_W.dot(out.F_T_W.f);
      if (std::abs(wall_N - preload_N) > kOutgrown * preload_N) return kInfinity;
    } else if (std::abs(x_c) > kFarFree_m) {
      return kInfinity;
    }

    // law and arm
    arm.Step(kinematics::JointVector::Constant(told_arm));
    tool.X_WT.translation() = x_c * axis_W;
    tool.V_WT.v = v_c * axis_W;
    const double sum_N = felt.at(p.sensor_delay) - preload_N + wall_N;
    if (!control::StepAdmittance(law, {.f = sum_N * axis_W, .t = Vector3::Zero()}, T, tool)) return kInfinity;
    x_c = axis_W.dot(tool.X_WT.translation());
    v_c = axis_W.dot(tool.V_WT.v);
    envelope.Add(k, x_c);
  }
  return envelope.Growth();
}

Boundary SimulatedGreatestWall(AdmittanceRunParams params, const BoundaryScan& scan) {
  return FirstCrossing(
      [&](double stiffness) {
        params.loop.wall.stiffness_N_per_m = stiffness;
        return SimulatedGrowth(params) < 0.0;
      },
      scan);
}

}  // namespace osteon::hil
