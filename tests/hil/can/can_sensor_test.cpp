#include <cmath>

#include <gtest/gtest.h>

#include "hil/can/robotous_device.h"
#include "io/can/robotous_sensor.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/hil/can/can_sensor_cell.h"

// Tests the simulated Robotous force sensor: its CAN frames against the manual, and the client with the
// simulated sensor on a virtual bus. Frames are written in candump's notation, identifier#data.

namespace osteon::hil {
namespace {

using io::SensorPhase;
using io::test::At;
using io::test::Frames;
using io::test::kMs;
using io::test::Sent;

using Cell = SensorCell<RobotousDevice, RobotousDeviceParams, io::RobotousSensor, io::RobotousParams>;

TEST(RobotousDevice, AnswersWithTheManualsFrames) {
  RobotousDevice device({});
  EXPECT_EQ(Sent(device, 0), Frames{}) << "silent until started";
  device.Accept(At(0, "064#1000000000000000"));
  EXPECT_EQ(Sent(device, 0), (Frames{"001#1000000000000000", "002#0000000000000000"})) << "200 Hz by default";
  device.Accept(At(0, "064#0F08000000000000"));
  EXPECT_EQ(Sent(device, 0), (Frames{"001#0F01000000000000", "002#0000000000000000"}));
  device.Accept(At(0, "064#0F09000000000000"));
  EXPECT_EQ(Sent(device, 0), (Frames{"001#0F00020000000000", "002#0000000000000000"})) << "no such rate";
  device.SetLoad(Load(2, -2, 300, -1, 1, 0.5));
  device.Accept(At(0, "064#0B00000000000000"));
  EXPECT_EQ(Sent(device, 0), (Frames{"001#0B0064FF9C3A98F8", "002#3007D003E8000000"}));
  EXPECT_EQ(Sent(device, kMs).size(), 2u) << "1000 Hz, as set";
  device.Accept(At(kMs, "064#1000000000000000"));
  EXPECT_EQ(Sent(device, kMs), Frames{}) << "deaf to all but stop and bias while it sends";
  device.Accept(At(kMs, "064#0C00000000000000"));
  EXPECT_EQ(Sent(device, 5 * kMs), Frames{});
  device.Accept(At(kMs, "064#0B"));
  EXPECT_EQ(Sent(device, 5 * kMs), Frames{}) << "a command has 8 bytes";
}

TEST(RobotousDevice, SaturatesAtItsRangeAndReportsTheOverload) {
  RobotousDevice device({});
  device.SetLoad(Load(0, 0, -900, 0, 20, 0));
  device.Accept(At(0, "064#0A00000000000000"));
  EXPECT_EQ(Sent(device, 0),
            (Frames{"001#0A000000009E5800",
                    "002#0075300000140000"}));  // saturated counts: force z -25000, torque y 30000
  device.Accept(At(0, "064#1200000000000000"));
  EXPECT_EQ(Sent(device, 0), (Frames{"001#1200000100010000", "002#0000000000000000"}));
}

TEST(Robotous, TheClientReadsTheLoadToWithinHalfACount) {
  Cell cell;
  cell.Start();
  ASSERT_EQ(cell.sensor.phase(), SensorPhase::kReady) << cell.sensor.failure();
  cell.ExpectLoadsWithin({9, -7, 5}, 0.5 / 50 + 1e-12, 0.5 / 2000 + 1e-12);
}

TEST(Robotous, ABiasZeroesThePresentLoadAndCanBeRemoved) {
  Cell cell;
  cell.device.SetLoad(Load(3, -4, 12, 0.5, 0, -0.25));
  cell.Start();
  cell.sensor.RequestBias(true);
  cell.Run(3);
  EXPECT_EQ(cell.F().f.norm(), 0.0);
  EXPECT_EQ(cell.F().t.norm(), 0.0);
  cell.device.SetLoad(Load(13, -4, 12, 0.5, 0, -0.25));
  cell.Run(1);
  EXPECT_NEAR(cell.F().f.x(), 10.0, 0.011);
  cell.sensor.RequestBias(false);
  cell.Run(3);
  EXPECT_NEAR(cell.F().f.x(), 13.0, 0.011);
}

TEST(Robotous, DriftAndNoiseAreAsConfigured) {
  Cell drifting({.model = {.drift_N_per_s = Vector3(0.1, 0, -0.5)}});
  drifting.Start();
  const Wrench start = drifting.F();
  drifting.Run(10'000);
  EXPECT_NEAR(drifting.F().f.x() - start.f.x(), 1.0, 0.02);
  EXPECT_NEAR(drifting.F().f.z() - start.f.z(), -5.0, 0.02);

  Cell noisy({.model = {.noise_N = 0.5, .noise_Nm = 0.02, .seed = 7}});
  noisy.Start();
  double sum = 0, squares = 0, torque_squares = 0;
  constexpr int kReadings = 5000;
  for (int i = 0; i < kReadings; ++i) {
    noisy.Run(1);
    sum += noisy.F().f.y();
    squares += noisy.F().f.y() * noisy.F().f.y();
    torque_squares += noisy.F().t.z() * noisy.F().t.z();
  }
  // the tolerances are five standard errors of the mean and of the RMS, plus the rounding to counts
  EXPECT_NEAR(sum / kReadings, 0.0, 5 * 0.5 / std::sqrt(kReadings));
  EXPECT_NEAR(std::sqrt(squares / kReadings), 0.5, 5 * 0.5 / std::sqrt(2.0 * kReadings) + 0.01);
  EXPECT_NEAR(std::sqrt(torque_squares / kReadings), 0.02, 5 * 0.02 / std::sqrt(2.0 * kReadings) + 0.0005);
}

TEST(Robotous, EqualSeedsGiveEqualReadings) {
  const auto readings = [](std::uint32_t seed) {
    Cell cell({.model = {.noise_N = 1.0, .seed = seed}}, {}, {.loss = 0.05, .seed = seed});
    cell.Start();
    std::vector<double> values;
    for (int i = 0; i < 100; ++i) {
      cell.Run(1);
      values.push_back(cell.F().f.x());
    }
    return values;
  };
  EXPECT_EQ(readings(3), readings(3));
  EXPECT_NE(readings(3), readings(4));
}

TEST(Robotous, TheSensorFiltersAtTheConfiguredFrequency) {
  Cell cell({}, {.filter_hz = 10});
  cell.Start();
  cell.device.SetLoad(Load(100, 0, 0, 0, 0, 0));
  const double tau_s = 1.0 / (2 * M_PI * 10);
  cell.Run(static_cast<int>(std::lround(1000 * tau_s)));
  EXPECT_NEAR(cell.F().f.x(), 100 * (1 - std::exp(-1.0)), 3.0) << "one time constant after a step";
}

TEST(Robotous, OverloadIsFlaggedWhileItLasts) {
  Cell cell({.model = {.range_N = 200, .range_Nm = 10}});
  cell.Start();
  cell.device.SetLoad(Load(0, 250, 0, 0, 0, 0));
  cell.Run(1);
  EXPECT_EQ(cell.sensor.Latest().flags, io::kSensorOverload);
  EXPECT_NEAR(cell.F().f.y(), 200, 0.011);
  cell.device.SetLoad(Load(0, 150, 0, 0, 0, 0));
  cell.Run(1);
  EXPECT_EQ(cell.sensor.Latest().flags, 0u);
}

TEST(Robotous, ASensorThatDoesNotConfirmItsRateIsRefused) {
  const auto failure = [](const RobotousDeviceFaults& faults) {
    Cell cell;
    cell.device.SetFaults(faults);
    cell.Start();
    EXPECT_EQ(cell.sensor.phase(), SensorPhase::kFailed);
    EXPECT_EQ(cell.sensor.Latest().stamp, 0) << "no reading was let through";
    return cell.sensor.failure();
  };
  EXPECT_NE(failure({.keeps_its_rate = true}).find("rate reads back as code 0, accepted 8"),
            std::string::npos);
  EXPECT_NE(failure({.lies_about_rate = true}).find("readings come at 200 Hz, accepted 1000 Hz"),
            std::string::npos);
  EXPECT_NE(failure({.refuse_code = 0x0F}).find("refused command 0x0F with error 1"), std::string::npos);
  EXPECT_NE(failure({.silent = true}).find("no answer to command 0x08"), std::string::npos);
}

TEST(Robotous, ASilentSensorsReadingAgesUntilTheSensorIsSetUpAgain) {
  Cell cell;
  cell.Start();
  cell.device.SetFaults({.silent = true});
  const rt::Nanoseconds last = cell.sensor.Latest().stamp;
  cell.Run(50);
  EXPECT_EQ(cell.sensor.Latest().stamp, last) << "never a fresh stamp on an old force";
  cell.device.SetFaults({});
  cell.Run(50);
  EXPECT_EQ(cell.sensor.Latest().stamp, last) << "it has forgotten that it was started";
  cell.sensor.Restart();
  cell.Start();
  EXPECT_EQ(cell.sensor.phase(), SensorPhase::kReady) << cell.sensor.failure();
}

TEST(Robotous, StartsASensorThatIsAlreadySending) {
  Cell cell;
  cell.Start();
  cell.Run(10);
  cell.sensor = *io::RobotousSensor::Make({});  // a new client, as after a restart of the controller
  cell.Start();
  EXPECT_EQ(cell.sensor.phase(), SensorPhase::kReady) << cell.sensor.failure();
}

// Fx is in a reading's first frame, Ty in its second. Both loads follow the same counter. If the client
// joined frames of two readings, Fx and Ty would give different counts.
TEST(Robotous, LostDuplicatedAndReorderedFramesNeverMixTwoReadings) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    Cell cell;
    cell.Start();
    cell.bus.SetParams({.loss = 0.2, .duplicate = 0.1, .reorder = 0.1, .seed = seed});
    const auto before = cell.sensor.counters();
    for (int i = 0; i < 20'000; ++i) {
      const double n = i % 4000;
      cell.device.SetLoad(Load(n / 50, 0, 0, 0, n / 2000, 0));
      cell.Run(1);
      ASSERT_EQ(std::lround(cell.F().f.x() * 50), std::lround(cell.F().t.y() * 2000)) << i;
    }
    const auto after = cell.sensor.counters();
    // both frames of a reading arrive in 0.8² of the cases. Fewer readings are complete, because some frames
    // change places
    EXPECT_GT(after.readings - before.readings, 10'000u);
    EXPECT_LT(after.readings - before.readings, 14'000u);
    EXPECT_GT(after.halves - before.halves, 3'000u);
  }
}

TEST(Robotous, AnUnpluggedSensorFailsWithNoAnswer) {
  Cell cell;
  cell.bus.Connect(cell.device, false);
  cell.Start();
  EXPECT_NE(cell.sensor.failure().find("no answer"), std::string::npos);
}

TEST(Robotous, DoesNotAllocate) {
  Cell cell;
  cell.Start();
  cell.sensor.RequestBias(true);
  io::CanFrame frame;
  bool sent = false;
  {
    rt::CheckedNoAllocScope no_alloc;
    sent = cell.sensor.Next(cell.now, frame);
    cell.device.Accept({.frame = frame, .stamp = cell.now});
    for (int i = 0; i < 10; ++i) {
      cell.now += kMs;
      while (cell.device.Next(cell.now, frame)) cell.sensor.Accept({.frame = frame, .stamp = cell.now});
      while (cell.sensor.Next(cell.now, frame)) cell.device.Accept({.frame = frame, .stamp = cell.now});
    }
  }
  EXPECT_TRUE(sent);
  EXPECT_EQ(cell.sensor.Latest().stamp, cell.now);
}

}  // namespace
}  // namespace osteon::hil
