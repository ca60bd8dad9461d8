#include "session/stops/trip_charts.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/units.h"
#include "control/arm/arm_follower.h"
#include "control/loop/tick_state.h"
#include "control/loop/tool_speed_trip.h"
#include "control/ports.h"
#include "report/svg_plot.h"
#include "safety/limits.h"
#include "safety/watchdog.h"
#include "safety/workspace.h"

namespace osteon::session {
namespace {

using control::TickRecord;
using safety::Fault;

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();  // leaves a gap in the curve
constexpr std::array<const char*, 7> kJointColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                  "#e69f00", "#56b4e9", "#555555"};

// Several charts, one above the other, with the same time axis and ticks.
class Panels {
 public:
  Panels(std::span<const TickRecord> ticks, const report::TimeAxis& time)
      : ticks_(ticks), time_(time), times_s_(time.Of(ticks)) {}

  /// Adds an empty panel; limits that are not finite are left out.
  void BeginPanel(std::string title, std::string y_label, std::vector<report::LimitLine> limits) {
    std::erase_if(limits, [](const report::LimitLine& limit) { return !std::isfinite(limit.value); });
    panels_.push_back({.title = std::move(title),
                       .y_label = std::move(y_label),
                       .limits = std::move(limits),
                       .plot_height_px = 170.0});
    if (!time_.mark.empty()) panels_.back().x_limits = {{0.0, time_.mark}};
  }

  /// Adds a curve to the newest panel. @param value  (std::size_t tick) -> double
  template <class Value>
  void AddCurve(std::string name, const char* color, const Value& value) {
    report::Series series{
        .name = std::move(name), .x = times_s_, .y = {}, .color = std::string(color), .width_px = 1.2};
    for (std::size_t i = 0; i < ticks_.size(); ++i) series.y.push_back(value(i));
    panels_.back().series.push_back(std::move(series));
  }

  /// Adds a panel with one curve and one limit.
  template <class Value>
  void AddOneCurvePanel(std::string title, std::string y_label, report::LimitLine limit, const Value& value) {
    BeginPanel(std::move(title), std::move(y_label), {std::move(limit)});
    AddCurve("", kJointColors[0], value);
  }

  /// All panels as one <svg>; empty if there are none.
  [[nodiscard]] std::string Draw() {
    if (panels_.empty()) return {};
    panels_.back().x_label = time_.label;
    return report::Svg(panels_);
  }

  [[nodiscard]] std::size_t size() const { return ticks_.size(); }
  [[nodiscard]] const TickRecord& operator[](std::size_t i) const { return ticks_[i]; }
  /// The tick before tick i; for the first tick, that tick itself.
  [[nodiscard]] const TickRecord& Before(std::size_t i) const { return ticks_[i == 0 ? 0 : i - 1]; }

 private:
  std::span<const TickRecord> ticks_;
  const report::TimeAxis& time_;
  std::vector<double> times_s_;
  std::vector<report::LineChart> panels_;
};

// A limit's line with its text, "limit 250 mm/s".
report::LimitLine Limit(double value, const char* unit) {
  return {value, fmt::format("limit {:.4g} {}", value, unit)};
}

// Converts an age to ms; NaN if there is no value yet.
double Age_ms(double age_s) { return age_s < safety::kNoAge_s ? 1e3 * age_s : kNoValue; }

// For a fault by an input that is too old: plots the age of the input, and its limit.
void AddAges(Fault fault, const TripLimits& limits, Panels& panels) {
  const safety::WatchdogParams& watchdog = limits.servo.watchdog;
  const auto age = [&](const char* title, double limit_s, const auto& age_s) {
    panels.AddOneCurvePanel(title, "age [ms]", Limit(1e3 * limit_s, "ms"),
                            [&](std::size_t i) { return Age_ms(age_s(panels[i])); });
  };
  if (fault == Fault::kArmStale)
    age("Age of the arm's last message", limits.arm_silence_s,
        [](const TickRecord& tick) { return safety::StampAge(tick.input.now, tick.input.arm_stamp); });
  if (fault == Fault::kModelStale)
    age("Age of the contact model", watchdog.model_stop_s,
        [](const TickRecord& tick) { return tick.model_age_s; });
  if (fault == Fault::kSensorStale)
    age("Age of the force sensor's reading", watchdog.sensor_stop_s,
        [](const TickRecord& tick) { return tick.sensor_age_s; });
  if (fault == Fault::kInterlock)
    age("Age of the PLC's word", watchdog.interlock_stop_s,
        [](const TickRecord& tick) { return safety::StampAge(tick.input.now, tick.input.interlock_stamp); });
  if (fault == Fault::kSpindle)
    age("Age of the drive's status", watchdog.spindle_stop_s,
        [](const TickRecord& tick) { return safety::StampAge(tick.input.now, tick.input.spindle_stamp); });
}

// Plots the signals of the PLC that must be present for a motion.
void AddPermission(Panels& panels) {
  panels.BeginPanel("What the PLC says: 1 given, 0 not", "", {{1.0, "needed"}});
  panels.AddCurve("motion permitted", kJointColors[0],
                  [&](std::size_t i) { return panels[i].input.permitted ? 1.0 : 0.0; });
  panels.AddCurve("enabling switch held", kJointColors[1],
                  [&](std::size_t i) { return panels[i].input.enabled ? 1.0 : 0.0; });
}

void AddSpindleStatus(Panels& panels) {
  panels.BeginPanel("The drive's status: 1 in order, 0 not", "", {{1.0, "needed"}});
  panels.AddCurve("ready", kJointColors[0],
                  [&](std::size_t i) { return panels[i].input.spindle_ready ? 1.0 : 0.0; });
  panels.AddCurve("without a fault", kJointColors[1],
                  [&](std::size_t i) { return panels[i].input.spindle_fault ? 0.0 : 1.0; });
}

void AddSpindleLimits(const safety::SpindleLimitParams& params, Panels& panels) {
  panels.AddOneCurvePanel("Torque of the spindle", "torque [N·m]", Limit(params.max_torque_Nm, "N·m"),
                          [&](std::size_t i) { return std::abs(panels[i].input.spindle_torque_Nm); });
  panels.AddOneCurvePanel(
      "Speed of the spindle", "speed [rpm]", Limit(params.max_speed_rad_per_s / kRpm, "rpm"),
      [&](std::size_t i) { return std::abs(panels[i].input.spindle_meas_rad_per_s) / kRpm; });
}

// Plots the apex's speed that the loop checks: under the admittance law, the commanded apex's step from tick
// to tick over the period; under the impedance law, the measured speed.
void AddToolSpeed(const control::ServoParams& servo, Panels& panels) {
  const bool measured = servo.law == control::Law::kImpedance;
  panels.BeginPanel(measured ? "Speed of the tool's apex, measured" : "Speed of the commanded apex",
                    "speed [mm/s]",
                    {Limit(1e3 * servo.twist.max_speed_m_per_s, "mm/s"),
                     {1e3 * control::ToolSpeedTripLimit_m_per_s(servo),
                      fmt::format("trip {:.4g} mm/s", 1e3 * control::ToolSpeedTripLimit_m_per_s(servo))}});
  panels.AddCurve("", kJointColors[0], [&](std::size_t i) {
    if (measured) return 1e3 * Vector3(panels[i].v_WT_cmd_m_per_s).norm();
    const Vector3 step_m =
        Pose(panels[i].X_WT_cmd).translation() - Pose(panels.Before(i).X_WT_cmd).translation();
    return 1e3 * step_m.norm() / servo.period_s;
  });
}

// Plots the measured apex's speed, and the speed that the arm may keep indefinitely
// (TripLimits::arm_speed_ratio).
void AddArmSpeed(const TripLimits& limits, Panels& panels) {
  const double max_mm_per_s =
      1e3 * limits.arm_speed_ratio * control::ToolSpeedLimit_m_per_s(limits.servo, false);
  panels.AddOneCurvePanel(
      "Speed of the measured apex between two messages; the trip comes 1 mm of way beyond the limit",
      "speed [mm/s]", Limit(max_mm_per_s, "mm/s"),
      [&](std::size_t i) { return 1e3 * panels[i].tool_speed_meas_m_per_s; });
}

// Adds a panel with a curve per joint, in percent of the joint's limit.
// @param both_ways  the value may be negative, and has a limit at -100 % as well
// @param percent  (std::size_t tick, std::size_t joint) -> double
template <class Percent>
void AddJoints(std::string title, bool both_ways, const control::ServoParams& servo, const Percent& percent,
               Panels& panels) {
  std::vector<report::LimitLine> limits{{100.0, "limit 100 %"}};
  if (both_ways) limits.push_back({-100.0, "limit -100 %"});
  panels.BeginPanel(std::move(title), "share [%]", std::move(limits));
  for (std::size_t joint = 0; joint < kJointColors.size(); ++joint) {
    // a joint without a range does not exist, such as the seventh joint of a six-axis arm
    if (!(servo.joints.limits[joint].upper_rad > servo.joints.limits[joint].lower_rad)) continue;
    panels.AddCurve(fmt::format("A{}", joint + 1), kJointColors[joint],
                    [&](std::size_t i) { return percent(i, joint); });
  }
}

// Plots the commanded positions and speeds of the joints, and their external torques if the arm's masses are
// known.
void AddJointLimits(const TripLimits& limits, Panels& panels) {
  const safety::JointGuardParams& joints = limits.servo.joints;
  AddJoints(
      "Joint positions, commanded: from the middle of a joint's range to its end", true, limits.servo,
      [&](std::size_t i, std::size_t joint) {
        const kinematics::JointLimits& limit = joints.limits[joint];
        const double middle_rad = 0.5 * (limit.upper_rad + limit.lower_rad);
        return 200.0 * (panels[i].q_cmd[joint] - middle_rad) / (limit.upper_rad - limit.lower_rad);
      },
      panels);
  AddJoints(
      "Joint speeds, commanded: of what a command may use", false, limits.servo,
      [&](std::size_t i, std::size_t joint) {
        const double max_rad_per_s = joints.speed_share * joints.limits[joint].velocity_rad_per_s;
        const double step_rad = panels[i].q_cmd[joint] - panels.Before(i).q_cmd[joint];
        return 100.0 * std::abs(step_rad) / (limits.servo.period_s * max_rad_per_s);
      },
      panels);
  if (!limits.gravity_Nm || !limits.servo.arm_body) return;
  std::vector<control::JointArray> gravity_Nm;  // computed once per tick, for all joints
  for (std::size_t i = 0; i < panels.size(); ++i) gravity_Nm.push_back(limits.gravity_Nm(panels[i].q_cmd));
  AddJoints(
      "Joint torques from outside, as they would be a message later: of what gravity leaves", false,
      limits.servo,
      [&](std::size_t i, std::size_t joint) {
        const double tau_Nm = panels[i].input.tau_ext[joint],
                     before_Nm = panels.Before(i).input.tau_ext[joint];
        const double room_Nm =
            limits.servo.arm_body->joints[joint].limits.torque_Nm - std::abs(gravity_Nm[i][joint]);
        // extrapolate by one message: the torque may grow again by its change since the last message
        return room_Nm > 0.0 ? 100.0 * (std::abs(tau_Nm) + std::abs(tau_Nm - before_Nm)) / room_Nm : kNoValue;
      },
      panels);
}

// Plots, for apex, flange and elbow, the distance to the nearest bound of this point.
void AddZones(const TripLimits& limits, Panels& panels) {
  const safety::Workspace workspace(control::WorkspaceOf(limits.servo));
  panels.BeginPanel("Distance to the nearest bound of workspace, zones and depth limit; negative: outside",
                    "distance [mm]", {{0.0, "limit 0 mm"}});
  constexpr std::array<std::pair<safety::ZonePoint, const char*>, 3> kPoints{
      {{safety::ZonePoint::kApex, "apex"},
       {safety::ZonePoint::kFlange, "flange"},
       {safety::ZonePoint::kElbow, "elbow"}}};
  for (std::size_t k = 0; k < kPoints.size(); ++k)
    if (const safety::ZonePoint point = kPoints[k].first; workspace.Has(point))
      panels.AddCurve(kPoints[k].second, kJointColors[k], [&](std::size_t i) {
        const Vector3 p_WP = limits.p_WP(panels[i], point);
        return p_WP.allFinite() ? 1e3 * workspace.Distance(p_WP, point) : kNoValue;
      });
}

// Plots the states of the arm's session and of its safety controller.
void AddSession(Panels& panels) {
  panels.BeginPanel("State of the arm's session: 4 is commanded (COMMANDING_ACTIVE)", "state",
                    {{4.0, "needed"}});
  panels.AddCurve("", kJointColors[0],
                  [&](std::size_t i) { return static_cast<double>(panels[i].session_state); });
  panels.BeginPanel("Safety state of the arm: 0 is normal, beyond it a stop's level and 1", "state",
                    {{0.0, "needed"}});
  panels.AddCurve("", kJointColors[1],
                  [&](std::size_t i) { return static_cast<double>(panels[i].input.safety_state); });
}

// Plots the period that the arm's messages state, and the time between their arrivals.
void AddPeriod(double period_s, Panels& panels) {
  panels.BeginPanel("Period of the arm's messages", "period [ms]",
                    {{1e3 * period_s, fmt::format("the cell's {:g} ms", 1e3 * period_s)}});
  panels.AddCurve("as its messages say", kJointColors[0],
                  [&](std::size_t i) { return 1e3 * panels[i].input.period_s; });
  // a tick without a message repeats the stamp of the last message
  panels.AddCurve("as they came", kJointColors[1], [&](std::size_t i) {
    const rt::Nanoseconds apart = panels[i].input.arm_stamp - panels.Before(i).input.arm_stamp;
    return apart > 0 ? 1e3 * rt::ToSeconds(apart) : kNoValue;
  });
}

// Plots the time for which limits have reduced the force without interruption; each tick counts as one
// period.
void AddForceLimitTime(const control::ServoParams& servo, Panels& panels) {
  double at_limit_s = 0.0;
  panels.AddOneCurvePanel("Time that the coupling stayed at its force limit", "time [ms]",
                          Limit(1e3 * servo.on_force_limit.stop_after_s, "ms"), [&](std::size_t i) {
                            at_limit_s = panels[i].wrench_scale < 1.0 ? at_limit_s + servo.period_s : 0.0;
                            return 1e3 * at_limit_s;
                          });
}

// Plots the change of the coupling's force from tick to tick, and its limit as recorded in each tick.
void AddWrenchRate(Panels& panels) {
  panels.BeginPanel("By how much the coupling's force grew or turned in a tick", "step [N]", {});
  panels.AddCurve("step", kJointColors[0], [&](std::size_t i) { return panels[i].wrench_step_N; });
  panels.AddCurve("limit (1.5 K v_max)", kJointColors[1], [&](std::size_t i) {
    return panels[i].wrench_step_limit_N > 0.0 ? panels[i].wrench_step_limit_N : kNoValue;
  });
}

// Plots the lateral bend of the tool and the shift of the bone's mount. Without limit lines if the cell is
// rigid.
void AddDeflection(const control::ComplianceParams& params, Panels& panels) {
  const double bend_mm = params.tool ? 1e3 * params.tool->max_bend_m : 0.0;
  const double shift_mm = params.mount ? 1e3 * params.mount->max_shift_m : 0.0;
  panels.AddOneCurvePanel("Lateral bend of the tool", "bend [mm]", Limit(bend_mm, "mm"), [&](std::size_t i) {
    return 1e3 * Vector3(panels[i].compliance.bend_m).head<2>().norm();
  });
  panels.AddOneCurvePanel("Shift of the bone on its mount", "shift [mm]", Limit(shift_mm, "mm"),
                          [&](std::size_t i) { return 1e3 * Vector3(panels[i].compliance.mount_m).norm(); });
}

// Adds the panels for a fault of force, depth in bone, deflection or force sensor.
void AddForces(Fault fault, const control::ServoParams& servo, Panels& panels) {
  if (fault == Fault::kWrenchRate) AddWrenchRate(panels);
  if (fault == Fault::kForceLimit) AddForceLimitTime(servo, panels);
  if (fault == Fault::kSensorForce)
    panels.AddOneCurvePanel("Force of the hand", "force [N]",
                            Limit(servo.wrench.max_force_N + servo.sensor_force.margin_N, "N"),
                            [&](std::size_t i) { return Vector3(panels[i].F_operator_T_W.f).norm(); });
  if (fault == Fault::kToolInBone)
    panels.AddOneCurvePanel("Commanded tool beyond its collision-free pose", "in bone [mm]",
                            Limit(1e3 * servo.on_force_limit.max_tool_in_bone_m, "mm"), [&](std::size_t i) {
                              return control::HasMessage(panels[i]) ? 1e3 * panels[i].tool_in_bone_m
                                                                    : kNoValue;
                            });
  if (fault == Fault::kDeflection) AddDeflection(servo.compliance, panels);
  if (fault == Fault::kSensorFault) {
    panels.BeginPanel("The force sensor trusts its reading: 1 yes, 0 no", "", {{1.0, "needed"}});
    panels.AddCurve("", kJointColors[0],
                    [&](std::size_t i) { return panels[i].input.sensor_trusted ? 1.0 : 0.0; });
  }
}

// Adds the panels for a fault of motion: speed, zones, joints, tracking.
void AddMotion(Fault fault, const TripLimits& limits, Panels& panels) {
  if (fault == Fault::kToolSpeed) AddToolSpeed(limits.servo, panels);
  if (fault == Fault::kArmSpeed) AddArmSpeed(limits, panels);
  if (fault == Fault::kWorkspace) AddZones(limits, panels);
  if (fault == Fault::kJointLimit || fault == Fault::kInverseKinematics) AddJointLimits(limits, panels);
  if (fault == Fault::kTracking)
    panels.AddOneCurvePanel(
        "From the commanded to the measured apex", "distance [mm]",
        Limit(1e3 * limits.servo.max_tracking_error_m, "mm"), [&](std::size_t i) {
          return 1e3 *
                 (Pose(panels[i].X_WT_cmd).translation() - Pose(panels[i].X_WT_meas).translation()).norm();
        });
}

// Adds the panels for a fault of the arm's connection: session, period, command mode.
void AddArm(Fault fault, const control::ServoParams& servo, Panels& panels) {
  if (fault == Fault::kSession) AddSession(panels);
  if (fault == Fault::kPeriod) AddPeriod(servo.period_s, panels);
  if (fault == Fault::kCommandMode) {
    const bool impedance = servo.law == control::Law::kImpedance;
    panels.BeginPanel("Command mode that the arm's program asks for: 1 POSITION, 2 WRENCH, 3 TORQUE", "mode",
                      {{impedance ? 2.0 : 1.0, impedance ? "needed: 2 or 3" : "needed: 1"}});
    panels.AddCurve("", kJointColors[0],
                    [&](std::size_t i) { return static_cast<double>(panels[i].input.command_mode); });
  }
}

}  // namespace

std::string TripChart(Fault fault, std::span<const TickRecord> ticks, const TripLimits& limits,
                      const report::TimeAxis& time) {
  Panels panels(ticks, time);
  AddAges(fault, limits, panels);
  if (fault == Fault::kInterlock) AddPermission(panels);
  if (fault == Fault::kSpindle) AddSpindleStatus(panels);
  if (fault == Fault::kSpindleLimit) AddSpindleLimits(limits.servo.spindle_limits, panels);
  AddForces(fault, limits.servo, panels);
  AddMotion(fault, limits, panels);
  AddArm(fault, limits.servo, panels);
  return panels.Draw();
}

}  // namespace osteon::session
