#include "config/reading/apply_identified.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "config/reading/load_identified.h"
#include "config/reading/strict/config_error.h"
#include "config/reading/tool_mobility.h"

namespace osteon::config {
namespace {

constexpr double kMaxDampingRatio = 10.0;  // largest one that the simulated arm accepts
// A dead time is rounded up to whole periods. An excess of less than this share of a period is ignored.
constexpr double kSameCycle = 0.05;

// Converts a measurement to parameters of the simulated arm. Refuses a dead time or damping ratio that the
// simulated arm does not accept. @param file  the file of the measurement, for the error
hil::ServoArmParams ArmFrom(const IdentifiedArm& arm, double period_s, const std::string& file) {
  const auto require = [&](const char* key, double found, double max, const char* unit) {
    if (!(found >= 0.0 && found <= max))
      throw ConfigError(file, 0,
                        fmt::format("arm, axis {} at {:g} mm/s: {}: found {:g}{}, accepted 0 … {:g}{}",
                                    arm.axis, 1e3 * arm.speed_m_per_s, key, found, unit, max, unit));
  };
  require("dead_time_ms", 1e3 * arm.dead_time_s, 1e3 * hil::ServoArm::kMaxDeadCycles * period_s, " ms");
  require("damping_ratio", arm.damping_ratio, kMaxDampingRatio, "");
  return {.bandwidth_hz = arm.bandwidth_hz,
          .damping_ratio = arm.damping_ratio,
          .dead_cycles = arm.dead_time_s / period_s};
}

}  // namespace

const IdentifiedArm* SlowestArm(const IdentifiedCell& identified) {
  if (identified.arm.empty()) return nullptr;
  return &*std::ranges::max_element(identified.arm, {}, &IdentifiedArm::lag_s);
}

namespace {

// Applies the figures measured with the force sensor: the dead zone, which covers the sensor's drift, and the
// tremor and the notches that the vibration index tolerates.
void ApplyForces(const IdentifiedCell& identified, CellConfig& cell) {
  if (identified.dead_zone_N) {
    double& dead_zone_N = cell.servo.admittance.dead_zone_N;
    dead_zone_N = std::max(dead_zone_N, *identified.dead_zone_N);
    cell.own_gains.dead_zone_N = std::max(cell.own_gains.dead_zone_N, *identified.dead_zone_N);
  }
  if (!identified.vibration) return;
  control::VibrationParams& vibration = cell.servo.vibration;
  if (identified.vibration->tremor_N > 0.0) vibration.reference.tremor_N = identified.vibration->tremor_N;
  if (!identified.vibration->notch_hz.empty())
    vibration.notch_hz = std::ranges::max(identified.vibration->notch_hz);
}

// Returns this value of the first axis for which it was measured.
std::optional<double> FirstKnown(const std::vector<IdentifiedArm>& arms,
                                 std::optional<double> IdentifiedImpedance::*value) {
  for (const IdentifiedArm& axis : arms)
    if (axis.impedance && (*axis.impedance).*value) return (*axis.impedance).*value;
  return {};
}

// Applies the measured springs and their damping, each from the axis with the narrowest relative interval.
void ApplySprings(std::vector<IdentifiedArm> arms, bool torque, hil::DynamicArmParams& arm) {
  const auto width = [](const IdentifiedInterval& interval) { return interval.high - interval.low; };
  std::ranges::stable_sort(arms, {}, [&](const IdentifiedArm& axis) {
    return width(axis.bandwidth_interval_hz) / axis.bandwidth_hz;
  });
  arm.stiffness_N_per_m =
      FirstKnown(arms, &IdentifiedImpedance::translation_N_per_m).value_or(arm.stiffness_N_per_m);
  arm.stiffness_Nm_per_rad_turn =
      FirstKnown(arms, &IdentifiedImpedance::rotation_Nm_per_rad).value_or(arm.stiffness_Nm_per_rad_turn);
  if (const auto joint = FirstKnown(arms, &IdentifiedImpedance::joint_Nm_per_rad))
    arm.stiffness_Nm_per_rad.setConstant(*joint);
  std::ranges::stable_sort(
      arms, {}, [&](const IdentifiedArm& axis) { return width(axis.damping_interval) / axis.damping_ratio; });
  double& ratio = torque ? arm.joint_damping_ratio : arm.cartesian_damping_ratio;
  ratio = FirstKnown(arms, &IdentifiedImpedance::damping_ratio).value_or(ratio);
}

// Gives the dynamic arm the measured springs and damping of the arm's own impedance control, against which an
// overlaid force works. Its dead time becomes the longest of all axes, rounded up to whole periods.
void ApplyImpedance(const std::vector<IdentifiedArm>& arms, const std::string& file, CellConfig& cell) {
  const IdentifiedArm& longest_dead = *std::ranges::max_element(arms, {}, &IdentifiedArm::dead_time_s);
  hil::DynamicArmParams& arm = cell.simulated.dynamic;
  const bool torque = cell.simulated.fri.command_mode == control::CommandMode::kTorque;
  const double cycles = std::max(0.0, std::ceil(longest_dead.dead_time_s / cell.servo.period_s - kSameCycle));
  if (!(cycles <= hil::DynamicArm::kMaxDeadCycles))
    throw ConfigError(file, 0,
                      fmt::format("arm, axis {}: dead_time_ms: found {:g}, accepted at most {:g}",
                                  longest_dead.axis, 1e3 * longest_dead.dead_time_s,
                                  1e3 * hil::DynamicArm::kMaxDeadCycles * cell.servo.period_s));
  arm.dead_cycles = static_cast<int>(cycles);
  if (std::ranges::any_of(arms, [](const IdentifiedArm& axis) { return axis.impedance.has_value(); }))
    return ApplySprings(arms, torque, arm);
  // An older file has no springs: derive the spring from the axis with the longest dead time.
  if (!longest_dead.felt_mass_kg || torque) return;
  const auto mobility = ToolMobility(cell);
  if (!mobility) return;
  const double w = 2.0 * std::numbers::pi * longest_dead.bandwidth_hz;  // [rad/s]
  arm.stiffness_N_per_m = *longest_dead.felt_mass_kg * w * w;
  // The dynamic arm's damping ratio refers to its mean mass over all directions: convert the axis' ratio.
  const double mean_kg = 3.0 / mobility->trace();
  arm.cartesian_damping_ratio = longest_dead.damping_ratio * std::sqrt(*longest_dead.felt_mass_kg / mean_kg);
}

}  // namespace

void ApplyIdentified(const std::filesystem::path& file, CellConfig& cell) {
  cell.identified = ReadIdentifiedFor(file, cell);
  ApplyForces(*cell.identified, cell);
  const IdentifiedArm* slowest = SlowestArm(*cell.identified);
  if (slowest != nullptr && cell.servo.law == control::Law::kImpedance && slowest->felt_mass_kg)
    return ApplyImpedance(cell.identified->arm, file.string(), cell);
  // The file has no model of the arm. The measured response is then used to judge the gains, and the
  // simulated arm stays unchanged.
  if (slowest == nullptr &&
      (cell.identified->vibration || cell.identified->dead_zone_N || !cell.identified->response.empty()))
    return;
  if (slowest == nullptr)
    throw ConfigError(file.string(), 0, "identified: arm: found no measurement, accepted one axis at least");
  const hil::ServoArmParams arm = ArmFrom(*slowest, cell.servo.period_s, file.string());
  cell.simulated.servo = arm;
  cell.simulated.dynamic.bandwidth_hz = arm.bandwidth_hz;
  cell.simulated.dynamic.damping_ratio = arm.damping_ratio;
  cell.simulated.dynamic.dead_cycles = static_cast<int>(std::lround(arm.dead_cycles));
  if (cell.simulated.kr) cell.simulated.kr->controller.servo = arm;
}

namespace {

// Describes the springs of the arm's own impedance control and its dead time (ApplyImpedance).
std::string ImpedanceText(const CellConfig& cell) {
  const hil::DynamicArmParams& arm = cell.simulated.dynamic;
  const bool torque = cell.simulated.fri.command_mode == control::CommandMode::kTorque;
  const std::string springs =
      torque
          ? fmt::format("joints of {:.4g} N·m/rad", arm.stiffness_Nm_per_rad.mean())
          : fmt::format("{:.4g} N/m, {:.4g} N·m/rad", arm.stiffness_N_per_m, arm.stiffness_Nm_per_rad_turn);
  return fmt::format(
      "simulated arm: {}, damping ratio {:.3g}, dead time {:.3g} ms (rounded up to whole periods)", springs,
      torque ? arm.joint_damping_ratio : arm.cartesian_damping_ratio,
      1e3 * cell.servo.period_s * arm.dead_cycles);
}

}  // namespace

std::vector<std::string> IdentifiedText(const CellConfig& cell) {
  if (!cell.identified) return {};
  const IdentifiedCell& identified = *cell.identified;
  std::vector<std::string> lines;
  const IdentifiedArm* arm = SlowestArm(identified);
  if (arm != nullptr && cell.servo.law == control::Law::kImpedance && arm->felt_mass_kg)
    lines.push_back(ImpedanceText(cell));
  else if (arm != nullptr)
    lines.push_back(fmt::format(
        "simulated arm: {:.4g} Hz, damping ratio {:.3g}, dead time {:.3g} ms (axis {} at {:.3g} mm/s, the "
        "slowest)",
        arm->bandwidth_hz, arm->damping_ratio, 1e3 * arm->dead_time_s, arm->axis, 1e3 * arm->speed_m_per_s));
  else
    lines.emplace_back("simulated arm: as the cell's file assumes it, no model of it was found");
  if (identified.sensor && identified.sensor->delay_s)
    lines.push_back(fmt::format("delay of the force sensor: {:.3g} ms, in the figure of the latency",
                                1e3 * *identified.sensor->delay_s));
  if (identified.dead_zone_N)
    lines.push_back(fmt::format("dead zone: {:.3g} N, measured {:.3g}", cell.servo.admittance.dead_zone_N,
                                *identified.dead_zone_N));
  if (identified.vibration && identified.vibration->tremor_N > 0.0)
    lines.push_back(fmt::format("tremor of the hand: {:.3g} N", identified.vibration->tremor_N));
  if (identified.vibration && !identified.vibration->notch_hz.empty())
    lines.push_back(fmt::format("width of the spindle's notches: {:.3g} Hz", cell.servo.vibration.notch_hz));
  if (!identified.hands.empty())
    lines.push_back(fmt::format("hands: {} measured, for osteon tune; the simulated operator keeps its own",
                                identified.hands.size()));
  return lines;
}

}  // namespace osteon::config
