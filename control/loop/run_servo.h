#pragma once

#include <atomic>

#include "base/duration_histogram.h"
#include "base/latest_value.h"
#include "base/realtime_thread.h"
#include "control/loop/servo_loop.h"
#include "control/loop/simulation_port.h"
#include "control/ports.h"

namespace osteon::control {

/// Joint positions of the arm while the loop waits for motion to begin.
struct StandingArm {
  bool known{false};
  JointArray q{};  ///< [rad]
};

/// The interfaces through which a loop in wall time exchanges messages and data. References must outlive the
/// run.
struct ServoPorts {
  ArmLink& link;
  CellDevices& devices;
  SimulationPort& simulation;
  TickRecorder& recorder;
};

struct RunServoParams {
  /// longest wait for a message of the arm; after that the message counts as missed
  double deadline_s{0.005};
  double seconds{10.0};    ///< time of rendering, after which the run stops in order; 0: runs until stopped
  double give_up_s{30.0};  ///< longest wait until rendering begins, and until the arm rests at the end
  /// time for which the loop still answers and records after the arm has come to rest (RestTime)
  double at_rest_s{0.0};
  /// Set-up of the calling thread. A tick uses some 20 KiB of stack; the prefaulted stack is larger, for the
  /// functions that the tick calls.
  rt::RealtimeThreadParams thread{
      .priority = 80, .lock_memory = true, .keep_cpus_awake = true, .prefault_stack_bytes = 256 * 1024};
  int recoveries{0};  ///< largest number of automatic recoveries (ServoLoop::RequestRecovery)
  /// True: after a fault that allows a recovery, the loop waits at rest until somebody requests the recovery
  /// (ServoLoop::RequestRecovery) or a stop. This time is not counted as rendering. False: the fault ends the
  /// run.
  bool hold_at_fault{false};
  /// Receives the arm's joint positions with each message while the loop waits. Writer: this thread.
  rt::LatestValue<StandingArm>* standing{nullptr};
  /// Second loop, which computes each tick again (LoopRepeat). It must have the same parameters as the first,
  /// and must not have computed a tick yet. Null: ticks are not repeated.
  ServoLoop* second{nullptr};
  std::atomic<double>* rendered_s{nullptr};  ///< receives in each tick the time rendered so far [s]
  /// the run stops in order once this is true; e.g. set by a signal handler
  const std::atomic<bool>* stop{nullptr};
};

enum class RunEnd : std::uint8_t {
  kSeconds,      ///< RunServoParams::seconds have been rendered
  kStopFlag,     ///< RunServoParams::stop was set
  kFault,        ///< the loop stopped because of RunServoResult::faults
  kNeverActive,  ///< the arm did not reach COMMANDING_ACTIVE, or the devices were not ready, in time
  kLinkClosed,
};

struct RunServoResult {
  RunEnd end{RunEnd::kSeconds};
  safety::FaultSet faults;
  ServoStatistics statistics;
  std::uint64_t ticks{0};
  std::uint64_t unsent{0};  ///< answers that the system refused to send
  int recovered{0};         ///< number of automatic recoveries
  /// number of recoveries that somebody requested while the loop waited at a fault
  int operator_recoveries{0};
  safety::FaultSet cleared;       ///< faults that recoveries have cleared
  std::uint64_t unrecorded{0};    ///< ticks that the recorder refused because it was full
  rt::RealtimeGrant thread;       ///< settings of the thread that the system granted
  rt::DurationHistogram wakeup;   ///< time from ArmState::stamp, a message's arrival, until the loop runs
  rt::DurationHistogram compute;  ///< time from the wake-up until the answer is sent
  /// Time between messages answered in COMMANDING_ACTIVE; 1e9 / median is the servo rate [Hz].
  rt::DurationHistogram period;
};

/// Runs the loop in wall time in the calling thread, one tick for each message of the arm, until a RunEnd
/// occurs. Then stops the arm in order and answers its messages until it rests. Between the first and the
/// last tick, only the ports may allocate memory or take locks.
///
/// The measured wake-up latency depends on who sets ArmState::stamp. If the kernel sets it, the latency
/// includes the scheduler's delay; if a program sets it, the latency does not.
[[nodiscard]] RunServoResult RunServo(ServoLoop& loop, const ServoPorts& ports, const RunServoParams& params);

}  // namespace osteon::control
