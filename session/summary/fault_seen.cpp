#include "session/summary/fault_seen.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "control/loop/tool_speed_trip.h"
#include "io/can/drive_fault_text.h"
#include "io/fri/session_name.h"
#include "io/modbus/plc_client.h"
#include "safety/watchdog.h"

namespace osteon::session {
namespace {

using control::TickRecord;

// Formats an age, "8 ms old", or returns `never` if no message has come.
std::string AgeText(double age_s, const char* never) {
  return age_s < safety::kNoAge_s ? fmt::format("{:.0f} ms old", age_s * 1e3) : never;
}

std::string AgeText(const TickRecord& tick, rt::Nanoseconds stamp, const char* never) {
  return AgeText(safety::StampAge(tick.input.now, stamp), never);
}

// Describes the PLC's permission: the reason for withholding it (without the text's end ": Stop 1"), the
// enabling switch, and the age of the PLC's message.
std::string DescribeInterlock(const TickRecord& tick) {
  const std::string age = AgeText(tick, tick.input.interlock_stamp, "none yet");
  if (tick.input.permitted)
    return std::string(tick.input.enabled ? "permitted" : "ENABLING_SWITCH (979) is not held") +
           "; the PLC's word: " + age;
  const std::string verdict = io::Describe(static_cast<io::PlcVerdict>(tick.input.interlock_reason));
  return verdict.substr(0, verdict.rfind(':')) + "; the PLC's word: " + age;
}

// Describes the drive's state, with the names and numbers that the drive has reported.
std::string DescribeSpindle(const TickRecord& tick) {
  const control::TickInput& in = tick.input;
  const std::string why = io::DescribeDriveFaults(
      {in.drive_faults, in.drive_nmt_state, in.drive_emergency_code, in.drive_error_code});
  return fmt::format("{}; its status: {}",
                     in.spindle_fault    ? (why.empty() ? "a fault" : "a fault: " + why)
                     : !in.spindle_ready ? "not ready"
                                         : "ready",
                     AgeText(tick, in.spindle_stamp, "none yet"));
}

double Distance_mm(const PlainPose& a, const PlainPose& b) {
  return 1e3 * (Pose(a).translation() - Pose(b).translation()).norm();
}

std::string ApexText(const PlainPose& X_WT) {
  const Vector3 p_mm = 1e3 * Pose(X_WT).translation();
  return fmt::format("the apex at ({:.1f}, {:.1f}, {:.1f}) mm in W", p_mm.x(), p_mm.y(), p_mm.z());
}

// Returns "joint A3 measured nan" for the first value that is not finite; empty if all are finite.
std::string FirstNotFinite(const std::array<double, 7>& values, const char* what) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i])) return fmt::format("joint A{} {} {}", i + 1, what, values[i]);
  return "";
}

// Names the first input of a tick that is not finite, with its value. If arm and sensor are finite, names the
// contact model.
std::string DescribeNotFinite(const TickRecord& tick) {
  std::string text = FirstNotFinite(tick.q_meas, "measured");
  if (text.empty() && tick.input.has_ipo) text = FirstNotFinite(tick.input.q_ipo, "of the interpolator");
  if (text.empty()) text = FirstNotFinite(tick.input.tau_ext, "external torque");
  if (!text.empty()) return "the arm's " + text;
  constexpr std::array<const char*, 6> kAxes{"Fx", "Fy", "Fz", "Tx", "Ty", "Tz"};
  const PlainWrench& F = tick.input.F_sensor_S;
  const std::array<double, 6> wrench{F.f.x, F.f.y, F.f.z, F.t.x, F.t.y, F.t.z};
  for (std::size_t i = 0; i < wrench.size(); ++i)
    if (!std::isfinite(wrench[i])) return fmt::format("the force sensor's {} {}", kAxes[i], wrench[i]);
  return fmt::format("arm and sensor were finite: the contact model of frame {}", tick.model_frame);
}

// Formats the accepted value as a suffix to the measured one, ", accepted 100 ms"; empty if the cell's
// parameters are not known.
class AcceptedSuffix {
 public:
  explicit AcceptedSuffix(const control::ServoParams* servo) : servo_(servo) {}

  /// @param unit  unit of the measured value and of the limit;  @param limit  (const control::ServoParams&)
  /// -> double
  template <class Limit>
  [[nodiscard]] std::string operator()(const char* unit, const Limit& limit) const {
    return servo_ == nullptr ? std::string() : fmt::format(", accepted {:.4g} {}", limit(*servo_), unit);
  }

 private:
  const control::ServoParams* servo_;
};

// Formats the number of the arm's messages that were rejected, as a suffix.
std::string RejectedText(const TickRecord& tick) {
  return tick.input.rejected == 0
             ? std::string()
             : fmt::format(
                   "; {} messages of this run were refused (damaged, a value that is not finite, another "
                   "sender or version)",
                   tick.input.rejected);
}

}  // namespace

const TickRecord* FirstWith(safety::Fault fault, std::span<const TickRecord> ticks) {
  const auto first = std::ranges::find_if(
      ticks, [&](const TickRecord& t) { return (t.faults & static_cast<std::uint32_t>(fault)) != 0; });
  return first == ticks.end() ? nullptr : &*first;
}

std::string SeenAt(safety::Fault fault, const TickRecord& tick, const control::ServoParams* servo) {
  using safety::Fault;
  using Servo = control::ServoParams;
  const AcceptedSuffix accepted(servo);
  switch (fault) {
    case Fault::kArmStale:
      return servo == nullptr ? ""
                              : fmt::format("the last is {}; {} deadlines in a row{}",
                                            AgeText(tick, tick.input.arm_stamp, "not there yet"),
                                            servo->watchdog.arm_misses, RejectedText(tick));
    case Fault::kModelStale:
      return "the model is " + AgeText(tick.model_age_s, "not there yet") +
             accepted("ms", [](const Servo& p) { return 1e3 * p.watchdog.model_stop_s; });
    case Fault::kSensorStale:
      return "the reading is " + AgeText(tick.sensor_age_s, "not there yet") +
             accepted("ms", [](const Servo& p) { return 1e3 * p.watchdog.sensor_stop_s; });
    case Fault::kWrenchRate:
      if (tick.wrench_step_limit_N == 0.0) return "";  // an older version did not record the step
      return fmt::format("{:.1f} N in {:g} ms, accepted {:.1f} N", tick.wrench_step_N,
                         1e3 * tick.input.period_s, tick.wrench_step_limit_N);
    case Fault::kSensorForce:
      return fmt::format("{:.0f} N", Vector3(tick.F_operator_T_W.f).norm()) +
             accepted("N", [](const Servo& p) { return p.wrench.max_force_N + p.sensor_force.margin_N; });
    case Fault::kToolSpeed:
      return fmt::format("{:.0f} mm/s", 1e3 * Vector3(tick.v_WT_cmd_m_per_s).norm()) +
             accepted("mm/s", [](const Servo& p) { return 1e3 * control::ToolSpeedTripLimit_m_per_s(p); });
    case Fault::kWorkspace:
      return ApexText(tick.X_WT_cmd);
    case Fault::kSession:
      return tick.input.safety_state == 0
                 ? fmt::format("session state {} ({})", tick.session_state,
                               io::SessionName(static_cast<control::SessionState>(tick.session_state)))
                 : fmt::format("safety stop {}", tick.input.safety_state - 1);
    case Fault::kNotFinite:
      return DescribeNotFinite(tick);
    case Fault::kTracking:
      return fmt::format("{:.1f} mm", Distance_mm(tick.X_WT_cmd, tick.X_WT_meas)) +
             accepted("mm", [](const Servo& p) { return 1e3 * p.max_tracking_error_m; });
    case Fault::kPeriod:
      return fmt::format("{:g} ms", 1e3 * tick.input.period_s) +
             accepted("ms", [](const Servo& p) { return 1e3 * p.period_s; });
    case Fault::kInterlock:
      return DescribeInterlock(tick);
    case Fault::kSpindle:
      return DescribeSpindle(tick);
    case Fault::kForceLimit:  // the recorded force is the coupling's force times the limit's scale
      if (!(tick.wrench_scale > 0.0)) return "";
      return fmt::format("{:.0f} N asked of the coupling",
                         Vector3(tick.F_coupling_T_W.f).norm() / tick.wrench_scale) +
             accepted("N", [](const Servo& p) { return p.wrench.max_force_N; });
    case Fault::kToolInBone:
      return fmt::format("{:.1f} mm", 1e3 * tick.tool_in_bone_m) +
             accepted("mm", [](const Servo& p) { return 1e3 * p.on_force_limit.max_tool_in_bone_m; });
    case Fault::kArmSpeed:
      return fmt::format("{:.0f} mm/s in the last message", 1e3 * tick.tool_speed_meas_m_per_s);
    case Fault::kSpindleLimit:
      return fmt::format("{:.2f} N·m at {:.0f} rad/s", tick.input.spindle_torque_Nm,
                         tick.input.spindle_meas_rad_per_s);
    default:  // the tick's record has no value for these faults
      return "";
  }
}

}  // namespace osteon::session
