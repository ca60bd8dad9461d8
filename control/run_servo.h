#pragma once

#include <atomic>

#include "control/ports.h"
#include "control/rt/duration_histogram.h"
#include "control/rt/latest_value.h"
#include "control/rt/realtime_thread.h"
#include "control/servo_loop.h"

namespace osteon::control {

/// Where an arm stands that has not begun.
struct StandingArm {
  bool known{false};
  JointArray q{};  ///< [rad]
};

struct RunServoParams {
  double deadline_s{0.005};  ///< wait for an arm message; each one missed counts toward arm stale
  double seconds{10.0};      ///< of rendering; then an orderly stop. 0: until stopped
  double give_up_s{30.0};    ///< without beginning to render, and without coming to rest after the end
  double at_rest_s{0.0};     ///< once the arm rests: so long it is still answered and recorded (RestTime)
  /// Of the calling thread. What a tick takes of the stack is some 20 KiB; the rest is for what it calls.
  rt::RealtimeThreadParams thread{
      .priority = 80, .lock_memory = true, .keep_cpus_awake = true, .prefault_stack_bytes = 256 * 1024};
  int recoveries{0};  ///< so often the loop begins again by itself: see ServoLoop::RequestRecovery
  /// Where the arm stands, written with each of its messages while the loop waits. Writer: this thread.
  rt::LatestValue<StandingArm>* standing{nullptr};
  /// Computes each tick again, see LoopRepeat; made as the first loop was, and had no tick. None: once only.
  ServoLoop* second{nullptr};
  std::atomic<double>* rendered_s{nullptr};  ///< written each tick: how much of `seconds` has been run
  const std::atomic<bool>* stop{nullptr};    ///< orderly stop where it becomes true, e.g. by a signal handler
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
  std::uint64_t unsent{0};        ///< answers that the system would not send
  int recovered{0};               ///< times that it began again
  std::uint64_t unrecorded{0};    ///< ticks that the recorder had no room for
  rt::RealtimeGrant thread;       ///< what the system granted
  rt::DurationHistogram wakeup;   ///< from ArmState::stamp, the link's time of receipt, to the loop running
  rt::DurationHistogram compute;  ///< from there to the answer sent
  /// Between messages answered in COMMANDING_ACTIVE; 1e9 / median: the servo rate.
  rt::DurationHistogram period;
};

/// Runs the loop in wall time in the calling thread, paced by the arm's messages, until the end condition;
/// then stops the arm in order and goes on answering until it rests. Allocates nothing and takes no lock
/// between its first and last tick (what the ports do is theirs). Writer of `commands`, reader of `models`.
///
/// The wake-up latency is as good as the stamp: where the link takes the kernel's time of receipt it holds
/// the scheduler's delay, where it stamps in user space only the way from there.
[[nodiscard]] RunServoResult RunServo(ServoLoop& loop, ArmLink& link, CellDevices& devices,
                                      rt::LatestValue<simulation::ContactModel>& models,
                                      rt::LatestValue<simulation::ToolCommand>& commands,
                                      TickRecorder& recorder, const RunServoParams& params);

}  // namespace osteon::control
