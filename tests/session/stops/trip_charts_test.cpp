// The charts of a stop's page: the quantity that stopped the cell, with its limit.

#include "session/stops/trip_charts.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/report/report_markup.h"

namespace osteon::session {
namespace {

using control::TickRecord;
using safety::Fault;

// Ticks from a second before the stop to half a second after it.
std::vector<TickRecord> Ticks() {
  std::vector<TickRecord> ticks(1500);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    TickRecord& tick = ticks[i];
    tick.stamp = static_cast<rt::Nanoseconds>(i + 1) * rt::kMillisecond;
    tick.input.now = tick.stamp;
    tick.input.arm_stamp = tick.input.sensor_stamp = tick.input.spindle_stamp = tick.input.interlock_stamp =
        tick.stamp - rt::kMillisecond / 2;
    tick.input.period_s = 0.001;
    tick.wrench_step_limit_N = 13.5;
    tick.X_WT_cmd = tick.X_WT_meas = Pose::Identity();
  }
  return ticks;
}

// The limits that the charts show; the cases below name them as text.
TripLimits Limits() {
  TripLimits limits;
  for (kinematics::JointLimits& joint : limits.servo.joints.limits)
    joint = {.lower_rad = -2.0, .upper_rad = 2.0, .velocity_rad_per_s = 1.5, .acceleration_rad_per_s2 = 5.0};
  limits.servo.twist.max_speed_m_per_s = 0.25;
  limits.servo.wrench.max_force_N = 200.0;
  limits.servo.on_force_limit.max_tool_in_bone_m = 0.004;
  limits.servo.spindle_limits = {.max_torque_Nm = 9.0, .max_speed_rad_per_s = 40.0};
  limits.servo.workspace.plane_offset_m = -0.3;
  limits.arm_silence_s = 0.025;
  limits.arm_speed_ratio = 1.5;
  limits.servo.compliance.tool = control::ToolLinkParams{.max_bend_m = 6.5e-3};
  limits.servo.compliance.mount = control::BoneMountParams{};
  limits.p_WP = [](const TickRecord& tick, safety::ZonePoint) -> Vector3 {
    return Pose(tick.X_WT_cmd).translation();
  };
  return limits;
}

// A fault, and what its chart must show.
struct Case {
  Fault fault;
  const char* quantity;                     ///< text in a panel's title
  const char* limit;                        ///< text at the limit's line
  std::function<void(TickRecord&)> change;  ///< changes the quantity in a tick
};

std::vector<Case> Cases() {
  const auto moved = [](double way_m) {
    return [way_m](TickRecord& tick) {
      Pose X = Pose::Identity();
      X.translation().x() = way_m;
      tick.X_WT_cmd = X;
    };
  };
  return {
      {Fault::kArmStale, "Age of the arm", "limit 25 ms",
       [](TickRecord& t) { t.input.arm_stamp -= 7 * rt::kMillisecond; }},
      {Fault::kModelStale, "Age of the contact model", "limit 250 ms",
       [](TickRecord& t) { t.model_age_s = 0.2; }},
      {Fault::kSensorStale, "Age of the force sensor", "limit 100 ms",
       [](TickRecord& t) { t.sensor_age_s = 0.08; }},
      {Fault::kInterlock, "Age of the PLC", "limit 100 ms",
       [](TickRecord& t) { t.input.interlock_stamp -= 60 * rt::kMillisecond; }},
      {Fault::kInterlock, "What the PLC says", "needed", [](TickRecord& t) { t.input.permitted = true; }},
      {Fault::kSpindle, "Age of the drive", "limit 100 ms",
       [](TickRecord& t) { t.input.spindle_stamp -= 60 * rt::kMillisecond; }},
      {Fault::kSpindle, "The drive&#39;s status", "needed",
       [](TickRecord& t) { t.input.spindle_ready = true; }},
      {Fault::kSpindleLimit, "Torque of the spindle", "limit 9 N·m",
       [](TickRecord& t) { t.input.spindle_torque_Nm = 8.0; }},
      {Fault::kToolSpeed, "Speed of the commanded apex", "trip 275 mm/s", moved(1e-4)},
      {Fault::kArmSpeed, "Speed of the measured apex", "limit 375 mm/s",
       [](TickRecord& t) { t.tool_speed_meas_m_per_s = 0.3; }},
      {Fault::kJointLimit, "Joint positions", "limit -100 %", [](TickRecord& t) { t.q_cmd[3] = 1.9; }},
      {Fault::kJointLimit, "Joint speeds", "limit 100 %", [](TickRecord& t) { t.q_cmd[3] = 1e-3; }},
      {Fault::kInverseKinematics, "Joint positions", "limit 100 %", [](TickRecord& t) { t.q_cmd[3] = 1.9; }},
      {Fault::kWorkspace, "Distance to the nearest bound", "limit 0 mm",
       [](TickRecord& t) {
         Pose X = Pose::Identity();
         X.translation().z() = -0.2;  // towards the plane
         t.X_WT_cmd = X;
       }},
      {Fault::kSensorForce, "Force of the hand", "limit 250 N",
       [](TickRecord& t) { t.F_operator_T_W.f = Vector3(100.0, 0.0, 0.0); }},
      {Fault::kWrenchRate, "in a tick", "limit (1.5 K v_max)", [](TickRecord& t) { t.wrench_step_N = 12.0; }},
      {Fault::kToolInBone, "beyond its collision-free pose", "limit 4 mm",
       [](TickRecord& t) { t.tool_in_bone_m = 0.003; }},
      {Fault::kForceLimit, "stayed at its force limit", "limit 50 ms",
       [](TickRecord& t) { t.wrench_scale = 0.9; }},
      {Fault::kDeflection, "Lateral bend of the tool", "limit 6.5 mm",
       [](TickRecord& t) { t.compliance.bend_m = Vector3(4e-3, 0.0, 0.0); }},
      {Fault::kDeflection, "Shift of the bone on its mount", "limit 10 mm",
       [](TickRecord& t) { t.compliance.mount_m = Vector3(0.0, 4e-3, 0.0); }},
      {Fault::kTracking, "From the commanded to the measured apex", "limit 30 mm", moved(0.01)},
      {Fault::kPeriod, "Period of the arm", "the cell&#39;s 1 ms",
       [](TickRecord& t) { t.input.period_s = 0.002; }},
      {Fault::kSession, "State of the arm", "needed", [](TickRecord& t) { t.session_state = 2; }},
      {Fault::kSensorFault, "trusts its reading", "needed",
       [](TickRecord& t) { t.input.sensor_trusted = false; }},
      {Fault::kCommandMode, "Command mode", "needed: 1", [](TickRecord& t) { t.input.command_mode = 2; }},
  };
}

// The test changes the quantity in some ticks. If the quantity is drawn, the drawing changes as well.
TEST(TripCharts, ShowTheQuantityOfEachFaultWithItsLimit) {
  const TripLimits limits = Limits();
  for (const Case& c : Cases()) {
    SCOPED_TRACE(std::string(safety::Describe(c.fault).name) + ": " + c.quantity);
    std::vector<TickRecord> ticks = Ticks();
    const report::TimeAxis time{
        .zero = ticks[1000].stamp, .label = "time since the stop began [s]", .mark = "stop"};
    const std::string before = TripChart(c.fault, ticks, limits, time);
    for (std::size_t i = 500; i < 1000; ++i) c.change(ticks[i]);
    const std::string chart = TripChart(c.fault, ticks, limits, time);
    EXPECT_NE(chart, before) << "the quantity is drawn";
    EXPECT_EQ(report::MarkupError(chart), "");
    EXPECT_EQ(report::TextOutside(chart), "");
    std::string plain = chart;
    for (std::size_t at = 0; (at = plain.find("'", at)) != std::string::npos;) plain.replace(at, 1, "&#39;");
    for (const std::string& part : {std::string(c.quantity), std::string(c.limit), std::string("−"),
                                    std::string("time since the stop began [s]"), std::string(">stop<")})
      EXPECT_NE(plain.find(part), std::string::npos) << part;
  }
}

TEST(TripCharts, AreEmptyForFaultsWithoutARecordedQuantity) {
  const std::vector<TickRecord> ticks = Ticks();
  for (const Fault fault : {Fault::kDevice, Fault::kNotFinite, Fault::kRepeatDiffers, Fault::kRecorder})
    EXPECT_EQ(TripChart(fault, ticks, Limits(), {.zero = ticks[1000].stamp}), "")
        << safety::Describe(fault).name;
  int drawn = 0;
  for (int bit = 0; bit < safety::kFaultCount; ++bit)
    drawn += TripChart(static_cast<Fault>(1u << bit), ticks, Limits(), {.zero = ticks[1000].stamp}).empty()
                 ? 0
                 : 1;
  EXPECT_EQ(drawn, safety::kFaultCount - 4) << "a new fault is drawn, or is named here";
}

}  // namespace
}  // namespace osteon::session
