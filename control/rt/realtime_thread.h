#pragma once

#include <cstddef>
#include <string>

namespace osteon::rt {

/// The highest CPU's number that the system's masks have room for. Which there are, ReserveCpu says.
inline constexpr int kMostCpu = 1023;

/// What a thread with a deadline asks of the system. Whatever is refused is missing in RealtimeGrant; the
/// thread runs all the same.
struct RealtimeThreadParams {
  int priority{80};  ///< SCHED_FIFO, 1 … 99; 0: do not ask
  int cpu{-1};       ///< the only one that it may run on, as the system numbers them; -1: any
  /// The whole process keeps in memory what it has touched, now and later (mlockall). Only where there is no
  /// limit on it: below one, a later allocation would fail.
  bool lock_memory{false};
  bool keep_cpus_awake{false};          ///< KeepCpusAwake
  std::size_t prefault_stack_bytes{0};  ///< of the thread's stack, touched now and not in a tick; 1 MiB most
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const RealtimeThreadParams& params);

/// What was granted.
struct RealtimeGrant {
  bool realtime{false};  ///< SCHED_FIFO at the priority
  int cpu{-1};           ///< pinned to this one; -1: it may run anywhere
  bool memory_locked{false};
  bool cpus_awake{false};
};

/// Sets the calling thread up, before its first tick: system calls.
RealtimeGrant SetUpRealtimeThread(const RealtimeThreadParams& params) noexcept;

/// Until the process ends no CPU goes into an idle state that it takes time to leave: the kernel's PM QoS
/// request /dev/cpu_dma_latency, at 0 µs. A core takes some 100 µs out of a deep one, a virtual machine's CPU
/// a turn of its host. It costs power. Calling it again changes nothing.
/// @returns whether it was granted: the device is root's where no udev rule says otherwise
/// @see Linux, Documentation/power/pm_qos_interface.rst
bool KeepCpusAwake() noexcept;

/// Names the calling thread, for whoever looks at the process from outside. @param name  15 bytes at most
void NameThread(const char* name) noexcept;

/// Keeps the calling thread, and every thread that it makes from now on, off a CPU that a real-time thread
/// will be pinned to. Where it is the only one, all share it. To be called before any other thread is made.
/// @param cpu  -1: nothing to do
/// @returns an empty string, or, where the system has no such CPU for this process, "found 9, accepted 0 …
/// 3".
[[nodiscard]] std::string ReserveCpu(int cpu);

}  // namespace osteon::rt
