// Measures the cost of a CAN bus in a tick: pumps the tunnel at 1 kHz with the frames of the cell's sensor
// and drive in a busy millisecond, alternately with one system call per frame and with one for all.
//
//     osteon_can_bench [SECONDS]
//
// Prints median, 99th percentile and maximum of one Pump for both, in ns.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "base/realtime_thread.h"
#include "io/can/can_pump.h"
#include "io/can/udp_can_bus.h"
#include "tests/bench/quantile_row.h"

namespace {

using namespace osteon;

// number of frames in a tick that includes the drive's cycle
constexpr int kFramesReceived = 5, kFramesSent = 4;

// The same bus, but with one system call per frame: it uses the loops of the base class CanBus instead of the
// tunnel's batches.
class OneByOne final : public io::CanBus {
 public:
  explicit OneByOne(io::CanBus& bus) : bus_(bus) {}
  io::CanResult Send(const io::CanFrame& frame) OSTEON_RT override { return bus_.Send(frame); }
  io::CanResult TryReceive(io::CanArrival& arrival) OSTEON_RT override { return bus_.TryReceive(arrival); }
  io::CanResult Receive(io::CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT override {
    return bus_.Receive(arrival, deadline);
  }
  [[nodiscard]] const io::CanStatus& status() const OSTEON_RT override { return bus_.status(); }

 private:
  io::CanBus& bus_;
};

// A device that accepts all frames and sends a given number of frames in each tick.
class Client final : public io::CanClient {
 public:
  void Accept(const io::CanArrival& arrival) OSTEON_RT override { seen_ += arrival.frame.data[0]; }
  bool Next(rt::Nanoseconds, io::CanFrame& frame) OSTEON_RT override {
    if (left_ == 0) return false;
    frame = {.id = 0x210, .size = 8};
    return --left_ >= 0;
  }
  void SetFramesToSend(int frames) { left_ = frames; }

 private:
  int left_{0};
  std::uint64_t seen_{0};
};

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 10.0;
  if (!(seconds >= 0.1 && seconds <= 3600.0)) {
    std::fprintf(stderr, "osteon_can_bench: SECONDS: found %s, accepted 0.1 … 3600\n", argv[1]);
    return 2;
  }
  auto pair = io::UdpCanBus::OpenPair();
  if (!pair) {
    std::fprintf(stderr, "osteon_can_bench: %s\n", pair.error().c_str());
    return 1;
  }
  io::UdpCanBus& devices = *pair->first;
  OneByOne one_by_one(*pair->second);
  io::CanPump single(one_by_one), batched(*pair->second);
  Client client;
  single.Add(client);
  batched.Add(client);
  const bool realtime = rt::SetUpRealtimeThread({.priority = 80}).realtime;
  std::vector<rt::Nanoseconds> single_ns, batched_ns;
  rt::Nanoseconds next = rt::MonotonicNow();
  const auto ticks = static_cast<long>(seconds * 1e3);
  for (long tick = 0; tick < ticks; ++tick) {
    for (int i = 0; i < kFramesReceived; ++i) devices.Send({.id = 0x101, .size = 8});
    client.SetFramesToSend(kFramesSent);
    rt::SleepUntil(next = std::max(next + rt::kMillisecond, rt::MonotonicNow()));
    const bool all_at_once = tick % 2 == 0;
    const rt::Nanoseconds begun = rt::MonotonicNow();
    (void)(all_at_once ? batched : single).Pump(begun);
    (all_at_once ? batched_ns : single_ns).push_back(rt::MonotonicNow() - begun);
    std::vector<io::CanArrival> room(kFramesSent);
    (void)devices.Drain(room);
  }
  std::printf("what,ns_p50,ns_p99,ns_max\n");
  PrintQuantiles("a call a frame", single_ns);
  PrintQuantiles("a call for all", batched_ns);
  std::printf("# %d frames come and %d go a tick, %s\n", kFramesReceived, kFramesSent,
              realtime ? "SCHED_FIFO" : "no SCHED_FIFO");
  return 0;
}
