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

/// The loop's partners in wall time: it exchanges messages and data with them. References must outlive the
/// run.
struct ServoPorts {
  ArmLink& link;
  CellDevices& devices;
  SimulationPort& simulation;
  TickRecorder& recorder;
};

struct RunServoParams {
  double deadline_s{0.005};  ///< longest wait for an arm message; later the message counts as missed
  double seconds{10.0};      ///< time of rendering, then an orderly stop; 0: until stopped
  double give_up_s{30.0};    ///< longest wait until rendering begins, and until the arm rests at the end
  double at_rest_s{0.0};     ///< time for which the arm at rest is still answered and recorded (RestTime)
  /// Set-up of the calling thread. A tick uses some 20 KiB of stack; the rest is for the functions it calls.
  rt::RealtimeThreadParams thread{
      .priority = 80, .lock_memory = true, .keep_cpus_awake = true, .prefault_stack_bytes = 256 * 1024};
  int recoveries{0};  ///< largest number of automatic recoveries (ServoLoop::RequestRecovery)
  /// After a fault that allows a recovery, the loop goes on at rest until somebody requests the recovery
  /// (ServoLoop::RequestRecovery) or a stop; the time held does not count as rendering. False: the fault ends
  /// the run.
  bool hold_at_fault{false};
  /// Receives the arm's joint positions with each message while the loop waits. Writer: this thread.
  rt::LatestValue<StandingArm>* standing{nullptr};
  /// Second loop, which computes each tick again (LoopRepeat). Made like the first; has computed no tick yet.
  /// Null: no repetition.
  ServoLoop* second{nullptr};
  std::atomic<double>* rendered_s{nullptr};  ///< receives, each tick, the time rendered so far [s]
  const std::atomic<bool>* stop{nullptr};    ///< orderly stop once true, e.g. set by a signal handler
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
  std::uint64_t unsent{0};        ///< answers that the system refused to send
  int recovered{0};               ///< number of automatic recoveries
  int operator_recoveries{0};     ///< number of recoveries that somebody requested during a hold
  safety::FaultSet cleared;       ///< faults that recoveries have cleared
  std::uint64_t unrecorded{0};    ///< ticks that the recorder refused because it was full
  rt::RealtimeGrant thread;       ///< settings of the thread that the system granted
  rt::DurationHistogram wakeup;   ///< time from ArmState::stamp, a message's arrival, until the loop runs
  rt::DurationHistogram compute;  ///< time from the wake-up until the answer is sent
  /// Time between messages answered in COMMANDING_ACTIVE; 1e9 / median is the servo rate [Hz].
  rt::DurationHistogram period;
};

/// Runs the loop in wall time in the calling thread, paced by the arm's messages, until a RunEnd occurs; then
/// stops the arm in order and keeps answering until it rests. Between first and last tick nothing is
/// allocated and no lock taken, except by the ports.
///
/// The measured wake-up latency depends on who sets ArmState::stamp: a stamp by the kernel includes the
/// scheduler's delay, a stamp taken in user space does not.
[[nodiscard]] RunServoResult RunServo(ServoLoop& loop, const ServoPorts& ports, const RunServoParams& params);

}  // namespace osteon::control
