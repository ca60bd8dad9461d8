#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "hil/can/drive_device.h"
#include "tests/io/can/can_frames.h"

// Tests the simulated spindle drive alone: its CAN frames and states against CiA 301 and CiA 402. The tests
// with the drive's client are in can_drive_client_test.cpp.

namespace osteon::hil {
namespace {

using io::test::At;
using io::test::Frames;
using io::test::kMs;
using io::test::Sent;

// The simulated drive on a bus. Frames are in candump's notation: 610#4041600000000000 is an SDO request to
// node 16 (0x10) to read (40) the object 6041, sub-index 00. Its answer is 590#…
struct Bench {
  Bench() {
    Sent(device, 0);
    EXPECT_EQ(Sent(device, now), Frames{"710#00"}) << "boot-up";
  }
  /// @returns the answers to a frame
  Frames Exchange(const std::string& frame) {
    device.Accept(At(now, frame));
    return Sent(device, now);
  }
  /// The statusword, read by SDO: first its low byte, then its high byte, in hexadecimal.
  std::string State() {
    const Frames answer = Exchange("610#4041600000000000");
    return answer.empty() ? "" : answer.front().substr(12, 4);
  }
  rt::Nanoseconds now{100 * kMs};
  DriveDevice device{{}};
};

TEST(DriveDevice, AnswersSdosAsCia301Specifies) {
  Bench bench;
  EXPECT_EQ(bench.Exchange("610#4000100000000000"), Frames{"590#4300100092010200"});
  EXPECT_EQ(bench.Exchange("610#4076600000000000"), Frames{"590#43766000F4010000"}) << "0.5 N·m in mN·m";
  EXPECT_EQ(bench.Exchange("610#4061600000000000"), Frames{"590#4F61600003000000"});
  EXPECT_EQ(bench.Exchange("610#2F60600009000000"), Frames{"590#6060600000000000"});
  EXPECT_EQ(bench.Exchange("610#4060600000000000"), Frames{"590#4F60600009000000"});
  EXPECT_EQ(bench.Exchange("610#4099990000000000"), Frames{"590#8099990000000206"}) << "no such object";
  EXPECT_EQ(bench.Exchange("610#4076600500000000"), Frames{"590#8076600511000906"}) << "no such sub-index";
  EXPECT_EQ(bench.Exchange("610#2376600001000000"), Frames{"590#8076600002000106"}) << "read only";
  EXPECT_EQ(bench.Exchange("610#2B60600003000000"), Frames{"590#8060600010000706"}) << "two bytes for one";
  EXPECT_EQ(bench.Exchange("610#2F60600007000000"), Frames{"590#8060600030000906"}) << "no such mode";
  EXPECT_EQ(bench.Exchange("610#2176600000000000"), Frames{"590#8076600001000405"}) << "segmented";
  EXPECT_EQ(bench.Exchange("610#40"), Frames{}) << "an SDO has 8 bytes";
  EXPECT_EQ(bench.Exchange("611#4000100000000000"), Frames{}) << "another node's";
}

// CiA 301 requires the objects 1000, 1001 and 1018 in every device. CANopen masters read them.
TEST(DriveDevice, HasTheObjectsThatEveryDeviceHas) {
  Bench bench;
  EXPECT_EQ(bench.Exchange("610#4001100000000000"), Frames{"590#4F01100000000000"}) << "no error";
  EXPECT_EQ(bench.Exchange("610#4018100000000000"), Frames{"590#4F18100004000000"})
      << "four entries of identity";
  EXPECT_EQ(bench.Exchange("610#4018100100000000"), Frames{"590#4318100100000000"}) << "no registered vendor";
  EXPECT_EQ(bench.Exchange("610#4018100200000000"), Frames{"590#431810024454534F"}) << "OSTD";
  EXPECT_EQ(bench.Exchange("610#4018100300000000"), Frames{"590#4318100300000100"});
  EXPECT_EQ(bench.Exchange("610#4018100400000000"), Frames{"590#4318100410000000"}) << "its node";
  EXPECT_EQ(bench.Exchange("610#4018100500000000"), Frames{"590#8018100511000906"}) << "no such sub-index";
  EXPECT_EQ(bench.Exchange("610#2F01100000000000"), Frames{"590#8001100002000106"}) << "read only";
  bench.device.InjectFault(0x4310);
  static_cast<void>(Sent(bench.device, bench.now));  // removes the emergency message (EMCY)
  EXPECT_EQ(bench.Exchange("610#4001100000000000"), Frames{"590#4F01100001000000"}) << "the generic error";
}

TEST(DriveDevice, ChangesAPdosMappingOnlyWhileThePdoIsOff) {
  Bench bench;
  EXPECT_EQ(bench.Exchange("610#2F00160000000000"), Frames{"590#8000160022000008"}) << "it is on";
  EXPECT_EQ(bench.Exchange("610#2300140110020080"), Frames{"590#6000140100000000"});
  EXPECT_EQ(bench.Exchange("610#2300160110004060"), Frames{"590#8000160122000008"}) << "its count is not 0";
  EXPECT_EQ(bench.Exchange("610#2F00160000000000"), Frames{"590#6000160000000000"});
  EXPECT_EQ(bench.Exchange("610#2300160110004160"), Frames{"590#8000160141000406"})
      << "a status cannot be commanded";
  EXPECT_EQ(bench.Exchange("610#230016012000FF60"), Frames{"590#6000160100000000"});
  EXPECT_EQ(bench.Exchange("610#230016022000FF60"), Frames{"590#6000160200000000"});
  EXPECT_EQ(bench.Exchange("610#2300160310004060"), Frames{"590#6000160300000000"});
  EXPECT_EQ(bench.Exchange("610#2F00160003000000"), Frames{"590#8000160042000406"}) << "80 bits";
  EXPECT_EQ(bench.Exchange("000#0110"), Frames{});
  EXPECT_EQ(bench.Exchange("610#2F00160000000000"), Frames{"590#8000160022000008"}) << "operational";
}

// Sends each controlword in each state, by SDO. The drive must go to the state that the state machine of CiA
// 402 defines.
TEST(DriveDevice, EveryCommandInEveryStateLeadsToTheStateOfCia402) {
  // controlwords that lead from the state disabled to the states of the rows
  const std::string path[]{"610#2B40600006000000", "610#2B40600007000000", "610#2B4060000F000000",
                           "610#2B40600002000000"};
  struct Row {
    const char* name;
    int steps;             // number of controlwords of `path` that lead to this state
    const char* after[6];  // statusword after each of the controlwords 00, 06, 07, 0F, 02, 80
  };
  // Statuswords as in the frame: low byte, then high byte.
  const char *disabled = "5002", *ready = "3102", *on = "3302", *enabled = "3702", *stop = "1702";
  const Row rows[]{
      {"disabled", 0, {disabled, ready, disabled, disabled, disabled, disabled}},
      {"ready", 1, {disabled, ready, on, on, disabled, disabled}},
      {"switched on", 2, {disabled, ready, on, enabled, disabled, disabled}},
      {"enabled", 3, {disabled, ready, on, enabled, stop, disabled}},
      // the initial quick stop option is 2: only the end of the stop or a command to switch off leaves the
      // state
      {"quick stop", 4, {disabled, stop, stop, stop, stop, disabled}},
  };
  const char* commands[]{"00", "06", "07", "0F", "02", "80"};
  for (const Row& row : rows) {
    for (int c = 0; c < 6; ++c) {
      SCOPED_TRACE(std::string(row.name) + " " + commands[c]);
      Bench bench;
      for (int i = 0; i < row.steps; ++i) bench.Exchange(path[i]);
      bench.Exchange(std::string("610#2B406000") + commands[c] + "000000");
      EXPECT_EQ(bench.State(), row.after[c]);
    }
  }
}

// The simulated drive without friction. Its motor turns at 1000 rpm.
struct TurningBench : Bench {
  TurningBench() {
    for (const char* frame : {"610#2B40600006000000", "610#2B40600007000000", "610#2B4060000F000000",
                              "610#23FF6000E8030000"})  // target velocity (object 60FF): 1000 rpm
      Exchange(frame);
    Run(500);
  }
  void Run(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) static_cast<void>(Sent(device, now += kMs));
  }
  [[nodiscard]] double rpm() const { return device.motor().speed_rad_per_s() * 60 / (2 * std::numbers::pi); }
};

// CiA 402-2: the quick stop option code (605A) determines how the drive stops, and which state follows the
// stop.
TEST(DriveDevice, AQuickStopFollowsItsOptionCode) {
  struct Row {
    int option;
    const char *during, *after;  // statusword (low byte, high byte) after 20 ms and after 1 s
    double ramp_rpm_per_s;       // 0: the motor coasts
  };
  const Row rows[]{
      {0, "5002", "5002", 0},
      {1, "1702", "5002", 2000},
      {2, "1702", "5002", 20000},
      {5, "1702", "1706", 2000},  // with options 5 and 6 the drive stays in quick stop; bit 10 then reports
                                  // that the stop is finished
      {6, "1702", "1706", 20000},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.option);
    TurningBench bench;
    bench.Exchange("610#23846000D0070000");  // 6084: 2000 rpm/s
    bench.Exchange("610#23856000204E0000");  // 6085: 20000 rpm/s
    EXPECT_EQ(bench.Exchange("610#2B5A60000" + std::to_string(row.option) + "000000"),
              Frames{"590#605A600000000000"});
    bench.Exchange("610#2B40600002000000");
    bench.Run(20);
    EXPECT_EQ(bench.State(), row.during);
    // the velocity loop (20 Hz, angular frequency w) lags behind the ramp by up to 2/w = 16 ms
    EXPECT_NEAR(bench.rpm(), 1000 - 0.020 * row.ramp_rpm_per_s, 0.016 * row.ramp_rpm_per_s + 0.1);
    bench.Run(1000);
    EXPECT_EQ(bench.State(), row.after);
    EXPECT_NEAR(bench.rpm(), row.ramp_rpm_per_s == 0 ? 1000 : 0, 1.0);
    // with options 5 and 6 the drive stays in quick stop. Then the command "enable operation" makes the motor
    // turn again
    bench.Exchange("610#2B4060000F000000");
    EXPECT_EQ(bench.State().substr(0, 2), row.option >= 5 ? "37" : "50");
  }
}

TEST(DriveDevice, RefusesUnknownOptionCodes) {
  Bench bench;
  for (const char* value : {"03", "04", "07", "08", "FF"})
    EXPECT_EQ(bench.Exchange("610#2B5A6000" + std::string(value) + "000000"), Frames{"590#805A600030000906"});
  for (const char* value : {"03", "05"})
    EXPECT_EQ(bench.Exchange("610#2B5E6000" + std::string(value) + "000000"), Frames{"590#805E600030000906"});
  EXPECT_EQ(bench.Exchange("610#405A600000000000"), Frames{"590#4B5A600002000000"}) << "as before";
}

// The fault reaction option code (605E) determines how the motor stops after a fault. With 0 it coasts; with
// 1 and 2 it brakes along the ramps 6084 and 6085.
TEST(DriveDevice, AFaultStopsTheMotorByItsOptionCode) {
  for (const int option : {0, 1, 2}) {
    SCOPED_TRACE(option);
    TurningBench bench;
    bench.Exchange("610#23846000D0070000");  // ramp 6084: 2000 rpm/s
    bench.Exchange("610#23856000204E0000");  // ramp 6085: 20000 rpm/s
    bench.Exchange("610#2B5E60000" + std::to_string(option) + "000000");
    bench.device.InjectFault(0x4310);
    bench.Run(200);
    EXPECT_EQ(bench.device.statusword() & 0x4F, option == 1 ? 0x0F : 0x08);
    bench.Run(800);
    EXPECT_EQ(bench.device.statusword() & 0x4F, 0x08);
    EXPECT_NEAR(bench.rpm(), option == 0 ? 1000 : 0, 1.0);
  }
}

// In profile velocity mode, the statusword's bit 10 (target reached) is set once the velocity has been within
// the window (606D) for the window's time (606E).
TEST(DriveDevice, TargetReachedNeedsTheVelocityInItsWindowForItsTime) {
  TurningBench bench;
  EXPECT_EQ(bench.State(), "3706") << "in the window";
  bench.Exchange("610#2B6D600014000000");  // window 606D: 20 rpm
  bench.Exchange("610#2B6E600064000000");  // window's time 606E: 100 ms
  bench.Exchange("610#23FF6000D0070000");  // target velocity 60FF: 2000 rpm
  EXPECT_EQ(bench.State(), "3702") << "a new target is not reached";
  int inside_ms =
      0;  // counts the time within the window; the velocity overshoots, so it enters, leaves and enters again
  for (int i = 0; i < 1000; ++i) {
    bench.Run(1);
    inside_ms = std::abs(bench.rpm() - 2000) <= 20 ? inside_ms + 1 : 0;
    if (inside_ms >= 99 && inside_ms <= 101) continue;
    EXPECT_EQ(bench.State(), inside_ms > 101 ? "3706" : "3702") << "in the window for " << inside_ms << " ms";
  }
  EXPECT_GT(inside_ms, 101);
  bench.Exchange("610#23FF6000DA070000");  // target velocity: 2010 rpm
  EXPECT_EQ(bench.State(), "3706") << "still in the window";
  bench.device.SetCuttingTorque(28.0);  // 1.4 N·m at the motor, near its limit of 1.5 N·m: the speed falls
  bench.Run(10);
  EXPECT_EQ(bench.State(), "3702") << "braked by the cut";
  bench.Run(500);
  EXPECT_EQ(bench.State(), "3706") << "and caught up";
  bench.Exchange("610#2F60600009000000");
  EXPECT_EQ(bench.State(), "3702") << "cyclic velocity mode has no target reached";
  bench.Exchange("610#2F60600003000000");
  bench.Exchange("610#2B40600007000000");
  EXPECT_EQ(bench.State(), "3302") << "nor has switched on";
}

TEST(DriveDevice, AFaultIsResetOnlyByARisingEdge) {
  Bench bench;
  bench.Exchange("610#2B40600080000000");
  bench.device.InjectFault(0x4310);
  EXPECT_EQ(Sent(bench.device, bench.now), Frames{"090#1043010000000000"});
  EXPECT_EQ(bench.State(), "1802");
  for (const char* command : {"00", "06", "07", "0F"})
    bench.Exchange(std::string("610#2B406000") + command + "000000");
  EXPECT_EQ(bench.State(), "1802") << "nothing but a reset leads out";
  bench.Exchange("610#2B40600080000000");
  EXPECT_EQ(bench.State(), "1802") << "still broken";
  bench.device.ClearFault();
  bench.Exchange("610#2B40600080000000");
  EXPECT_EQ(bench.State(), "1802") << "no edge";
  bench.Exchange("610#2B40600000000000");
  EXPECT_EQ(bench.Exchange("610#2B40600080000000"), (Frames{"590#6040600000000000", "090#0000000000000000"}));
  EXPECT_EQ(bench.State(), "5002");
}

}  // namespace
}  // namespace osteon::hil
