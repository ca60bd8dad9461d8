#include "simulation/surface/idle_share.h"

#include <gtest/gtest.h>

namespace osteon::surface {
namespace {

constexpr rt::Nanoseconds kMs = rt::kMillisecond;

// Simulates, in virtual time, a SCHED_IDLE thread on a machine whose CPUs are idle or busy.
struct Machine {
  bool busy{false};
  rt::Nanoseconds now{0};
  rt::Nanoseconds locked{0};  // total time for which the thread held the lock without a CPU
  IdleShare share{};

  // One pass of the thread's loop, every 33 ms. `share` decides between 7 ms of work with the lock, a short
  // try without the lock, and rest.
  void Turn() {
    const auto next = share.At(now);
    if (next == IdleShare::Next::kRest) {
      now += 33 * kMs;
      return;
    }
    const rt::Nanoseconds work = next == IdleShare::Next::kTry ? IdleShare::kTryTime : 7 * kMs;
    // a busy machine gives the thread 4 ms of CPU, then none for 1.3 s
    const rt::Nanoseconds took = busy && work > 4 * kMs ? work + 1300 * kMs : work + work / 2;
    if (next == IdleShare::Next::kWork) locked += took - work;
    now += took;
    share.Ended(now, took, work);
    now += 33 * kMs - work;
  }
  void RunUntil(rt::Nanoseconds end) {
    while (now < end) Turn();
  }
};

TEST(IdleShare, KeepsWorkingWhileACpuIsIdle) {
  Machine machine;
  machine.RunUntil(10 * rt::kSecond);
  EXPECT_EQ(machine.share.At(machine.now), IdleShare::Next::kWork);
}

TEST(IdleShare, OnABusyMachineIsSuspendedWithTheLockOnlyOnce) {
  Machine machine{.busy = true};
  machine.RunUntil(60 * rt::kSecond);
  EXPECT_EQ(machine.locked, 1300 * kMs);
  EXPECT_NE(machine.share.At(machine.now), IdleShare::Next::kWork);
}

TEST(IdleShare, WorksAgainSoonAfterACpuBecomesIdle) {
  Machine machine{.busy = true};
  machine.RunUntil(20 * rt::kSecond);
  machine.busy = false;
  const rt::Nanoseconds idle_since = machine.now;
  machine.RunUntil(idle_since + IdleShare::kRestTime + 200 * kMs);
  EXPECT_EQ(machine.share.At(machine.now), IdleShare::Next::kWork);
}

TEST(IdleShare, AShortDelayDoesNotCountAsSuspension) {
  IdleShare share;
  share.Ended(100 * kMs, 15 * kMs, 1 * kMs);
  EXPECT_EQ(share.At(100 * kMs), IdleShare::Next::kWork) << "frames came between";
}

}  // namespace
}  // namespace osteon::surface
