#include "session/summary/latency.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "config/reading/cell_config.h"
#include "control/ports.h"
#include "safety/watchdog.h"

namespace osteon::session {
namespace {

// If the sum of the squared command steps is smaller, the arm moved too little to measure its delay.
constexpr double kMinMoved_rad2 = 1e-6;

// Mean of the latency part with this name [s]; 0 if there is none.
double MeanOfPart_s(const LatencyFigures& latency, const char* name) {
  for (const LatencyPart& part : latency.parts)
    if (part.name == name) return part.mean_s;
  return 0.0;
}

}  // namespace

void LatencyMeter::Mean::Add(double value_s) {
  ++count;
  sum_s += value_s;
  max_s = std::max(max_s, value_s);
}

void LatencyMeter::Add(const control::TickRecord& tick) {
  if (tick.session_state != static_cast<std::uint8_t>(control::SessionState::kCommandingActive)) {
    kept_ = 0;
    return;
  }
  // before the first reading there is no age
  if (tick.sensor_age_s < safety::kNoAge_s) sensor_.Add(tick.sensor_age_s);
  link_.Add(rt::ToSeconds(tick.wakeup_ns));
  tick_.Add(rt::ToSeconds(tick.compute_ns));
  if (tick.phase == control::Phase::kHaptic && tick.model_age_s < safety::kNoAge_s)
    model_.Add(tick.model_age_s);
  // in the command modes wrench and torque, the commanded position only follows the arm
  if (tick.input.command_mode == static_cast<std::uint8_t>(control::CommandMode::kPosition)) AddMotion(tick);
}

void LatencyMeter::AddMotion(const control::TickRecord& tick) {
  sent_[next_] = tick.q_cmd;
  const std::size_t newest = next_;
  next_ = (next_ + 1) % kTicks;
  if (kept_ < kTicks) {
    ++kept_;
    return;
  }
  const std::array<double, 7>& before = sent_[(newest + kTicks - 1) % kTicks];
  for (std::size_t j = 0; j < before.size(); ++j) {
    const double step = tick.q_cmd[j] - before[j];
    moved_ += step * step;
  }
  for (std::size_t delay = 0; delay < kTicks; ++delay) {
    const std::array<double, 7>& sent = sent_[(newest + kTicks - delay) % kTicks];
    for (std::size_t j = 0; j < sent.size(); ++j) {
      const double difference_rad = tick.q_meas[j] - sent[j];
      error_[delay] += difference_rad * difference_rad;
    }
  }
}

double LatencyMeter::ArmDelay_ticks() const {
  if (moved_ < kMinMoved_rad2) return -1.0;
  const auto best = static_cast<std::size_t>(std::ranges::min_element(error_) - error_.begin());
  if (best == 0) return 0.0;
  if (best + 1 == kTicks) return -1.0;  // the delay may be longer than kTicks
  // interpolate: take the minimum of the parabola through the smallest sum of squares and its two neighbours
  const double left = error_[best - 1], middle = error_[best], right = error_[best + 1];
  const double curvature = left - 2.0 * middle + right;
  const double shift = curvature > 0.0 ? 0.5 * (left - right) / curvature : 0.0;
  return static_cast<double>(best) + shift;
}

namespace {

// Makes the latency part of an arm that follows position commands. @param ticks  delay of the arm in ticks;
// negative: not known
LatencyPart FollowingArm(double ticks, double period_s) {
  const double delay_s = std::max(0.0, ticks) * period_s;
  return {.name = "arm",
          .mean_s = delay_s,
          .max_s = delay_s,
          .measured = ticks >= 0.0,
          .how = ticks >= 0.0 ? "measured positions against the commands"
                              : "taken as 0: no position commands that moved enough to tell it"};
}

// Makes the latency part of an arm in its own impedance control, to which the loop's forces are added: the
// dead time of these forces.
LatencyPart OverlaidArm(const LatencyContext& context) {
  return {.name = "arm",
          .mean_s = context.arm_dead_time_s,
          .max_s = context.arm_dead_time_s,
          .measured = context.arm_known,
          .how = context.arm_known ? "the identified dead time of a force"
                                   : "dead time of the cell's simulated arm"};
}

}  // namespace

LatencyFigures LatencyMeter::Figures(double period_s, const LatencyContext& context) const {
  LatencyFigures latency;
  if (link_.count == 0) return latency;
  const bool has_readings = sensor_.count > 0;
  const double sensor_delay_s = context.sensor_delay_s;  // delay from the force to the reading's stamp
  latency.parts.push_back(
      {.name = "sensor",
       .mean_s = sensor_.Value() + sensor_delay_s,
       .max_s = sensor_.max_s + sensor_delay_s,
       .measured = context.sensor_known && has_readings,
       .how = !has_readings ? "taken as 0: no reading came"
              : context.sensor_known
                  ? "the reading's stamp, and the sensor's identified delay"
                  : "counted from the stamp of its reading; its own delay is not known and taken as 0"});
  const bool timed = !context.virtual_time;
  const auto add_scheduling_part = [&](const char* name, const Mean& mean, const char* how) {
    latency.parts.push_back({.name = name,
                             .mean_s = timed ? mean.Value() : 0.0,
                             .max_s = timed ? mean.max_s : 0.0,
                             .measured = timed,
                             .how = timed ? how : "taken as 0: virtual time"});
  };
  add_scheduling_part("link", link_, "from the message's arrival to the loop's wake-up");
  add_scheduling_part("tick", tick_, "from the wake-up to the answer");
  latency.parts.push_back(context.overlay ? OverlaidArm(context) : FollowingArm(ArmDelay_ticks(), period_s));
  latency.parts.push_back({.name = "model",
                           .mean_s = model_.Value(),
                           .max_s = model_.max_s,
                           .measured = model_.count > 0,
                           .how = model_.count > 0 ? "age of the pose of the contact model in force"
                                                   : "assumed 0: nothing was rendered"});
  const double loop_s =
      MeanOfPart_s(latency, "link") + MeanOfPart_s(latency, "tick") + MeanOfPart_s(latency, "arm");
  latency.hand_moves_arm = context.overlay;
  latency.hand_to_arm_s = context.overlay ? 0.0 : MeanOfPart_s(latency, "sensor") + loop_s;
  latency.bone_to_hand_s = MeanOfPart_s(latency, "model") + loop_s;
  return latency;
}

LatencyContext LatencyContextOf(const config::CellConfig& cell, bool virtual_time) {
  LatencyContext context{.virtual_time = virtual_time};
  if (cell.identified && cell.identified->sensor && cell.identified->sensor->delay_s) {
    context.sensor_delay_s = *cell.identified->sensor->delay_s;
    context.sensor_known = true;
  }
  context.overlay = cell.servo.law == control::Law::kImpedance;
  if (!context.overlay) return context;
  context.arm_dead_time_s = cell.simulated.dynamic.dead_cycles * cell.servo.period_s;
  if (cell.identified)  // take the longest identified dead time
    for (const config::IdentifiedArm& arm : cell.identified->arm) {
      context.arm_dead_time_s =
          context.arm_known ? std::max(context.arm_dead_time_s, arm.dead_time_s) : arm.dead_time_s;
      context.arm_known = true;
    }
  return context;
}

bool LatencyFigures::Measured() const {
  return !parts.empty() && std::ranges::all_of(parts, &LatencyPart::measured);
}

nlohmann::json ToJson(const LatencyFigures& latency) {
  if (latency.parts.empty()) return nullptr;
  nlohmann::json parts = nlohmann::json::object();
  for (const LatencyPart& part : latency.parts)
    parts[part.name] = {{"mean", 1e3 * part.mean_s},
                        {"max", 1e3 * part.max_s},
                        {"measured", part.measured},
                        {"how", part.how}};
  return {{"hand_to_arm",
           latency.hand_moves_arm ? nlohmann::json() : nlohmann::json(1e3 * latency.hand_to_arm_s)},
          {"bone_to_hand", 1e3 * latency.bone_to_hand_s},
          {"measured", latency.Measured()},
          {"parts", parts}};
}

std::string LatencyText(const LatencyFigures& latency) {
  if (latency.parts.empty()) return "not measured: the arm was never commanded";
  std::string parts, assumed;
  for (const LatencyPart& part : latency.parts) {
    parts += fmt::format("{}{} {:.2f}", parts.empty() ? "" : ", ", part.name, 1e3 * part.mean_s);
    if (!part.measured) assumed += fmt::format("{}{} ({})", assumed.empty() ? "" : "; ", part.name, part.how);
  }
  const std::string from_hand =
      latency.hand_moves_arm
          ? std::string("the hand moves the arm itself")
          : fmt::format("{:.1f} ms from the hand's force to the arm", 1e3 * latency.hand_to_arm_s);
  return fmt::format("{}, {:.1f} ms from the bone to the hand ({} ms){}", from_hand,
                     1e3 * latency.bone_to_hand_s, parts, assumed.empty() ? "" : "; assumed: " + assumed);
}

}  // namespace osteon::session
