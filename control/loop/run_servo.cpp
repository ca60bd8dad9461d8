#include "control/loop/run_servo.h"

#include <cmath>
#include <optional>

#include "base/parameter_check.h"
#include "control/loop/loop_repeat.h"
#include "control/loop/rest_time.h"

namespace osteon::control {
namespace {

// The previous tick is repeated from kRepeatsBefore until kTooLateBefore ahead of the next message [ns]. If
// the thread wakes later, the tick is not repeated before that message.
constexpr rt::Nanoseconds kRepeatsBefore = 200'000, kTooLateBefore = 60'000;

rt::Nanoseconds ToNanoseconds(double seconds) {
  return static_cast<rt::Nanoseconds>(std::llround(seconds * 1e9));
}

void Validate(const RunServoParams& params) {
  const base::ParameterCheck require("");
  require("deadline_s", params.deadline_s, 1e-4, 1.0);
  require("seconds", params.seconds, 0.0, 1e6);
  require("give_up_s", params.give_up_s, 0.01, 1e6);
  require("at_rest_s", params.at_rest_s, 0.0, 60.0);
  rt::Validate(params.thread);
}

// A run from its first tick to its end.
class ServoRun {
 public:
  ServoRun(ServoLoop& loop, const ServoPorts& ports, const RunServoParams& params)
      : loop_(loop),
        ports_(ports),
        params_(params),
        deadline_(ToNanoseconds(params.deadline_s)),
        give_up_(ToNanoseconds(params.give_up_s)),
        rest_(ToNanoseconds(params.at_rest_s)) {
    if (params.second != nullptr) repeat_.emplace(*params.second);
  }

  RunServoResult Run() {
    result_.thread = rt::SetUpRealtimeThread(params_.thread);
    give_up_at_ = rt::MonotonicNow() + give_up_;
    do {
      if (repeat_ && due_ > 0 && !ports_.link.Await(due_ - kRepeatsBefore) &&
          rt::MonotonicNow() < due_ - kTooLateBefore)
        WarmUpTick(loop_, *repeat_, ports_.link, command_);
      AnswerMessage();
      ReportStandingArm();
      MeasureTick();
      RecordTick();
    } while (!IsOver());
    result_.faults = loop_.faults();
    result_.statistics = loop_.statistics();
    return result_;
  }

 private:
  [[nodiscard]] bool has_message() const { return received_ == ReceiveResult::kOk; }

  // One tick: receives a message, computes, answers. Then passes the tool's pose to the simulation, and the
  // tick to its repetition.
  void AnswerMessage() {
    received_ = ports_.link.Receive(state_, rt::MonotonicNow() + deadline_);
    woken_ = rt::MonotonicNow();
    const CellReadings readings = ports_.devices.Exchange(loop_.cell_commands(), woken_);
    const simulation::ContactModel& model = ports_.simulation.Load();
    // The clock is read after the inputs, so that no input has a stamp in the future. Otherwise, if a virtual
    // machine's CPU stood still between clock and inputs, an input could be newer than `now`.
    const rt::Nanoseconds now = rt::MonotonicNow();
    const bool could_recover = loop_.CanRecover();
    const safety::FaultSet faults_before = loop_.faults();
    record_ = loop_.Tick(
        {.state = state_, .received = received_, .readings = readings, .model = model, .now = now}, command_);
    if (could_recover && record_.input.recover) {
      result_.cleared.Latch(faults_before);
      ++(automatic_ ? result_.recovered : result_.operator_recoveries);
      automatic_ = false;
    }
    if (has_message() && !ports_.link.Send(command_)) ++result_.unsent;
    answered_ = rt::MonotonicNow();
    ports_.simulation.Store(loop_.tool_command());
    if (repeat_) {
      ReplayIfDue(loop_, *repeat_);  // only if there was no time for it before the message
      repeat_->StoreTick(record_, model);
    }
    due_ = has_message() ? state_.stamp + ToNanoseconds(state_.period_s) : 0;
  }

  // While the loop waits for motion, stores the measured joints in RunServoParams::standing.
  void ReportStandingArm() {
    if (params_.standing && has_message() && loop_.phase() == Phase::kWaiting &&
        state_.session != SessionState::kIdle)
      params_.standing->Store({.known = true, .q = state_.q_meas});
  }

  // Records the tick's durations. A tick without a message has no wake-up time.
  void MeasureTick() {
    ++result_.ticks;
    record_.compute_ns = answered_ - woken_;
    if (!has_message()) return;
    record_.wakeup_ns = woken_ - state_.stamp;
    result_.wakeup.Add(record_.wakeup_ns);
    result_.compute.Add(record_.compute_ns);
    const bool active = state_.session == SessionState::kCommandingActive &&
                        loop_.phase() != Phase::kWaiting && loop_.phase() != Phase::kAligning;
    if (active && last_active_ >= 0) result_.period.Add(state_.stamp - last_active_);
    last_active_ = active ? state_.stamp : -1;
    if (active && active_since_ < 0) active_since_ = state_.stamp;
    if (params_.rendered_s && active_since_ >= 0)
      params_.rendered_s->store(rt::ToSeconds(state_.stamp - active_since_), std::memory_order_relaxed);
  }

  // Gives the tick to the recorder, and tells the loop if the recorder cannot keep up.
  void RecordTick() {
    const bool recorded = ports_.recorder.Push(record_);
    if (!recorded) ++result_.unrecorded;
    if (!recorded || ports_.recorder.Stalled()) loop_.ReportRecorder();
  }

  // Whether the run is over. First begins the run's end if a condition for the end holds.
  [[nodiscard]] bool IsOver() {
    if (received_ == ReceiveResult::kClosed) {
      End(RunEnd::kLinkClosed);
      return true;
    }
    if (params_.stop != nullptr && params_.stop->load(std::memory_order_relaxed)) End(RunEnd::kStopFlag);
    if (RequestsRecovery() || HoldsAtFault()) return false;
    held_at_ = -1;
    if (loop_.faults().Any()) End(RunEnd::kFault);
    if (!ending_ && (loop_.phase() == Phase::kAligning || loop_.state() == safety::CellState::kPaused))
      // the time to give up does not run during a path to the start or a pause
      give_up_at_ = woken_ + give_up_;
    if (params_.seconds > 0.0 && active_since_ >= 0 &&
        woken_ - active_since_ >= ToNanoseconds(params_.seconds))
      End(RunEnd::kSeconds);
    if (loop_.phase() == Phase::kHaptic) waits_again_ = false;
    if ((active_since_ < 0 || waits_again_) && woken_ > give_up_at_) End(RunEnd::kNeverActive);
    if (loop_.phase() == Phase::kStopped) {
      End(RunEnd::kStopFlag);
      if (rest_.IsOver(loop_.state(), woken_)) return true;
    }
    return ending_ && woken_ > give_up_at_;
  }

  // Requests an automatic recovery, if the loop can recover and recoveries are left. @returns whether it did
  [[nodiscard]] bool RequestsRecovery() {
    if (ending_ || !loop_.CanRecover() || result_.recovered >= params_.recoveries) return false;
    automatic_ = true;
    loop_.RequestRecovery();
    give_up_at_ = woken_ + give_up_;
    waits_again_ = true;
    return true;
  }

  // Whether the loop waits at a fault until somebody requests the recovery. This time is not counted as
  // rendering.
  [[nodiscard]] bool HoldsAtFault() {
    if (ending_ || !params_.hold_at_fault || !safety::AllowsRecovery(loop_.faults())) return false;
    if (held_at_ >= 0 && active_since_ >= 0) active_since_ += woken_ - held_at_;
    held_at_ = woken_;
    give_up_at_ = woken_ + give_up_;
    return true;
  }

  // Begins the end of the run, unless it has begun: requests an orderly stop and stores the reason.
  void End(RunEnd why) {
    if (ending_) return;
    ending_ = true;
    // if somebody stops a cell that waits at a fault, the run's end is still the fault
    result_.end = why == RunEnd::kStopFlag && loop_.faults().Any() ? RunEnd::kFault : why;
    loop_.RequestStop();
    give_up_at_ = rt::MonotonicNow() + give_up_;
  }

  ServoLoop& loop_;
  const ServoPorts& ports_;
  const RunServoParams& params_;
  const rt::Nanoseconds deadline_, give_up_;
  RestTime rest_;
  std::optional<LoopRepeat> repeat_;
  RunServoResult result_;

  // data of the present tick
  ArmState state_;
  ArmCommand command_;
  TickRecord record_;
  ReceiveResult received_{ReceiveResult::kTimeout};
  rt::Nanoseconds woken_{0}, answered_{0};

  rt::Nanoseconds due_{0};         // time of the next message; 0: unknown
  rt::Nanoseconds give_up_at_{0};  // time at which waiting for rendering, or for rest at the end, is given up
  // stamps of the first and the last message answered in COMMANDING_ACTIVE, except while waiting or on the
  // path; -1: none
  rt::Nanoseconds active_since_{-1}, last_active_{-1};
  // time of the previous tick that waited at a fault; -1: the loop does not wait at a fault
  rt::Nanoseconds held_at_{-1};
  bool ending_{false};       // the stop is requested
  bool waits_again_{false};  // true after an automatic recovery until the loop renders again
  bool automatic_{false};    // the pending recovery was requested automatically
};

}  // namespace

RunServoResult RunServo(ServoLoop& loop, const ServoPorts& ports, const RunServoParams& params) {
  Validate(params);
  return ServoRun(loop, ports, params).Run();
}

}  // namespace osteon::control
