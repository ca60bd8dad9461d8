// Measures how much time recording costs in a tick: calls Push at 1 kHz, while the writer's threads write a
// file.
//
//     osteon_record_bench [SECONDS] [FILE]
//
// Prints median, 99th percentile and maximum of Push, of the copy of the inputs into the record, and of the
// clock that measures both, in ns. Prints the growth of the file as well.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/realtime_thread.h"
#include "io/recording/recorder.h"
#include "tests/bench/quantile_row.h"
#include "tests/io/recording/recording_samples.h"

using namespace osteon;

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 10.0;
  const std::filesystem::path path =
      argc > 2 ? argv[2] : (std::filesystem::temp_directory_path() / "osteon_record_bench.mcap").string();
  if (!(seconds >= 0.1 && seconds <= 3600.0)) {
    std::fprintf(stderr, "osteon_record_bench: SECONDS: found %s, accepted 0.1 … 3600\n", argv[1]);
    return 2;
  }
  auto recorder = io::Recorder::Open({.path = path}, io::test::SomeSession());
  if (!recorder) {
    std::fprintf(stderr, "osteon_record_bench: %s\n", recorder.error().c_str());
    return 1;
  }
  const bool realtime = rt::SetUpRealtimeThread({.priority = 80}).realtime;
  const auto ticks = static_cast<std::uint64_t>(seconds * 1e3);
  std::vector<rt::Nanoseconds> push, inputs, clock;
  for (auto* times : {&push, &inputs, &clock}) times->reserve(ticks);
  simulation::FrameRecord frame = io::test::SomeFrame(4);
  rt::Nanoseconds next = rt::MonotonicNow();
  for (std::uint64_t i = 0; i < ticks; ++i) {
    control::TickRecord tick = io::test::SomeTick(i);
    control::TickInput given = tick.input;
    rt::SleepUntil(next += rt::kMillisecond);
    tick.stamp = given.now = rt::MonotonicNow();
    // t0 to t1 times the clock alone, t1 to t2 the copy of the inputs, t2 to t3 the call of Push
    const rt::Nanoseconds t0 = rt::MonotonicNow();
    const rt::Nanoseconds t1 = rt::MonotonicNow();
    tick.input = given;
    // makes the compiler complete the copy before the clock is read
    asm volatile("" ::"g"(&tick) : "memory");
    const rt::Nanoseconds t2 = rt::MonotonicNow();
    (void)(*recorder)->Push(tick);
    const rt::Nanoseconds t3 = rt::MonotonicNow();
    clock.push_back(t1 - t0);
    inputs.push_back(t2 - t1);
    push.push_back(t3 - t2);
    frame.stamp = t3;
    (void)(*recorder)->PushFrame(frame);
  }
  const auto counts = (*recorder)->Close();
  if (!counts) {
    std::fprintf(stderr, "osteon_record_bench: %s\n", counts.error().c_str());
    return 1;
  }
  std::printf("what,ns_p50,ns_p99,ns_max\n");
  PrintQuantiles("push", push);
  PrintQuantiles("inputs", inputs);
  PrintQuantiles("clock", clock);
  std::printf("# %llu ticks, %llu dropped, %s, %.0f kB/s with a frame of 4 contacts a tick\n",
              static_cast<unsigned long long>(counts->ticks),
              static_cast<unsigned long long>(counts->dropped_ticks),
              realtime ? "SCHED_FIFO" : "no SCHED_FIFO", 1e-3 * static_cast<double>(counts->bytes) / seconds);
  return 0;
}
