#include "hil/injection/impaired_can_bus.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "injection_bench.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/can/can_frames.h"

// Tests ImpairedCanBus, the connection of a simulated device to a CAN bus with injected faults, in virtual
// time.

namespace osteon::hil {
namespace {

using io::CanResult;
using io::test::Frame;

rt::Nanoseconds virtual_now = 0;

// The bus to which ImpairedCanBus passes frames. It keeps the frames that the device sends. It delivers a
// frame of `coming` once virtual_now has reached the frame's time stamp.
class MemoryBus final : public io::CanBus {
 public:
  CanResult Send(const io::CanFrame& frame) noexcept override {
    if (down) return CanResult::kDown;
    ++status_.sent;
    sent.push_back({.frame = frame, .stamp = virtual_now});
    return CanResult::kOk;
  }
  CanResult TryReceive(io::CanArrival& arrival) noexcept override {
    if (down) return CanResult::kDown;
    if (taken == coming.size() || coming[taken].stamp > virtual_now) return CanResult::kEmpty;
    arrival = coming[taken++];
    return CanResult::kOk;
  }
  // Advances virtual_now to the next frame or to the deadline, whichever is earlier.
  CanResult Receive(io::CanArrival& arrival, rt::Nanoseconds deadline) noexcept override {
    const rt::Nanoseconds next = taken == coming.size() ? deadline : std::min(deadline, coming[taken].stamp);
    virtual_now = std::max(virtual_now, next);
    return TryReceive(arrival);
  }
  [[nodiscard]] const io::CanStatus& status() const noexcept override { return status_; }

  std::vector<io::CanArrival> sent, coming;
  std::size_t taken{0};  // number of frames of `coming` that were delivered
  bool down{false};

 private:
  io::CanStatus status_;
};

class InjectionCan : public testing::Test {
 protected:
  void SetUp() override { virtual_now = 0; }
  MemoryBus device_bus_;
};

// Faults on the force sensor's wire.
InjectionParams Sensor(const WireFaults& faults, Direction direction = Direction::kBoth) {
  return Always(faults, Wire::kForceSensor, direction);
}

TEST_F(InjectionCan, FramesPassUnchangedWithoutFaults) {
  ImpairedCanBus bus(device_bus_, {}, Wire::kForceSensor, {}, &virtual_now);
  for (const char* text : {"001#0B0064FF9C3A98F8", "7FF#", "064#0B"}) {
    EXPECT_EQ(bus.Send(Frame(text)), CanResult::kOk);
    EXPECT_EQ(io::ToText(device_bus_.sent.back().frame), text);
    device_bus_.coming.push_back({.frame = Frame(text), .stamp = virtual_now, .after_gap = true});
    io::CanArrival arrival;
    EXPECT_EQ(bus.TryReceive(arrival), CanResult::kOk);
    EXPECT_EQ(arrival.frame, Frame(text));
    EXPECT_TRUE(arrival.after_gap);
    EXPECT_EQ(bus.TryReceive(arrival), CanResult::kEmpty);
  }
  device_bus_.down = true;
  io::CanArrival arrival;
  EXPECT_EQ(bus.Send(Frame("001#00")), CanResult::kDown);
  EXPECT_EQ(bus.TryReceive(arrival), CanResult::kDown);
}

// Tests each fault alone, at 10 % of 10'000 frames. About 1000 faults are expected; a random draw stays above
// 700.
TEST_F(InjectionCan, CountersEqualTheFramesLostDoubledOrChanged) {
  const io::CanFrame frame = Frame("123#0102030405060708");
  const auto run = [&](const WireFaults& faults, WireCounters& n) {
    MemoryBus device_bus;
    ImpairedCanBus bus(device_bus, Sensor(faults, Direction::kToController), Wire::kForceSensor, {},
                       &virtual_now);
    for (int i = 0; i < 10'000; ++i) EXPECT_EQ(bus.Send(frame), CanResult::kOk) << "the device knows nothing";
    n = bus.to_controller();
    return device_bus.sent;
  };
  WireCounters n;
  std::size_t count = run({.loss = 0.1, .burst = 3}, n).size();
  EXPECT_EQ(count, 10'000 - n.lost);
  EXPECT_GT(n.lost, 700u);
  count = run({.duplicate = 0.1}, n).size();
  EXPECT_EQ(count, 10'000 + n.duplicated);
  EXPECT_GT(n.duplicated, 700u);
  std::uint64_t changed = 0;
  for (const io::CanArrival& came : run({.corrupt = 0.1}, n)) {
    EXPECT_EQ(came.frame.id, frame.id);
    EXPECT_LE(came.frame.size, 8);
    changed += came.frame == frame ? 0 : 1;
  }
  EXPECT_EQ(changed, n.corrupted);
  EXPECT_GT(n.corrupted, 700u);
  EXPECT_EQ(run({.silence = true}, n).size(), 0u);
}

// While Receive() waits for a frame, delayed frames of both directions must move at their due times.
TEST_F(InjectionCan, ReceiveWakesWhenADelayedFrameIsDue) {
  constexpr rt::Nanoseconds kDelay = 300'000;  // 0.3 ms
  ImpairedCanBus bus(device_bus_, Sensor({.delay = kDelay}), Wire::kForceSensor, {}, &virtual_now);
  device_bus_.coming.push_back({.frame = Frame("064#0B"), .stamp = 100'000});
  EXPECT_EQ(bus.Send(Frame("001#0B")), CanResult::kOk);
  EXPECT_TRUE(device_bus_.sent.empty());
  io::CanArrival arrival;
  EXPECT_EQ(bus.Receive(arrival, 350'000), CanResult::kEmpty);
  ASSERT_EQ(device_bus_.sent.size(), 1u);
  EXPECT_EQ(device_bus_.sent[0].stamp, kDelay) << "though nobody asked then";
  EXPECT_EQ(virtual_now, 350'000);
  EXPECT_EQ(bus.Receive(arrival, rt::kSecond), CanResult::kOk);
  EXPECT_EQ(arrival.stamp, 100'000 + kDelay);
  EXPECT_EQ(virtual_now, 100'000 + kDelay);
}

// Two devices share the bus. The force sensor (0x001, 0x064) is silenced, the drive's frames (0x7F in the low
// seven bits) are doubled, and the frame 0x080 belongs to neither device, so it must pass unchanged.
TEST_F(InjectionCan, ChangesOnlyFramesOfItsOwnWire) {
  ImpairedCanBus sensor(device_bus_, Sensor({.silence = true}), Wire::kForceSensor,
                        {{.id = 0x64}, {.id = 0x1}}, &virtual_now);
  ImpairedCanBus both(sensor, Always({.duplicate = 1.0}, Wire::kDrive), Wire::kDrive,
                      {{.id = 0x7f, .mask = 0x7f}}, &virtual_now);
  for (const char* text : {"001#0B", "1FF#00", "080#"}) EXPECT_EQ(both.Send(Frame(text)), CanResult::kOk);
  std::vector<std::string> sent;
  for (const io::CanArrival& came : device_bus_.sent) sent.push_back(io::ToText(came.frame));
  EXPECT_EQ(sent, (io::test::Frames{"1FF#00", "1FF#00", "080#"}));
  for (const char* text : {"064#0B", "27F#00", "080#"})
    device_bus_.coming.push_back({.frame = Frame(text), .stamp = 0});
  io::CanArrival arrival;
  std::vector<std::string> came;
  while (both.TryReceive(arrival) == CanResult::kOk) came.push_back(io::ToText(arrival.frame));
  EXPECT_EQ(came, (io::test::Frames{"080#", "27F#00", "27F#00"})) << "what is of no wire does not wait";
  EXPECT_EQ(sensor.from_controller().silenced, 1u);
  EXPECT_EQ(sensor.to_controller().silenced, 1u);
}

// The schedule contains a silence from its time 0. Frames must pass until StartSchedule() is called.
TEST_F(InjectionCan, FaultsBeginWhenTheScheduleStarts) {
  const InjectionParams params{.injections = {{.wire = Wire::kForceSensor, .faults = {.silence = true}}}};
  ImpairedCanBus bus(device_bus_, params, Wire::kForceSensor, {}, &virtual_now);
  bus.Send(Frame("001#0B"));
  EXPECT_EQ(device_bus_.sent.size(), 1u);
  bus.StartSchedule(virtual_now);
  bus.Send(Frame("001#0B"));
  EXPECT_EQ(device_bus_.sent.size(), 1u);
}

TEST_F(InjectionCan, DoesNotAllocate) {
  device_bus_.sent.reserve(100);
  ImpairedCanBus bus(device_bus_, Sensor({.duplicate = 0.5, .corrupt = 0.5, .delay = 10}), Wire::kForceSensor,
                     {}, &virtual_now);
  device_bus_.coming.assign(20, {.frame = Frame("064#0B"), .stamp = 0});
  io::CanArrival arrival;
  const io::CanFrame frame = Frame("001#0B");
  rt::CheckedNoAllocScope no_alloc;
  for (int i = 0; i < 20; ++i) {
    bus.Send(frame);
    virtual_now += 5;
    static_cast<void>(bus.TryReceive(arrival));
  }
}

}  // namespace
}  // namespace osteon::hil
