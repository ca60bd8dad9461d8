#include <cmath>

#include <gtest/gtest.h>

#include "hil/can/ati_device.h"
#include "io/can/ati_sensor.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/hil/can/can_sensor_cell.h"

// Tests the simulated ATI force sensor: its CAN frames against the manual, and the client with the simulated
// sensor on a virtual bus. Frames are written in candump's notation, identifier#data.

namespace osteon::hil {
namespace {

using io::SensorPhase;
using io::test::At;
using io::test::Frames;
using io::test::kMs;
using io::test::Sent;

using Cell = SensorCell<AtiDevice, AtiDeviceParams, io::AtiSensor, io::AtiParams>;

TEST(AtiDevice, AnswersWithTheManualsFrames) {
  AtiDevice device({.counts_per_N = 100, .counts_per_Nm = 0x01020304});
  device.Accept(At(0, "207#"));
  EXPECT_EQ(Sent(device, 0), Frames{"207#0000006401020304"});
  device.Accept(At(0, "208#"));
  EXPECT_EQ(Sent(device, 0), Frames{"208#0203"});
  device.Accept(At(0, "202#00"));
  // the diagonal element is 660 N · 100 / 30000 = 2.2, as float 400CCCCD; the next element of the row is 0
  const Frames row = Sent(device, 0);
  ASSERT_EQ(row.size(), 3u);
  EXPECT_EQ(row[0], "202#400CCCCD00000000");
  EXPECT_EQ(row[1].substr(0, 4), "203#");
  EXPECT_EQ(row[2].substr(0, 4), "204#");
  device.SetStatus(0x4000);
  device.Accept(At(0, "200#"));
  EXPECT_EQ(Sent(device, 0), (Frames{"200#C000000000000000", "201#000000000000"}));
  device.Accept(At(0, "202#06"));
  device.Accept(At(0, "202#"));
  device.Accept(At(0, "200#00"));
  device.Accept(At(0, "210#"));
  EXPECT_EQ(Sent(device, 0), Frames{});
}

TEST(Ati, TheClientReadsTheDevicesMatrix) {
  Cell cell;
  cell.Start();
  ASSERT_EQ(cell.sensor.phase(), SensorPhase::kReady) << cell.sensor.failure();
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      EXPECT_EQ(cell.sensor.matrix()[static_cast<std::size_t>(6 * row + column)],
                cell.device.matrix()(row, column));
}

TEST(Ati, TheClientReadsTheLoadToWithinTheGaugesRounding) {
  Cell cell;
  cell.Start();
  // the error is half a count of each gauge times the sum of a row of the matrix: 660 / 30000 · (1 + 5 ·
  // 0.04) / 2 N for the force. For the torque 60 N·m replace the 660 N
  const double force = 660.0 / 30000 * 1.2 / 2, torque = 60.0 / 30000 * 1.2 / 2;
  cell.ExpectLoadsWithin({20, -10, 5}, force, torque);
}

TEST(Ati, ABiasZeroesTheLoadAndLaterDriftIsMeasured) {
  Cell cell({.model = {.drift_N_per_s = Vector3(0, 0.2, 0), .range_N = 660, .range_Nm = 60}});
  cell.device.SetLoad(Load(5, -3, 40, 1, 0, 2));
  cell.Start();
  cell.sensor.RequestBias(true);
  cell.Run(101);
  EXPECT_LT(cell.F().f.norm(), 0.06);
  EXPECT_LT(cell.F().t.norm(), 0.005);
  cell.Run(10'000);
  EXPECT_NEAR(cell.F().f.y(), 2.0, 0.05);
}

TEST(Ati, ReportsOverloadBusErrorAndSilence) {
  Cell cell;
  cell.Start();
  cell.device.SetLoad(Load(0, 0, 800, 0, 0, 0));
  cell.Run(1);
  EXPECT_EQ(cell.sensor.Latest().flags, io::kSensorOverload);
  cell.device.SetLoad(Load(0, 0, 100, 0, 0, 0));
  cell.device.SetStatus(0x4000);
  cell.Run(1);
  EXPECT_EQ(cell.sensor.Latest().flags, io::kSensorBusError);
  cell.device.SetStatus(0);
  cell.Run(1);
  EXPECT_EQ(cell.sensor.Latest().flags, 0u);
  const rt::Nanoseconds last = cell.sensor.Latest().stamp;
  cell.device.SetSilent(true);
  cell.Run(30);
  EXPECT_EQ(cell.sensor.Latest().stamp, last);
  cell.device.SetSilent(false);
  cell.Run(1);
  EXPECT_GT(cell.sensor.Latest().stamp, last) << "it has nothing to be set up";
}

TEST(Ati, LostDuplicatedAndReorderedFramesNeverMixTwoReadings) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    Cell cell;
    cell.Start();
    cell.bus.SetParams({.loss = 0.2, .duplicate = 0.1, .reorder = 0.1, .seed = seed});
    for (int i = 0; i < 5'000; ++i) {
      // Fx and Fy have the same load. Fx depends mostly on the reading's first frame, Fy on its second. If
      // the client joined frames of two readings, Fx and Fy would differ by whole newtons
      const double n = 5.0 * (i % 80);
      cell.device.SetLoad(Load(n, n, 0, 0, 0, 0));
      cell.Run(1);
      ASSERT_NEAR(cell.F().f.x(), cell.F().f.y(), 0.05) << i;
    }
    EXPECT_GT(cell.sensor.counters().readings, 2'000u);
    EXPECT_GT(cell.sensor.counters().halves, 500u);
  }
}

TEST(Ati, DoesNotAllocate) {
  Cell cell;
  cell.Start();
  cell.sensor.RequestBias(true);
  {
    rt::CheckedNoAllocScope no_alloc;
    io::CanFrame frame;
    for (int i = 0; i < 10; ++i) {
      cell.now += kMs;
      while (cell.sensor.Next(cell.now, frame)) cell.device.Accept({.frame = frame, .stamp = cell.now});
      while (cell.device.Next(cell.now, frame)) cell.sensor.Accept({.frame = frame, .stamp = cell.now});
    }
  }
  EXPECT_EQ(cell.sensor.Latest().stamp, cell.now);
}

}  // namespace
}  // namespace osteon::hil
