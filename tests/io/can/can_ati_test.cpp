#include "io/can/ati_sensor.h"

#include <gtest/gtest.h>

#include "io/can/id_claims.h"
#include "tests/io/can/can_frames.h"

// Tests the client of an ATI force sensor, with frames from public descriptions of the sensor's NETCANOEM
// interface.

namespace osteon::io {
namespace {

using test::At;
using test::Frames;
using test::kFrameTime;
using test::kMs;
using test::Sent;

AtiSensor Sensor(const AtiParams& params = {}) { return test::Made<AtiSensor>(params); }

// The three frames of one row of the sensor's calibration matrix, as float32. The matrix has 1.0 (3F800000)
// on the diagonal. Row 0 also has 2.0 (40000000) in column 1 and 0.5 (3F000000) in column 5.
Frames MatrixRow(int row) {
  std::string parts[3];
  for (int column = 0; column < 6; ++column) {
    const char* value = row == column             ? "3F800000"
                        : row == 0 && column == 1 ? "40000000"
                        : row == 0 && column == 5 ? "3F000000"
                                                  : "00000000";
    parts[column / 2] += value;
  }
  return {"202#" + parts[0], "203#" + parts[1], "204#" + parts[2]};
}

// Answers the requests of the set-up: six rows of the matrix, the counts per newton and per newton metre
// (default 100 and 10), and the codes of the units (default N and N·m). Stops if the sensor's client reports
// a failure.
void AnswerSetUp(AtiSensor& sensor, rt::Nanoseconds now, const std::string& counts = "207#000000640000000A",
                 const std::string& units = "208#0203") {
  for (int row = 0; row < 6; ++row) {
    EXPECT_EQ(Sent(sensor, now), Frames{"202#0" + std::to_string(row)});
    for (const std::string& frame : MatrixRow(row)) sensor.Accept(At(now, frame));
  }
  EXPECT_EQ(Sent(sensor, now), Frames{"207#"});
  sensor.Accept(At(now, counts));
  if (sensor.phase() == SensorPhase::kFailed) return;
  EXPECT_EQ(Sent(sensor, now), Frames{"208#"});
  sensor.Accept(At(now, units));
}

TEST(AtiSensor, ReadsItsMatrixCountsAndUnitsThenAsksEachPeriod) {
  auto sensor = Sensor();
  AnswerSetUp(sensor, 0);
  ASSERT_EQ(sensor.phase(), SensorPhase::kReady) << sensor.failure();
  EXPECT_EQ(sensor.matrix()[0], 1.0);
  EXPECT_EQ(sensor.matrix()[1], 2.0);
  EXPECT_EQ(sensor.matrix()[5], 0.5);
  EXPECT_EQ(sensor.matrix()[7], 1.0);
  EXPECT_EQ(Sent(sensor, 10 * kMs), Frames{"200#"});
  EXPECT_EQ(Sent(sensor, 10 * kMs + 900'000), Frames{});
  EXPECT_EQ(Sent(sensor, 11 * kMs), Frames{"200#"});
}

TEST(AtiSensor, GaugesBecomeAWrenchThroughTheMatrix) {
  auto sensor = Sensor();
  AnswerSetUp(sensor, 0);
  // readings of the gauges 0 … 5: 100, -200, 300, 10, 32766, -20; the scale is 100 counts per N and 10 counts
  // per N·m
  sensor.Accept(At(kMs, "200#00000064012C7FFE"));
  sensor.Accept(At(kMs + kFrameTime, "201#FF38000AFFEC"));
  const SensorReading& reading = sensor.Latest();
  EXPECT_EQ(reading.stamp, kMs);
  EXPECT_DOUBLE_EQ(reading.F_S.f.x, (100 - 2 * 200 - 0.5 * 20) / 100);
  EXPECT_DOUBLE_EQ(reading.F_S.f.y, -2.0);
  EXPECT_DOUBLE_EQ(reading.F_S.f.z, 3.0);
  EXPECT_DOUBLE_EQ(reading.F_S.t.x, 1.0);
  EXPECT_DOUBLE_EQ(reading.F_S.t.y, 3276.6);
  EXPECT_DOUBLE_EQ(reading.F_S.t.z, -2.0);
  EXPECT_EQ(reading.flags, 0u);
}

TEST(AtiSensor, PoundsAreConvertedToNewtons) {
  auto sensor = Sensor();
  AnswerSetUp(sensor, 0, "207#0000000100000001", "208#0102");  // units pound and pound-foot
  sensor.Accept(At(kMs, "200#0000000000010000"));
  sensor.Accept(At(kMs, "201#000000010000"));
  EXPECT_NEAR(sensor.Latest().F_S.f.z, 4.4482216152605, 1e-12);
  EXPECT_NEAR(sensor.Latest().F_S.t.x, 1.3558179483314, 1e-12);
}

TEST(AtiSensor, StatusBitsBecomeFlags) {
  auto sensor = Sensor();
  AnswerSetUp(sensor, 0);
  rt::Nanoseconds now = kMs;
  const auto flags = [&](const std::string& status, const std::string& gauges = "000000000000") {
    sensor.Accept(At(now += kMs, "200#" + status + gauges));
    sensor.Accept(At(now, "201#000000000000"));
    EXPECT_EQ(sensor.Latest().stamp, now);
    return sensor.Latest().flags;
  };
  EXPECT_EQ(flags("0000"), 0u);
  EXPECT_EQ(flags("C000"), kSensorBusError);
  EXPECT_EQ(sensor.Latest().status, 0xC000);
  for (const char* fault : {"8002", "8004", "8008", "8010", "8020", "8040", "8080", "8100", "8800", "9000"})
    EXPECT_EQ(flags(fault), kSensorFault) << fault;
  EXPECT_EQ(flags("8001"), kSensorWarning) << "watchdog reset";
  EXPECT_EQ(flags("0000", "7FFF00000000"), kSensorOverload);
  EXPECT_EQ(flags("C080", "800000000000"), kSensorOverload | kSensorFault | kSensorBusError);
}

// A reading consists of two frames, 0x200 and 0x201. If a frame is lost, or if the two frames are more than a
// frame's time apart, they must give no reading.
TEST(AtiSensor, HalvesOfDifferentReadingsAreNeverJoined) {
  auto sensor = Sensor();
  AnswerSetUp(sensor, 0);
  sensor.Accept(At(10 * kMs, "200#0000000000000000"));
  sensor.Accept(At(11 * kMs + kFrameTime, "201#000000000000"));
  sensor.Accept(At(12 * kMs, "201#000000000000"));
  EXPECT_EQ(sensor.counters().readings, 0u);
  EXPECT_EQ(sensor.counters().halves, 3u);
  sensor.Accept(At(13 * kMs, "200#"));  // a request by another master on the bus
  sensor.Accept(At(13 * kMs, "201#0000000000000000"));
  EXPECT_EQ(sensor.counters().malformed, 2u);
  EXPECT_EQ(sensor.counters().readings, 0u);
}

TEST(AtiSensor, AnIncompleteMatrixRowIsRequestedAgain) {
  auto sensor = Sensor();
  Sent(sensor, 0);
  sensor.Accept(At(0, MatrixRow(0)[0]));
  sensor.Accept(At(0, MatrixRow(0)[2]));  // the middle one of the three frames is lost
  EXPECT_EQ(Sent(sensor, 49 * kMs), Frames{});
  EXPECT_EQ(Sent(sensor, 50 * kMs), Frames{"202#00"});
  sensor.Accept(At(50 * kMs, MatrixRow(0)[1]));  // this frame belongs to no row
  for (const std::string& frame : MatrixRow(0)) sensor.Accept(At(50 * kMs, frame));
  EXPECT_EQ(Sent(sensor, 50 * kMs), Frames{"202#01"});
}

TEST(AtiSensor, BiasIsTheMeanLoadOfTheNextReadings) {
  auto sensor = Sensor({.bias_readings = 4});
  AnswerSetUp(sensor, 0);
  rt::Nanoseconds now = kMs;
  // sends a reading in which gauge 2 has these counts; returns the force along z (100 counts per newton)
  const auto read = [&](const std::string& gauge2) {
    sensor.Accept(At(now += kMs, "200#00000000" + gauge2 + "0000"));
    sensor.Accept(At(now, "201#000000000000"));
    return sensor.Latest().F_S.f.z;
  };
  EXPECT_DOUBLE_EQ(read("0064"), 1.0);
  sensor.RequestBias(true);
  for (const char* gauge : {"0064", "00C8", "0064", "00C8"}) read(gauge);
  EXPECT_DOUBLE_EQ(read("00C8"), 0.5);
  sensor.RequestBias(true);
  for (int i = 0; i < 4; ++i) read("00C8");
  EXPECT_DOUBLE_EQ(read("00C8"), 0.0) << "of the load itself, not of what was left";
  sensor.RequestBias(false);
  EXPECT_DOUBLE_EQ(read("00C8"), 2.0);
}

TEST(AtiSensor, RefusalsNameTheReason) {
  // the client's failure after these answers about counts and units
  const auto failure = [](const std::string& counts, const std::string& units) {
    auto sensor = Sensor();
    AnswerSetUp(sensor, 0, counts, units);
    EXPECT_EQ(sensor.phase(), SensorPhase::kFailed);
    return sensor.failure();
  };
  EXPECT_NE(failure("207#FFFFFFFF00000000", "208#0203").find("counts a unit are 4294967295 and 0"),
            std::string::npos)
      << "found by fuzzing: such a count is no int";
  EXPECT_NE(failure("207#000000000000000A", "208#0203").find("counts a unit are 0 and 10"),
            std::string::npos);
  EXPECT_NE(failure("207#000000640000000A", "208#0003").find("unit codes are 0 (force) and 3"),
            std::string::npos);
  EXPECT_NE(failure("207#000000640000000A", "208#0207").find("unit codes are 2 (force) and 7"),
            std::string::npos);
  auto sensor = Sensor();
  Sent(sensor, 0);
  sensor.Accept(At(0, "202#3F8000007FC00000"));
  EXPECT_NE(sensor.failure().find("matrix is not finite in row 0, column 1"), std::string::npos)
      << sensor.failure();
  auto silent = Sensor();
  for (int i = 0; i < 4; ++i) Sent(silent, i * 50 * kMs);
  EXPECT_NE(
      silent.failure().find("(base 0x20, ids 0x200 … 0x20F): no answer about its matrix row 0 in 3 attempts"),
      std::string::npos)
      << silent.failure();
}

TEST(AtiSensor, ErrorsNameTheParameter) {
  EXPECT_NE(AtiSensor::Make({.base = 0x80}).error().find("base: found 0x80, accepted 0 … 0x7F"),
            std::string::npos);
  EXPECT_NE(AtiSensor::Make({.period = 1000}).error().find("period: found 1000 ns"), std::string::npos);
}

// The sensor's default ids 0x200 … 0x20F include the id of a drive's RPDO1, which is 0x200 + node, if the
// node's number is below 16.
TEST(CanIds, TheAtiSensorOverlapsWithDrivesBelowNode16) {
  for (int node = 1; node <= 127; ++node) {
    ReamerDriveParams drive{.node = static_cast<std::uint8_t>(node)};
    drive.master_node = node == 127 ? 126 : 127;
    auto claims = Claims(AtiParams{});
    const auto more = Claims(drive);
    claims.insert(claims.end(), more.begin(), more.end());
    const auto overlap = FindOverlap(claims);
    EXPECT_EQ(overlap.has_value(), node < 16) << node;
    if (node == 5) {
      EXPECT_EQ(*overlap,
                "CAN ids overlap: 0x200 … 0x20F of the ATI force sensor (base 0x20) (requests and answers) "
                "and 0x205 of the reamer drive (node 5) (RPDO1); give the sensor another base, give the "
                "drive another node (16 or more beside an ATI sensor), or use a bus for each");
    }
  }
}

}  // namespace
}  // namespace osteon::io
