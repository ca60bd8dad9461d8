// The text of what was measured when a fault occurred.

#include "session/summary/fault_seen.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "io/can/reamer_drive.h"
#include "io/modbus/plc_reading.h"

namespace osteon::session {
namespace {

using control::TickRecord;
using safety::Fault;

// An empty tick at this time.
TickRecord At(rt::Nanoseconds now) {
  TickRecord tick;
  tick.input.now = now;
  return tick;
}

TEST(FaultSeen, DistinguishesAPlcThatWithdrewItsPermitFromASilentOne) {
  TickRecord tick = At(rt::kSecond);
  tick.input.interlock_stamp = rt::kSecond - 8 * rt::kMillisecond;
  tick.input.interlock_reason = static_cast<std::uint8_t>(io::PlcVerdict::kNotPermitted);
  EXPECT_EQ(SeenAt(Fault::kInterlock, tick), "RUN_PERMITTED (974) is 0; the PLC's word: 8 ms old");
  tick.input.interlock_stamp = rt::kSecond - 104 * rt::kMillisecond;
  tick.input.interlock_reason = static_cast<std::uint8_t>(io::PlcVerdict::kStale);
  EXPECT_EQ(SeenAt(Fault::kInterlock, tick), "the PLC's registers are too old; the PLC's word: 104 ms old");
  tick.input.permitted = tick.input.enabled = true;  // read before the silence
  EXPECT_EQ(SeenAt(Fault::kInterlock, tick), "permitted; the PLC's word: 104 ms old");
  tick.input.interlock_stamp = 0;
  EXPECT_EQ(SeenAt(Fault::kInterlock, tick), "permitted; the PLC's word: none yet");
  tick.input.enabled = false;
  tick.input.interlock_stamp = rt::kSecond - 8 * rt::kMillisecond;
  EXPECT_EQ(SeenAt(Fault::kInterlock, tick), "ENABLING_SWITCH (979) is not held; the PLC's word: 8 ms old");
}

TEST(FaultSeen, HasTheMeasuredValueOfEachOtherFault) {
  TickRecord tick = At(rt::kSecond);
  tick.model_age_s = 0.251;
  EXPECT_EQ(SeenAt(Fault::kModelStale, tick), "the model is 251 ms old");
  tick.sensor_age_s = 1e6;
  EXPECT_EQ(SeenAt(Fault::kSensorStale, tick), "the reading is not there yet");
  tick.F_operator_T_W.f = Vector3(0, 120, 160);
  EXPECT_EQ(SeenAt(Fault::kSensorForce, tick), "200 N");
  tick.v_WT_cmd_m_per_s = Vector3(0.3, 0, 0);
  EXPECT_EQ(SeenAt(Fault::kToolSpeed, tick), "300 mm/s");
  Pose X_WT = Pose::Identity();
  X_WT.translation() = Vector3(0.62, 0, 0.2584);
  tick.X_WT_cmd = X_WT;
  EXPECT_EQ(SeenAt(Fault::kWorkspace, tick), "the apex at (620.0, 0.0, 258.4) mm in W");
  X_WT.translation().z() += 0.0125;
  tick.X_WT_meas = X_WT;
  EXPECT_EQ(SeenAt(Fault::kTracking, tick), "12.5 mm");
  EXPECT_EQ(SeenAt(Fault::kWrenchRate, tick), "") << "recorded before the step was";
  tick.input.period_s = 0.001;
  tick.wrench_step_N = 17.42;
  tick.wrench_step_limit_N = 13.5;
  EXPECT_EQ(SeenAt(Fault::kWrenchRate, tick), "17.4 N in 1 ms, accepted 13.5 N");
  tick.session_state = 2;
  EXPECT_EQ(SeenAt(Fault::kSession, tick), "session state 2 (MONITORING_READY)");
  tick.input.safety_state = 2;
  EXPECT_EQ(SeenAt(Fault::kSession, tick), "safety stop 1");
  tick.input.spindle_stamp = rt::kSecond - 5 * rt::kMillisecond;
  tick.input.spindle_fault = true;
  EXPECT_EQ(SeenAt(Fault::kSpindle, tick), "a fault; its status: 5 ms old");
  tick.tool_speed_meas_m_per_s = 0.523;
  EXPECT_EQ(SeenAt(Fault::kArmSpeed, tick), "523 mm/s in the last message");
  EXPECT_EQ(SeenAt(Fault::kDevice, tick), "");
}

TEST(FaultSeen, NamesTheDrivesFaultsWithTheirCodes) {
  TickRecord tick = At(rt::kSecond);
  tick.input.spindle_stamp = rt::kSecond - 5 * rt::kMillisecond;
  tick.input.spindle_fault = tick.input.spindle_ready = true;
  tick.input.drive_faults = io::kDriveEmergency | io::kDriveInFault;
  tick.input.drive_emergency_code = 0x4310;
  tick.input.drive_error_code = 0x7121;
  EXPECT_EQ(
      SeenAt(Fault::kSpindle, tick),
      "a fault: EMCY 0x4310 (excess temperature of the drive) (bit 2); in fault by its statusword (bit 3); "
      "603F 0x7121 (motor blocked); its status: 5 ms old");
  tick.input.drive_emergency_code = tick.input.drive_error_code = 0;
  tick.input.drive_faults = io::kDriveRestarted;
  EXPECT_EQ(
      SeenAt(Fault::kSpindle, tick),
      "a fault: boot-up message (NMT state 0x00): its configuration is gone (bit 4); its status: 5 ms old");
  tick.input.drive_faults = io::kDriveHeartbeatLost;
  EXPECT_EQ(SeenAt(Fault::kSpindle, tick),
            "a fault: heartbeat lost: none came in time (bit 0); its status: 5 ms old");
}

TEST(FaultSeen, NamesTheAcceptedValueIfTheCellIsKnown) {
  control::ServoParams servo;
  servo.period_s = 0.004;
  TickRecord tick = At(rt::kSecond);
  tick.sensor_age_s = 0.101;
  EXPECT_EQ(SeenAt(Fault::kSensorStale, tick, &servo), "the reading is 101 ms old, accepted 100 ms");
  tick.input.period_s = 0.040;
  EXPECT_EQ(SeenAt(Fault::kPeriod, tick, &servo), "40 ms, accepted 4 ms");
  tick.input.arm_stamp = rt::kSecond - 25 * rt::kMillisecond;
  EXPECT_EQ(SeenAt(Fault::kArmStale, tick, &servo), "the last is 25 ms old; 5 deadlines in a row");
  tick.input.rejected = 7;
  EXPECT_EQ(
      SeenAt(Fault::kArmStale, tick, &servo),
      "the last is 25 ms old; 5 deadlines in a row; 7 messages of this run were refused (damaged, a value "
      "that is not finite, another sender or version)");
  servo.on_force_limit.max_tool_in_bone_m = 0.004;
  tick.tool_in_bone_m = 0.0042;
  EXPECT_EQ(SeenAt(Fault::kToolInBone, tick, &servo), "4.2 mm, accepted 4 mm");
}

TEST(FaultSeen, NamesTheValueThatIsNotFinite) {
  TickRecord tick = At(rt::kSecond);
  tick.q_meas[2] = std::nan("");
  EXPECT_EQ(SeenAt(Fault::kNotFinite, tick), "the arm's joint A3 measured nan");
  tick.q_meas[2] = 0.0;
  tick.input.tau_ext[6] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(SeenAt(Fault::kNotFinite, tick), "the arm's joint A7 external torque inf");
  tick.input.tau_ext[6] = 0.0;
  tick.input.F_sensor_S.t.y = std::nan("");
  EXPECT_EQ(SeenAt(Fault::kNotFinite, tick), "the force sensor's Ty nan");
  tick.input.F_sensor_S.t.y = 0.0;
  tick.model_frame = 17;
  EXPECT_EQ(SeenAt(Fault::kNotFinite, tick), "arm and sensor were finite: the contact model of frame 17");
}

}  // namespace
}  // namespace osteon::session
