#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "io/can/ati_sensor.h"
#include "io/can/reamer_drive.h"
#include "io/can/robotous_sensor.h"
#include "io/can/udp_can_codec.h"
#include "tests/fuzz/targets/fuzz_input.h"

// Fuzz target: data from a CAN bus for one client. The input's byte 0 (two bits) selects the client: a
// Robotous sensor, an ATI sensor, the drive or the UDP tunnel. Sensors and drive get frames
//
//     byte  0     low four bits: index of the device's id, or 15: the id is in the next two bytes;
//                 high bits: further events (Op)
//           1, 2  id, little-endian, if byte 0 says so
//           then  size, and that many bytes
//
// and the tunnel gets one datagram, the rest of the input.

namespace osteon::fuzz {
namespace {

// High bits of a frame's byte 0: further events.
enum Op : unsigned {
  kGap = 1u << 4,    // the bus reports that frames before this one were lost
  kLater = 1u << 5,  // the frame comes 10 ms later; if not set, 1 ms
  kExtra = 1u << 6,  // for a sensor, a bias is requested; the drive is switched off and its faults are reset
  kRestart = 1u << 7,  // the client is restarted, if kExtra is set as well
};
constexpr std::size_t kMaxFrames = 4096;      // largest number of frames in one input, to bound the time
constexpr double kMaxSpeed_rad_per_s = 40.0;  // speed limit of the reamer
constexpr double kGear = 20.0;                // gear ratio: the motor's speed over the reamer's

// Reads the next frame from the input. @param ids  the ids that the client knows
template <std::size_t N>
io::CanFrame NextFrame(Input& in, unsigned op, const std::array<std::uint16_t, N>& ids) {
  io::CanFrame frame;
  const unsigned which = op & 15u;
  frame.id = which == 15 ? static_cast<std::uint16_t>(in.Word() & io::kCanMaxId) : ids[which % N];
  frame.size = static_cast<std::uint8_t>(in.Byte() % 9);
  const auto bytes = in.Bytes(frame.size);
  for (std::size_t i = 0; i < bytes.size(); ++i) frame.data[i] = bytes[i];
  return frame;
}

// Collects everything that the client wants to send now, and calls `look` for each frame.
template <class Client, class Look>
void Send(Client& client, rt::Nanoseconds now, Look&& look) {
  io::CanFrame out;
  for (int n = 0; client.Next(now, out); ++n) {
    Claim(n < 16, "a client stops sending");
    Claim(out.id <= io::kCanMaxId && out.size <= 8, "a client sends classical frames");
    look(out);
  }
}

// Delivers all frames of the input to a client. @param next  makes a frame @param each  called after each
// frame
// @param look  called for each frame that the client sends
template <class Client, class Next, class Each, class Look>
void FeedFrames(Input& in, Client& client, Next&& next, Each&& each, Look&& look) {
  rt::Nanoseconds now = rt::kSecond;
  Send(client, now, look);
  for (std::size_t i = 0; i < kMaxFrames && !in.empty(); ++i) {
    const unsigned op = in.Byte();
    now += ((op & kLater) != 0 ? 10 : 1) * rt::kMillisecond;
    client.Accept({.frame = next(op), .stamp = now, .after_gap = (op & kGap) != 0});
    each(op);
    Send(client, now, look);
    if ((op & (kRestart | kExtra)) == (kRestart | kExtra)) client.Restart();
  }
}

// Delivers the input to a sensor's client, and claims that its readings are finite.
void FuzzSensor(Input& in, io::WrenchSensor& sensor, const std::array<std::uint16_t, 8>& ids) {
  std::uint64_t readings = 0;
  const auto check = [&](unsigned op) {
    if ((op & kExtra) != 0) sensor.RequestBias((op & kLater) != 0);
    const io::SensorReading& latest = sensor.Latest();
    Claim(Vector3(latest.F_S.f).allFinite() && Vector3(latest.F_S.t).allFinite(), "a reading is finite");
    Claim(sensor.failure().empty() == (sensor.phase() != io::SensorPhase::kFailed),
          "a refusal has its reason");
    const std::uint64_t now = sensor.counters().readings;
    Claim(now == readings || sensor.phase() != io::SensorPhase::kFailed, "a refused sensor has no readings");
    readings = now;
  };
  const auto next = [&](unsigned op) { return NextFrame(in, op, ids); };
  FeedFrames(in, sensor, next, check, [](const io::CanFrame&) {});
}

// Delivers the input to the drive's client. Claims that the client never commands too high a speed, and no
// motion during a fault.
void FuzzDrive(Input& in) {
  auto drive = *io::ReamerDrive::Make(
      {.node = 16, .gear_ratio = kGear, .rated_torque_Nm = 0.5, .max_speed_rad_per_s = kMaxSpeed_rad_per_s});
  const std::array<std::uint16_t, 8> ids{0x590, 0x710, 0x190, 0x290, 0x090, 0x000, 0x080, 0x390};
  io::CanFrame asked;  // newest SDO request of the client
  // index 14 stands for the correct answer to the newest request
  const auto next = [&](unsigned op) {
    if ((op & 15u) != 14) return NextFrame(in, op, ids);
    io::CanFrame answer = asked;
    answer.id = 0x590;
    const bool read = asked.data[0] == 0x40;
    answer.data[0] = read ? 0x43 : 0x60;
    if (read)
      answer.data[4] = asked.data[2] == 0x10 ? 0x92 : 0xF4, answer.data[5] = 1;  // profile 402, 500 mN·m
    return answer;
  };
  const auto each = [&](unsigned op) {
    const bool off = (op & kExtra) != 0;
    drive.Command({.goal = off ? io::DriveGoal::kOff : io::DriveGoal::kEnabled,
                   .speed_rad_per_s = (op & kLater) != 0 ? 1e300 : std::nan("")});
    if (off) (void)drive.ResetFaults();
    Claim(std::isfinite(drive.status().speed_rad_per_s) && std::isfinite(drive.status().torque_Nm) &&
              std::isfinite(drive.status().temperature),
          "the drive's status is finite");
    Claim(drive.failure().empty() == (drive.phase() != io::DrivePhase::kFailed), "a refusal has its reason");
  };
  const int max_rpm = static_cast<int>(kMaxSpeed_rad_per_s * kGear * 60.0 / (2.0 * 3.14159265358979) + 1.0);
  const auto look = [&](const io::CanFrame& out) {
    if (out.id == 0x610) asked = out;
    if (out.id != 0x210) return;
    const auto rpm = static_cast<std::int32_t>(out.data[3] | out.data[4] << 8 | out.data[5] << 16 |
                                               std::uint32_t{out.data[6]} << 24);
    Claim(std::abs(rpm) <= max_rpm, "the drive is never commanded beyond its speed");
    Claim(drive.status().faults == 0 || out.data[0] != 0x0F, "the drive is not enabled in spite of a fault");
  };
  FeedFrames(in, drive, next, each, look);
}

// Decodes a datagram of the tunnel. Claims that an accepted datagram is encoded to the same bytes.
void FuzzTunnel(Input& in) {
  const auto bytes = in.Rest();
  const std::vector<std::uint8_t> datagram(bytes.begin(), bytes.end());
  io::UdpCanMessage message;
  const io::UdpCanError error = io::DecodeUdpCan(datagram, message);
  if (error != io::UdpCanError::kNone)
    return Claim(message.frame == io::CanFrame{}, "an error changes nothing");
  Claim(message.frame.id <= io::kCanMaxId && message.frame.size <= 8, "the tunnel brings classical frames");
  std::array<std::uint8_t, io::kUdpCanMaxDatagram> again{};
  const std::size_t size = io::EncodeUdpCan(message, again);
  Claim(std::equal(datagram.begin(), datagram.end(), again.begin(),
                   again.begin() + static_cast<std::ptrdiff_t>(size)),
        "what is taken is written again as it came");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  fuzz::Input in(data, size);
  switch (in.Byte() & 3u) {
    case 0: {
      auto sensor = *io::RobotousSensor::Make({.rate_readings = 2});
      fuzz::FuzzSensor(in, sensor, {1, 2, 0x64, 1, 2, 3, 0, 0x7ff});
      return 0;
    }
    case 1: {
      auto sensor = *io::AtiSensor::Make({.bias_readings = 2});
      fuzz::FuzzSensor(in, sensor, {0x200, 0x201, 0x202, 0x203, 0x204, 0x207, 0x208, 0x20f});
      return 0;
    }
    case 2:
      fuzz::FuzzDrive(in);
      return 0;
    default:
      fuzz::FuzzTunnel(in);
      return 0;
  }
}
