#pragma once

#include <cstddef>
#include <string>

namespace osteon::rt {

/// The highest CPU number that fits the system's masks. ReserveCpu checks which CPUs exist.
inline constexpr int kMaxCpu = 1023;

/// Settings that a thread with a deadline requests of the system. The thread runs even if a request is
/// refused; RealtimeGrant says which were granted.
struct RealtimeThreadParams {
  int priority{80};  ///< SCHED_FIFO, 1 … 99; 0: not requested
  int cpu{-1};       ///< the only CPU that the thread may run on, in the system's numbering; -1: any
  /// Keeps all pages that the process has used, or will use, in memory (mlockall). Not done if the system
  /// limits locked memory, because a later allocation could then fail.
  bool lock_memory{false};
  bool keep_cpus_awake{false};  ///< KeepCpusAwake
  /// part of the thread's stack that is brought into memory at set-up; at most 1 MiB
  std::size_t prefault_stack_bytes{0};
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const RealtimeThreadParams& params);

/// Settings that the system granted.
struct RealtimeGrant {
  bool realtime{false};  ///< SCHED_FIFO at the priority
  int cpu{-1};           ///< the CPU that the thread is pinned to; -1: it may run anywhere
  bool memory_locked{false};
  bool cpus_awake{false};
};

/// Sets the calling thread up before its first tick. Makes system calls.
RealtimeGrant SetUpRealtimeThread(const RealtimeThreadParams& params) noexcept;

/// Keeps every CPU out of deep idle states until the process ends. Writes 0 µs to /dev/cpu_dma_latency, a
/// request of the kernel's PM QoS. A core needs some 100 µs to leave a deep idle state; a virtual machine's
/// idle CPU has to wait until the host schedules it again. The request costs power. Calling it again changes
/// nothing.
/// @returns whether the request was granted. By default only root may write to the device; a udev rule can
///   change that.
/// @see Linux, Documentation/power/pm_qos_interface.rst
bool KeepCpusAwake() noexcept;

/// Sets the calling thread's name, which top, gdb and similar tools show. @param name  at most 15 bytes
void NameThread(const char* name) noexcept;

/// Raises the calling thread above every ordinary thread (SCHED_FIFO 10, below the servo thread), if the
/// system grants it. For a monitoring thread that needs only some microseconds at a time, and whose silence
/// would stop the cell.
void RaisePriority() noexcept;

/// Lowers the calling thread's priority (nice 10). For threads of displays, so that the threads that render
/// run first.
void LowerPriority() noexcept;

/// Keeps the calling thread, and every thread that it creates from now on, off a CPU that a real-time thread
/// will be pinned to. If there is only one CPU, all threads share it. Call before creating any other thread.
/// @param cpu  -1: nothing to do
/// @returns an empty string; if the system has no such CPU for this process, a text such as "found 9,
///   accepted 0 … 3".
[[nodiscard]] std::string ReserveCpu(int cpu);

}  // namespace osteon::rt
