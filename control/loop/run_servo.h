#pragma once

#include <atomic>

#include "base/duration_histogram.h"
#include "base/latest_value.h"
#include "base/realtime_thread.h"
#include "control/loop/servo_loop.h"
#include "control/ports.h"

namespace osteon::control {

/// Joint positions of an arm while the loop waits.
struct StandingArm {
  bool known{false};
  JointArray q{};  ///< [rad]
};

struct RunServoParams {
  double deadline_s{0.005};  ///< wait for an arm message; each missed message counts toward arm stale
  double seconds{10.0};      ///< of rendering; then an orderly stop. 0: until stopped
  double give_up_s{30.0};    ///< longest wait until rendering begins, and until rest after the end
  double at_rest_s{0.0};     ///< how long the arm is still answered and recorded once it rests (RestTime)
  /// Of the calling thread. A tick uses some 20 KiB of stack; the rest is for the functions that it calls.
  rt::RealtimeThreadParams thread{
      .priority = 80, .lock_memory = true, .keep_cpus_awake = true, .prefault_stack_bytes = 256 * 1024};
  int recoveries{0};  ///< how often the loop begins again by itself: see ServoLoop::RequestRecovery
  /// Where the arm stands, written with each of its messages while the loop waits. Writer: this thread.
  rt::LatestValue<StandingArm>* standing{nullptr};
  /// Loop that computes each tick again, see LoopRepeat; made as the first loop was, and has had no tick.
  /// Null: no repetition.
  ServoLoop* second{nullptr};
  std::atomic<double>* rendered_s{nullptr};  ///< written each tick: how much of `seconds` has run
  const std::atomic<bool>* stop{nullptr};    ///< orderly stop once it becomes true, e.g. by a signal handler
};

enum class RunEnd : std::uint8_t {
  kSeconds,      ///< all seconds were run
  kStopFlag,     ///< asked to stop
  kFault,        ///< the loop stopped itself: see faults
  kNeverActive,  ///< the arm did not reach COMMANDING_ACTIVE, or the devices were not ready, in time
  kLinkClosed,
};

struct RunServoResult {
  RunEnd end{RunEnd::kSeconds};
  safety::FaultSet faults;
  ServoStatistics statistics;
  std::uint64_t ticks{0};
  std::uint64_t unsent{0};        ///< answers that the system refused to send
  int recovered{0};               ///< number of recoveries
  std::uint64_t unrecorded{0};    ///< ticks that the full recorder refused
  rt::RealtimeGrant thread;       ///< what the system granted
  rt::DurationHistogram wakeup;   ///< from ArmState::stamp, the link's time of receipt, to the running loop
  rt::DurationHistogram compute;  ///< from there to the sent answer
  /// Between messages answered in COMMANDING_ACTIVE; 1e9 / median: the servo rate.
  rt::DurationHistogram period;
};

/// Runs the loop in wall time in the calling thread, paced by the arm's messages, until the end condition;
/// then stops the arm in order and goes on answering until it rests. Allocates nothing and takes no lock
/// between its first and last tick (apart from what the ports do). Writer of `commands`, reader of `models`.
///
/// The wake-up latency depends on the stamp: a kernel time of receipt includes the scheduler's delay, a stamp
/// taken in user space does not.
[[nodiscard]] RunServoResult RunServo(ServoLoop& loop, ArmLink& link, CellDevices& devices,
                                      rt::LatestValue<simulation::ContactModel>& models,
                                      rt::LatestValue<simulation::ToolCommand>& commands,
                                      TickRecorder& recorder, const RunServoParams& params);

}  // namespace osteon::control
