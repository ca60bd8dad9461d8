#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "io/can/ati_sensor.h"
#include "io/can/reamer_drive.h"
#include "io/can/robotous_sensor.h"
#include "io/can/udp_can_codec.h"
#include "tests/io/can/can_frames.h"

// Fixed-seed fuzzing of the CAN clients (two force sensors, the drive) and of the UDP tunnel. They receive
// answers with the right ids and changed bytes, and noise.

namespace osteon::io {
namespace {

constexpr unsigned kSeed = 20240811;

// Makes random numbers and random CAN frames.
class Noise {
 public:
  std::size_t Below(std::size_t n) { return random_() % n; }

  // A frame that usually has one of these ids and one of these first bytes. Its size and its other bytes are
  // random.
  CanFrame Frame(std::initializer_list<int> ids, std::initializer_list<int> first_bytes) {
    CanFrame frame;
    const bool any = Below(10) == 0;
    frame.id = static_cast<std::uint16_t>(any ? Below(0x800) : OneOf(ids));
    frame.size = static_cast<std::uint8_t>(Below(8) == 0 ? Below(9) : OneOf({8, 8, 7, 6, 2, 1}));
    for (std::size_t i = 0; i < frame.size; ++i)
      frame.data[i] = static_cast<std::uint8_t>(Below(3) == 0 ? 0 : Below(256));
    if (frame.size > 0 && Below(4) != 0) frame.data[0] = static_cast<std::uint8_t>(OneOf(first_bytes));
    return frame;
  }
  int OneOf(std::initializer_list<int> list) { return *(list.begin() + Below(list.size())); }

 private:
  std::mt19937 random_{kSeed};
};

bool Finite(const PlainWrench& F) { return Vector3(F.f).allFinite() && Vector3(F.t).allFinite(); }

// Delivers frames of `make` to a client at random times, lets the client send its own frames, and restarts it
// from time to time.
// @param check  called after each step
template <class Client, class MakeFrame, class Check>
void Fuzz(Client& client, int steps, MakeFrame&& make, Check&& check) {
  rt::Nanoseconds now = 0;
  Noise noise;
  for (int i = 0; i < steps; ++i) {
    now += static_cast<rt::Nanoseconds>(noise.Below(2)) * rt::kMillisecond;
    const CanFrame frame = make(noise);
    client.Accept({.frame = frame, .stamp = now, .after_gap = noise.Below(50) == 0});
    CanFrame out;
    for (int n = 0; client.Next(now, out); ++n) {
      ASSERT_LT(n, 16) << "a client that never stops sending";
      ASSERT_LE(out.id, kCanMaxId);
      ASSERT_LE(out.size, 8);
    }
    check(i);
    if (noise.Below(500) == 0) client.Restart();
  }
}

TEST(CanFuzz, ARobotousSensorGivesOnlyFiniteReadings) {
  SCOPED_TRACE(kSeed);
  auto sensor = *RobotousSensor::Make({.rate_readings = 2});
  std::uint64_t max_readings = 0;
  int step = 0;
  Fuzz(
      sensor, 200'000,
      [&](Noise& noise) {
        CanFrame frame = noise.Frame({1, 2, 1, 2, 0x64}, {0x0B, 0x08, 0x09, 0x0F, 0x10});
        if (noise.Below(5) !=
            0) {  // usually delivers the two frames of a reading in order, with random content
          frame.id = static_cast<std::uint16_t>(1 + step++ % 2);
          frame.size = 8;
          if (frame.id == 1 && frame.data[0] < 0x0B) frame.data[1] = frame.data[2] = 0;
          if (frame.id == 1 && frame.data[0] == 0x0F) frame.data[2] = 0;
          if (frame.id == 1 && frame.data[0] == 0x10) frame.data[1] = 8;
        }
        return frame;
      },
      [&](int) {
        ASSERT_TRUE(Finite(sensor.Latest().F_S));
        ASSERT_EQ(sensor.failure().empty(), sensor.phase() != SensorPhase::kFailed);
        max_readings = std::max(max_readings, sensor.counters().readings);
      });
  EXPECT_GT(sensor.counters().unexpected, 1000u);
  EXPECT_GT(max_readings, 50u) << "the noise must not be so wild that it never runs";
}

TEST(CanFuzz, AnAtiSensorGivesOnlyFiniteReadings) {
  SCOPED_TRACE(kSeed);
  auto sensor = *AtiSensor::Make({});
  std::uint64_t max_readings = 0;
  int answer = 0;
  Fuzz(
      sensor, 200'000,
      [&](Noise& noise) {
        // Usually deliver the expected answer in its order, with random content.
        if (noise.Below(5) != 0) {
          constexpr std::array<int, 3> kRow{0x202, 0x203, 0x204};
          CanFrame frame = noise.Frame({0x200}, {0, 0x3F, 0x40});
          frame.id =
              static_cast<std::uint16_t>(sensor.phase() == SensorPhase::kReady ? 0x200 + answer % 2
                                         : noise.Below(4) == 0                 ? 0x207 + answer % 2
                                                               : kRow[static_cast<std::size_t>(answer % 3)]);
          frame.size = frame.id == 0x201 ? 6 : frame.id == 0x208 ? 2 : 8;
          if (frame.id == 0x208) frame.data = {2, 3};
          for (std::size_t i = frame.size; i < 8; ++i) frame.data[i] = 0;
          ++answer;
          return frame;
        }
        return noise.Frame({0x200, 0x201, 0x202, 0x203, 0x204, 0x207, 0x208}, {0, 0x3F, 0x7F, 0xFF});
      },
      [&](int) {
        ASSERT_TRUE(Finite(sensor.Latest().F_S));
        ASSERT_EQ(sensor.failure().empty(), sensor.phase() != SensorPhase::kFailed);
        max_readings = std::max(max_readings, sensor.counters().readings);
      });
  EXPECT_GT(max_readings, 100u) << "the noise must not be so wild that it never runs";
}

TEST(CanFuzz, TheDriveIsNeverCommandedBeyondItsSpeedOrOutOfAFault) {
  SCOPED_TRACE(kSeed);
  auto drive =
      *ReamerDrive::Make({.node = 16, .gear_ratio = 20, .rated_torque_Nm = 0.5, .max_speed_rad_per_s = 40});
  rt::Nanoseconds now = 0;
  Noise noise;
  CanFrame asked{};  // the drive client's last SDO request
  int ready = 0, enabled = 0;
  for (int i = 0; i < 300'000; ++i) {
    now += static_cast<rt::Nanoseconds>(noise.Below(3)) * rt::kMillisecond;
    CanFrame frame = noise.Frame({0x090, 0x190, 0x290, 0x590, 0x710, 0x190}, {0x27, 0x43, 0x60, 0x80, 5, 0});
    if (drive.phase() == DrivePhase::kStarting && noise.Below(20) != 0) {  // usually the correct answer
      frame = asked;
      frame.id = 0x590;
      frame.data[0] = asked.data[0] == 0x40 ? 0x43 : 0x60;
      if (asked.data[0] == 0x40) frame.data[4] = asked.data[2] == 0x10 ? 0x92 : 0xF4, frame.data[5] = 1;
      if (noise.Below(4) == 0) frame = test::Frame("710#05");
    } else if (drive.phase() == DrivePhase::kReady && noise.Below(3) == 0) {
      frame = test::Frame("710#05");
    }
    drive.Accept({.frame = frame, .stamp = now, .after_gap = false});
    drive.Command(
        {.goal = DriveGoal::kEnabled, .speed_rad_per_s = noise.Below(2) == 0 ? 1e300 : std::nan("")});
    CanFrame out;
    for (int n = 0; drive.Next(now, out); ++n) {
      ASSERT_LT(n, 16);
      if (out.id == 0x610) asked = out;
      if (out.id != 0x210) continue;
      const int rpm = static_cast<int>(out.data[3] | out.data[4] << 8 | out.data[5] << 16 |
                                       static_cast<unsigned>(out.data[6]) << 24);
      ASSERT_LE(std::abs(rpm), 7640);  // 40 rad/s at the reamer, times the gear ratio of 20
      if (drive.status().faults != 0) {
        ASSERT_NE(out.data[0], 0x0F) << "enabled in spite of a fault";
      }
      enabled += out.data[0] == 0x0F ? 1 : 0;
    }
    ASSERT_TRUE(std::isfinite(drive.status().speed_rad_per_s) && std::isfinite(drive.status().torque_Nm));
    ASSERT_EQ(drive.failure().empty(), drive.phase() != DrivePhase::kFailed);
    ready += drive.phase() == DrivePhase::kReady ? 1 : 0;
    if (noise.Below(100) == 0) {
      drive.Command({.goal = DriveGoal::kOff});
      (void)drive.ResetFaults();
    }
    if (noise.Below(2000) == 0 || drive.phase() == DrivePhase::kFailed) drive.Restart();
  }
  EXPECT_GT(ready, 1000);
  EXPECT_GT(enabled, 100);
}

TEST(CanFuzz, TheTunnelAcceptsOnlyValidFrames) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::array<std::uint8_t, kUdpCanMaxDatagram> buffer{};
  int accepted = 0, refused = 0;
  for (int i = 0; i < 200'000; ++i) {
    CanFrame frame{.id = static_cast<std::uint16_t>(random() % 0x800),
                   .size = static_cast<std::uint8_t>(random() % 9)};
    for (std::size_t k = 0; k < frame.size; ++k) frame.data[k] = static_cast<std::uint8_t>(random());
    const std::size_t size = EncodeUdpCan({.frame = frame, .session = 1, .sequence = 2}, buffer);
    std::vector<std::uint8_t> bytes(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
    switch (random() % 4) {
      case 0:
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
        break;
      case 1:
        bytes.resize(random() % 40);
        break;
      case 2:
        for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
        break;
      default:
        break;
    }
    UdpCanMessage message;
    if (DecodeUdpCan(bytes, message) != UdpCanError::kNone) {
      ++refused;
      continue;
    }
    ++accepted;
    ASSERT_LE(message.frame.id, kCanMaxId);
    ASSERT_LE(message.frame.size, 8);
    // An accepted datagram must be encoded again to the same bytes.
    std::array<std::uint8_t, kUdpCanMaxDatagram> again{};
    ASSERT_EQ(EncodeUdpCan(message, again), bytes.size());
    ASSERT_TRUE(std::equal(bytes.begin(), bytes.end(), again.begin()));
  }
  EXPECT_GT(accepted, 10'000);
  EXPECT_GT(refused, 10'000);
}

}  // namespace
}  // namespace osteon::io
