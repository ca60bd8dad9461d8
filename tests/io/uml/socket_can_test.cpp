// SocketCanBus on a real kernel's virtual CAN interface (vcan), with can-utils as the other node. Runs in the
// guest of run_in_uml.sh, or by hand on a machine with a vcan: OSTEON_VCAN=vcan0. The test that sets the
// interface down needs root.

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "io/can/socket_can_bus.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/can/can_frames.h"

namespace osteon::io {
namespace {

const char* Interface() { return std::getenv("OSTEON_VCAN"); }

CanFrame Frame(std::uint16_t id, std::initializer_list<std::uint8_t> data) {
  CanFrame frame{.id = id, .size = static_cast<std::uint8_t>(data.size())};
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

std::unique_ptr<SocketCanBus> Open(SocketCanParams params = {}) {
  params.interface = Interface();
  auto bus = SocketCanBus::Open(params);
  EXPECT_TRUE(bus) << bus.error();
  return std::move(*bus);
}

void Shell(const std::string& command) { ASSERT_EQ(std::system(command.c_str()), 0) << command; }
void CanSend(const std::string& frame) { Shell("cansend " + std::string(Interface()) + " " + frame); }

// A deadline that is long enough for a busy machine.
rt::Nanoseconds Soon() { return rt::MonotonicNow() + 20 * rt::kSecond; }

// Frames received until none has come for 100 ms: a busy kernel may pass a frame on after send() returned.
std::vector<std::string> Received(SocketCanBus& bus) {
  constexpr rt::Nanoseconds kQuiet = 100 * rt::kMillisecond;
  std::vector<std::string> frames;
  for (CanArrival arrival; bus.Receive(arrival, rt::MonotonicNow() + kQuiet) == CanResult::kOk;)
    frames.push_back(ToText(arrival.frame));
  return frames;
}

// A listening candump, which ends after a given number of frames.
class Candump {
 public:
  explicit Candump(int frames) {
    const std::string command = "exec candump -L -n " + std::to_string(frames) + " -T 20000 " + Interface();
    out_ = popen(command.c_str(), "r");
    // candump listens once the kernel lists a receiver for the interface.
    for (const rt::Nanoseconds end = Soon(); rt::MonotonicNow() < end;
         rt::SleepUntil(rt::MonotonicNow() + rt::kMillisecond)) {
      std::ifstream list("/proc/net/can/rcvlist_all");
      std::stringstream text;
      text << list.rdbuf();
      if (text.str().find("(" + std::string(Interface()) + ": no entry)") == std::string::npos) return;
    }
    ADD_FAILURE() << "candump does not listen";
  }
  ~Candump() { pclose(out_); }
  Candump(const Candump&) = delete;
  Candump& operator=(const Candump&) = delete;

  // The frames that candump printed, as ID#DATA; waits until candump ends.
  std::vector<std::string> Frames() {
    std::vector<std::string> frames;
    std::array<char, 256> line{};
    while (std::fgets(line.data(), static_cast<int>(line.size()), out_) != nullptr) {
      std::stringstream words(line.data());  // (time) vcan0 123#DEADBEEF
      std::string time, interface, frame;
      words >> time >> interface >> frame;
      frames.push_back(frame);
    }
    return frames;
  }

 private:
  FILE* out_{nullptr};
};

TEST(SocketCan, CandumpSeesSentFrames) {
  const auto bus = Open({.local_loopback = true});
  Candump dump(3);
  EXPECT_EQ(bus->Send(Frame(0x64, {0x0B, 0, 0, 0, 0, 0, 0, 0})), CanResult::kOk);
  EXPECT_EQ(bus->Send(Frame(0x7FF, {0xFF})), CanResult::kOk);
  EXPECT_EQ(bus->Send(Frame(0x000, {})), CanResult::kOk);
  EXPECT_EQ(dump.Frames(), (std::vector<std::string>{"064#0B00000000000000", "7FF#FF", "000#"}));
  EXPECT_EQ(bus->status().sent, 3u);
  EXPECT_TRUE(Received(*bus).empty()) << "never our own";
}

TEST(SocketCan, ReceivesFramesOfCansend) {
  const auto bus = Open();
  const rt::Nanoseconds before = rt::MonotonicNow();
  CanSend("201#1122334455667788");
  CanSend("080#");
  CanArrival arrival;
  ASSERT_EQ(bus->Receive(arrival, Soon()), CanResult::kOk);
  EXPECT_EQ(arrival.frame, Frame(0x201, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}));
  EXPECT_FALSE(arrival.after_gap);
  // The two clocks are read one after the other: a stamp may be wrong by the time between the two readings.
  EXPECT_GT(arrival.stamp, before - rt::kSecond);
  EXPECT_LE(arrival.stamp, rt::MonotonicNow());
  ASSERT_EQ(bus->Receive(arrival, 0), CanResult::kOk);
  EXPECT_EQ(arrival.frame, Frame(0x080, {}));
  EXPECT_EQ(bus->Receive(arrival, rt::MonotonicNow() + rt::kMillisecond), CanResult::kEmpty);
}

TEST(SocketCan, KernelPassesOnlyFramesThatMatchAFilter) {
  const auto bus = Open({.filters = {{.id = 0x200, .mask = 0x7F0}, {.id = 0x001}}});
  for (const char* frame : {"001#AA", "002#AA", "1FF#AA", "200#AA", "20F#AA", "210#AA",
                            "00000201#AA",  // extended identifier (29 bits) whose last 11 bits are 201
                            "201#R"})       // remote transmission request
    CanSend(frame);
  EXPECT_EQ(Received(*bus), (std::vector<std::string>{"001#AA", "200#AA", "20F#AA"}));
  EXPECT_EQ(bus->status().rejected, 0u);
}

TEST(SocketCan, WithoutLocalLoopbackNoLocalSocketSeesASentFrame) {
  const auto quiet = Open(), loud = Open({.local_loopback = true}), listener = Open();
  EXPECT_EQ(quiet->Send(Frame(1, {})), CanResult::kOk);
  EXPECT_EQ(loud->Send(Frame(2, {})), CanResult::kOk);
  EXPECT_EQ(Received(*listener), std::vector<std::string>{"002#"});
}

TEST(SocketCan, StatusFollowsTheControllersErrorFrames) {
  const auto bus = Open();
  // Sends an error frame, which the bus must consume itself.
  const auto report = [&](const std::string& frame) {
    CanSend(frame);
    EXPECT_TRUE(Received(*bus).empty()) << "reports are no frames";
  };
  report("20000004#0004000000000000");  // CAN_ERR_CRTL: receive errors beyond the warning level
  EXPECT_TRUE(bus->status().error_warning);
  report("20000004#0020000000000000");  // CAN_ERR_CRTL: transmit errors, error passive
  EXPECT_TRUE(bus->status().error_passive);
  EXPECT_EQ(bus->Send(Frame(1, {})), CanResult::kOk);
  report("20000040#0000000000000000");  // CAN_ERR_BUSOFF
  EXPECT_TRUE(bus->status().bus_off);
  EXPECT_EQ(bus->Send(Frame(1, {})), CanResult::kDown);
  report("20000100#0000000000000000");  // CAN_ERR_RESTARTED
  EXPECT_FALSE(bus->status().bus_off || bus->status().error_passive || bus->status().error_warning);
  EXPECT_EQ(bus->Send(Frame(1, {})), CanResult::kOk);
  EXPECT_EQ(bus->status().error_frames, 4u);
  EXPECT_EQ(bus->status().unsent, 1u);
}

TEST(SocketCan, CountsFramesLostToAFullReceiveQueue) {
  const auto bus = Open(), sender = Open({.local_loopback = true});
  constexpr unsigned kFrames = 4000;
  for (unsigned i = 0; i < kFrames; ++i) ASSERT_EQ(sender->Send(Frame(1, {})), CanResult::kOk);
  const std::size_t first = Received(*bus).size();
  ASSERT_LT(first, kFrames) << "the queue must overflow for this test";
  EXPECT_EQ(bus->status().lost, 0u) << "the kernel tells with the next frame";
  ASSERT_EQ(sender->Send(Frame(2, {})), CanResult::kOk);
  CanArrival arrival;
  ASSERT_EQ(bus->TryReceive(arrival), CanResult::kOk);
  EXPECT_TRUE(arrival.after_gap);
  EXPECT_EQ(bus->status().lost, kFrames - first);
  ASSERT_EQ(sender->Send(Frame(3, {})), CanResult::kOk);
  ASSERT_EQ(bus->TryReceive(arrival), CanResult::kOk);
  EXPECT_FALSE(arrival.after_gap);
}

TEST(SocketCan, DoesNotAllocate) {
  const auto a = Open({.local_loopback = true}), b = Open({.local_loopback = true});
  CanArrival arrival;
  CanResult sent{}, received{};
  {
    rt::CheckedNoAllocScope no_alloc;
    sent = a->Send(Frame(5, {1}));
    received = b->Receive(arrival, Soon());
  }
  EXPECT_EQ(sent, CanResult::kOk);
  EXPECT_EQ(received, CanResult::kOk);
}

TEST(SocketCan, OpenErrorsNameTheInterfaceAndTheCause) {
  const auto expect_error = [](const std::string& interface, const std::string& text) {
    const auto bus = SocketCanBus::Open({.interface = interface});
    ASSERT_FALSE(bus);
    EXPECT_NE(bus.error().find("'" + interface + "'"), std::string::npos) << bus.error();
    EXPECT_NE(bus.error().find(text), std::string::npos) << bus.error();
  };
  expect_error("can77", "no such interface");
  expect_error("", "1 to 15 characters");
  expect_error("a_name_of_more_than_15", "1 to 15 characters");
  expect_error("lo", "not a CAN interface");
}

TEST(SocketCan, ReportsAnInterfaceThatGoesDownAndRecovers) {
  if (geteuid() != 0) GTEST_SKIP() << "setting an interface down needs root";
  const auto bus = Open();
  Shell("ip link set " + std::string(Interface()) + " down");
  CanArrival arrival;
  EXPECT_EQ(bus->TryReceive(arrival), CanResult::kDown);
  EXPECT_EQ(bus->Send(Frame(1, {})), CanResult::kDown);
  const auto down = SocketCanBus::Open({.interface = Interface()});
  ASSERT_FALSE(down);
  EXPECT_NE(down.error().find("the interface is down"), std::string::npos) << down.error();
  Shell("ip link set " + std::string(Interface()) + " up");
  EXPECT_EQ(bus->Send(Frame(1, {})), CanResult::kOk) << "and it comes back";
}

}  // namespace
}  // namespace osteon::io

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (osteon::io::Interface() == nullptr) {
    std::fputs("OSTEON_VCAN names no interface; see uml/run_in_uml.sh\n", stderr);
    return 2;
  }
  return RUN_ALL_TESTS();
}
