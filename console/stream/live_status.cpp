#include "console/stream/live_status.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "safety/acting_limits.h"
#include "safety/cell_state.h"
#include "safety/fault.h"
#include "safety/motion_permit.h"
#include "safety/watchdog.h"

namespace osteon::console {
namespace {

// Each Add function fills in one part of the status.
void AddState(const control::TickRecord& tick, LiveStatus& status) {
  if (tick.cell_state >= safety::kCellStates) return;
  const auto state = static_cast<safety::CellState>(tick.cell_state);
  const safety::CellStateText text = safety::Describe(state);
  status.state_number = tick.cell_state;
  status.state = text.name;
  status.does = text.does;
  status.leave = text.leave;
  status.can_resume = state == safety::CellState::kPaused;
  status.can_pause = safety::Next(state, safety::CellEvent::kPauseRequested).state != state;
}

void AddPermits(const control::TickRecord& tick, LiveStatus& status) {
  if (tick.cell_state >= safety::kCellStates) return;
  const auto state = static_cast<safety::CellState>(tick.cell_state);
  status.moves = safety::IsMotion(state);
  // in the state off the arm sends nothing, so the conditions of motion are not evaluated
  status.permits_known = status.moves || state == safety::CellState::kPaused ||
                         (safety::Waits(state) && state != safety::CellState::kOff);
  const safety::MotionPermits permits(status.moves ? safety::MotionPermits::kAll : tick.permits);
  for (int bit = 0; bit < safety::kMotionPermits; ++bit) {
    const auto permit = static_cast<safety::MotionPermit>(1u << bit);
    status.permits.push_back({.text = safety::DescribeMissing(permit), .holds = permits.Has(permit)});
  }
}

// Adds the latched faults, and whether a recovery may clear them now.
void AddFaults(const control::TickRecord& tick, const LiveContext& context, LiveStatus& status) {
  safety::FaultSet faults;
  for (int bit = 0; bit < safety::kFaultCount; ++bit) {
    if ((tick.faults >> bit & 1u) == 0) continue;
    const auto fault = static_cast<safety::Fault>(1u << bit);
    const safety::FaultText text = safety::Describe(fault);
    status.faults.push_back({text.name, text.cause, text.reaction, text.clearing,
                             safety::AllowsRecovery(fault),
                             context.fault ? context.fault(1u << bit) : FaultNote{}});
    faults.Latch(fault);
  }
  if (tick.cell_state >= safety::kCellStates || tick.input.stop) return;
  const auto state = static_cast<safety::CellState>(tick.cell_state);
  status.can_recover =
      safety::Next(state, safety::CellEvent::kRecover).state == safety::CellState::kRecovery &&
      safety::AllowsRecovery(faults);
}

void AddLimits(const LiveWindow& w, LiveStatus& status) {
  for (int i = 0; i < static_cast<int>(safety::kLimitCount); ++i)
    if (w.limits >> i & 1u) {
      status.limits.push_back(LimitName(i));
      status.limit_numbers.push_back(i);
      status.limits_for_s.push_back(rt::ToSeconds(w.tick.stamp - w.limit_since[static_cast<std::size_t>(i)]));
    }
}

// The limits that reduce the rendered wrench; the one on which an operator has most influence comes first.
constexpr std::array kForceLimits{safety::Limit::kArmTorque,    safety::Limit::kPower,
                                  safety::Limit::kStoredEnergy, safety::Limit::kTank,
                                  safety::Limit::kAgeGovernor,  safety::Limit::kWrench};

void AddForce(const control::TickRecord& tick, const LiveContext& context, LiveStatus& status) {
  status.force_N = Length(tick.F_coupling_T_W.f);
  status.hand_N = Length(tick.F_operator_T_W.f);
  status.torque_Nm = Length(tick.F_coupling_T_W.t);
  status.torque_limit_Nm = context.torque_limit_Nm;
  status.force_limit_from = context.force_limit_from;
  status.force_limit_now_N = status.force_limit_N;
  const safety::LimitSet acting(tick.limits);
  const auto* const limit = std::ranges::find_if(kForceLimits, [&](auto each) { return acting.Has(each); });
  if (limit == kForceLimits.end()) return;
  status.force_limit_number = static_cast<int>(*limit);
  status.force_limit_now_N = std::min(status.force_N, status.force_limit_N);
}

// Adds the tool's commanded speed, feed and depth left, and the spindle's speed and torque.
void AddMotion(const control::TickRecord& tick, const LiveContext& context, LiveStatus& status) {
  const PlainVector3& v = tick.v_WT_cmd_m_per_s;
  status.speed_mm_per_s = 1e3 * Length(v);
  if (const auto& axis = context.axis_W)
    status.feed_mm_per_s = -1e3 * (v.x * axis->x + v.y * axis->y + v.z * axis->z);
  status.spindle_rpm = tick.input.spindle_meas_rad_per_s * 30.0 / std::numbers::pi;
  status.spindle_torque_Nm = tick.input.spindle_torque_Nm;
  if (context.depth_left_m) status.depth_left_mm = 1e3 * context.depth_left_m(tick);
}

// Adds ages of the inputs, tick times, lost messages, disk space and latency.
void AddHealth(const LiveWindow& w, const LiveContext& context, LiveStatus& status) {
  const auto age_ms = [](double age_s) {
    return age_s < safety::kNoAge_s ? std::optional(1e3 * age_s) : std::nullopt;
  };
  status.arm_age_ms = age_ms(w.arm_age_s.most);
  if (context.has_plc) status.plc_age_ms = age_ms(w.interlock_age_s.most);
  status.model_age_ms = age_ms(w.tick.model_age_s);
  status.sensor_age_ms = age_ms(w.tick.sensor_age_s);
  status.compute_p99_us = w.compute_p99_us;
  status.wakeup_p99_us = w.wakeup_p99_us;
  status.arm_messages_lost = w.tick.input.lost;
  status.answers_lost = w.tick.input.answers_lost;
  if (context.disk_left_B) status.disk_left_B = context.disk_left_B();
  if (context.latency) status.latency = context.latency();
}

template <class T>
nlohmann::json OrNull(const std::optional<T>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

// Mean times in ms; null before the arm was commanded.
nlohmann::json LatencyJson(const LatencyStatus& latency) {
  if (!latency.known) return nullptr;
  nlohmann::json parts = nlohmann::json::object();
  for (const LatencyPartStatus& part : latency.parts)
    parts[part.name] = {{"mean", part.mean_ms}, {"measured", part.measured}};
  return {{"hand_to_arm", latency.hand_moves_arm ? nlohmann::json() : nlohmann::json(latency.hand_to_arm_ms)},
          {"bone_to_hand", latency.bone_to_hand_ms},
          {"measured", latency.measured},
          {"parts", parts}};
}

// Rendered time as text: "12.0 of 60.0 s, paused 3.0 s". @param wanted_s  time after which the run ends; 0:
// no end
std::string TimeText(const LiveStatus& s, double wanted_s) {
  std::string text = wanted_s > 0.0
                         ? fmt::format("{:.1f} of {:.1f} s", std::min(s.rendered_s, wanted_s), wanted_s)
                         : fmt::format("{:.1f} s", s.rendered_s);
  if (s.paused_s > 0.0) text += fmt::format(", paused {:.1f} s", s.paused_s);
  return text;
}

}  // namespace

std::string LimitName(int number) {
  std::string name(safety::kLimitNames.at(static_cast<std::size_t>(number)));
  std::ranges::replace(name, '_', ' ');
  return name;
}

LiveStatus StatusOf(const LiveWindow& w, const LiveContext& context) {
  LiveStatus s;
  s.force_limit_N = context.force_limit_N;
  s.known = w.number > 0;
  if (!s.known) return s;
  AddState(w.tick, s);
  AddPermits(w.tick, s);
  AddFaults(w.tick, context, s);
  AddLimits(w, s);
  AddForce(w.tick, context, s);
  AddMotion(w.tick, context, s);
  AddHealth(w, context, s);
  s.gives_way = w.tick.compliance.present;
  s.bend_mm = 1e3 * Length(w.tick.compliance.bend_m);
  s.layer_mm = 1e3 * Length(w.tick.compliance.layer_m);
  s.mount_mm = 1e3 * Length(w.tick.compliance.mount_m);
  s.rendered_s = w.rendered_s;
  s.paused_s = w.paused_s;
  if (context.bone_age_s)
    if (const auto age_s = context.bone_age_s()) s.bone_age_ms = 1e3 * *age_s;
  if (w.frame.model.frame == 0) return s;
  s.frame_us = 1e-3 * static_cast<double>(w.frame.duration_ns);
  s.deepest_mm = 1e3 * w.frame.cup_depth_m;
  s.depth_mm = context.depth_m ? 1e3 * context.depth_m(w.frame.model.X_WP) : s.deepest_mm;
  s.removed_mm3 = 1e9 * w.frame.model.removed_volume_m3;
  return s;
}

std::string StatusLine(const LiveStatus& s, double wanted_s, std::size_t columns) {
  if (!s.known) return "waits for the first message";
  // The most important parts come first. A part that does not fit on a narrow terminal is left out.
  const std::string limit = s.limits.empty() ? "" : fmt::format("{}", fmt::join(s.limits, ", "));
  std::vector<std::string> parts{s.state, TimeText(s, wanted_s), fmt::format("{:5.1f} N", s.force_N),
                                 fmt::format("depth {:5.2f} mm", s.depth_mm)};
  if (!limit.empty()) parts.push_back("limit: " + limit);
  if (s.model_age_ms) parts.push_back(fmt::format("model {:.1f} ms", *s.model_age_ms));
  std::string line;
  for (const std::string& part : parts) {
    const std::size_t separator = line.empty() ? 0 : 3;
    if (base::ColumnsOf(line) + separator + base::ColumnsOf(part) > columns) continue;
    line += (line.empty() ? "" : " | ") + part;
  }
  return line;
}

std::string StatusJson(const LiveStatus& s) {
  nlohmann::json permits = nlohmann::json::array(), faults = nlohmann::json::array();
  for (const PermitStatus& permit : s.permits)
    permits.push_back({{"text", permit.text}, {"holds", permit.holds}});
  for (const FaultStatus& fault : s.faults)
    faults.push_back({{"name", fault.name},
                      {"cause", fault.cause},
                      {"reaction", fault.reaction},
                      {"clearing", fault.clearing},
                      {"allows_recovery", fault.allows_recovery},
                      {"seen", fault.note.seen},
                      {"page", fault.note.page}});
  const nlohmann::json json{{"schema", "osteon.status/1"},
                            {"known", s.known},
                            {"state", s.state},
                            {"state_number", s.state_number},
                            {"does", s.does},
                            {"leave", s.leave},
                            {"can_pause", s.can_pause},
                            {"can_resume", s.can_resume},
                            {"can_recover", s.can_recover},
                            {"permits", permits},
                            {"moves", s.moves},
                            {"permits_known", s.permits_known},
                            {"limits", s.limits},
                            {"limit_numbers", s.limit_numbers},
                            {"limits_for_s", s.limits_for_s},
                            {"faults", faults},
                            {"force_N", s.force_N},
                            {"force_limit_N", s.force_limit_N},
                            {"force_limit_from", s.force_limit_from},
                            {"force_limit_now_N", s.force_limit_now_N},
                            {"force_limit_number", s.force_limit_number},
                            {"torque_Nm", s.torque_Nm},
                            {"torque_limit_Nm", s.torque_limit_Nm},
                            {"hand_N", s.hand_N},
                            {"depth_mm", s.depth_mm},
                            {"deepest_mm", s.deepest_mm},
                            {"depth_left_mm", std::isfinite(s.depth_left_mm) ? nlohmann::json(s.depth_left_mm)
                                                                             : nlohmann::json(nullptr)},
                            {"feed_mm_per_s", OrNull(s.feed_mm_per_s)},
                            {"speed_mm_per_s", s.speed_mm_per_s},
                            {"spindle_rpm", s.spindle_rpm},
                            {"spindle_torque_Nm", s.spindle_torque_Nm},
                            {"removed_mm3", s.removed_mm3},
                            {"gives_way", s.gives_way},
                            {"bend_mm", s.bend_mm},
                            {"layer_mm", s.layer_mm},
                            {"mount_mm", s.mount_mm},
                            {"model_age_ms", OrNull(s.model_age_ms)},
                            {"sensor_age_ms", OrNull(s.sensor_age_ms)},
                            {"bone_age_ms", OrNull(s.bone_age_ms)},
                            {"arm_age_ms", OrNull(s.arm_age_ms)},
                            {"plc_age_ms", OrNull(s.plc_age_ms)},
                            {"frame_us", s.frame_us},
                            {"compute_p99_us", s.compute_p99_us},
                            {"wakeup_p99_us", s.wakeup_p99_us},
                            {"arm_messages_lost", s.arm_messages_lost},
                            {"answers_lost", s.answers_lost},
                            {"disk_left_B", OrNull(s.disk_left_B)},
                            {"rendered_s", s.rendered_s},
                            {"paused_s", s.paused_s},
                            {"latency_ms", LatencyJson(s.latency)}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace osteon::console
