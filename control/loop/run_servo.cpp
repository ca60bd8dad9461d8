#include "control/loop/run_servo.h"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "control/loop/loop_repeat.h"
#include "control/loop/rest_time.h"

namespace osteon::control {
namespace {

// Times before the next message: when the tick before is repeated, and when it is too late for that.
constexpr rt::Nanoseconds kRepeatsBefore = 200'000, kTooLateBefore = 60'000;

rt::Nanoseconds ToNanoseconds(double seconds) {
  return static_cast<rt::Nanoseconds>(std::llround(seconds * 1e9));
}

void Validate(const RunServoParams& params) {
  const auto require = [](const char* name, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw std::invalid_argument(std::string(name) + ": found " + std::to_string(value) + ", accepted " +
                                  std::to_string(low) + " … " + std::to_string(high));
  };
  require("deadline_s", params.deadline_s, 1e-4, 1.0);
  require("seconds", params.seconds, 0.0, 1e6);
  require("give_up_s", params.give_up_s, 0.01, 1e6);
  require("at_rest_s", params.at_rest_s, 0.0, 60.0);
  rt::Validate(params.thread);
}

}  // namespace

RunServoResult RunServo(ServoLoop& loop, ArmLink& link, CellDevices& devices, SimulationPort& simulation,
                        TickRecorder& recorder, const RunServoParams& params) {
  Validate(params);
  RunServoResult result;
  result.thread = rt::SetUpRealtimeThread(params.thread);

  const rt::Nanoseconds deadline = ToNanoseconds(params.deadline_s);
  const rt::Nanoseconds give_up = ToNanoseconds(params.give_up_s);
  rt::Nanoseconds give_up_at = rt::MonotonicNow() + give_up;
  rt::Nanoseconds active_since = -1, last_active = -1;
  bool ending = false, waits_again = false, automatic = false;
  rt::Nanoseconds held_at = -1;  // time of the previous tick of a hold; -1: nothing is held
  RestTime rest(ToNanoseconds(params.at_rest_s));
  const auto end = [&](RunEnd why) {
    if (ending) return;
    ending = true;
    // a stop of a cell that is held at a fault does not turn the fault into an orderly end
    result.end = why == RunEnd::kStopFlag && loop.faults().Any() ? RunEnd::kFault : why;
    loop.RequestStop();
    give_up_at = rt::MonotonicNow() + give_up;
  };

  ArmState state;
  ArmCommand command;
  std::optional<LoopRepeat> repeat;
  if (params.second != nullptr) repeat.emplace(*params.second);
  rt::Nanoseconds due = 0;  // time of the next message; 0: unknown
  for (;;) {
    // repeat the tick before
    if (repeat && due > 0 && !link.Await(due - kRepeatsBefore) && rt::MonotonicNow() < due - kTooLateBefore)
      WarmUpTick(loop, *repeat, link, command);

    // one tick: receive, compute, answer
    const ReceiveResult received = link.Receive(state, rt::MonotonicNow() + deadline);
    const rt::Nanoseconds woken = rt::MonotonicNow();
    const CellReadings readings = devices.Exchange(loop.cell_commands(), woken);
    const simulation::ContactModel& model = simulation.Load();
    // after the reading: what comes while this thread stands still (a virtual machine's CPU does) is no value
    // of the future
    const rt::Nanoseconds now = rt::MonotonicNow();
    const bool could_recover = loop.CanRecover();
    const safety::FaultSet faults_before = loop.faults();
    TickRecord record = loop.Tick(state, received, readings, model, now, command);
    if (could_recover && record.input.recover) {
      result.cleared.Latch(faults_before);
      ++(automatic ? result.recovered : result.operator_recoveries);
      automatic = false;
    }
    if (received == ReceiveResult::kOk && !link.Send(command)) ++result.unsent;
    const rt::Nanoseconds answered = rt::MonotonicNow();
    simulation.Store(loop.tool_command());
    if (repeat) {
      ReplayIfDue(loop, *repeat);  // if there was no time before the message
      repeat->StoreTick(record, model);
    }
    due = received == ReceiveResult::kOk ? state.stamp + ToNanoseconds(state.period_s) : 0;

    if (params.standing && received == ReceiveResult::kOk && loop.phase() == Phase::kWaiting &&
        state.session != SessionState::kIdle)
      params.standing->Store({.known = true, .q = state.q_meas});

    // durations; only a message that arrived has a wake-up
    ++result.ticks;
    record.compute_ns = answered - woken;
    if (received == ReceiveResult::kOk) {
      record.wakeup_ns = woken - state.stamp;
      result.wakeup.Add(record.wakeup_ns);
      result.compute.Add(record.compute_ns);
      const bool active = state.session == SessionState::kCommandingActive &&
                          loop.phase() != Phase::kWaiting && loop.phase() != Phase::kAligning;
      if (active && last_active >= 0) result.period.Add(state.stamp - last_active);
      last_active = active ? state.stamp : -1;
      if (active && active_since < 0) active_since = state.stamp;
      if (params.rendered_s && active_since >= 0)
        params.rendered_s->store(rt::ToSeconds(state.stamp - active_since), std::memory_order_relaxed);
    }
    const bool recorded = recorder.Push(record);
    if (!recorded) ++result.unrecorded;
    if (!recorded || recorder.Stalled()) loop.ReportRecorder();

    // end conditions; a loop that stopped by itself has a fault
    if (received == ReceiveResult::kClosed) {
      end(RunEnd::kLinkClosed);
      break;
    }
    if (params.stop != nullptr && params.stop->load(std::memory_order_relaxed)) end(RunEnd::kStopFlag);
    if (!ending && loop.CanRecover() && result.recovered < params.recoveries) {
      automatic = true;
      loop.RequestRecovery();
      give_up_at = woken + give_up;
      waits_again = true;
      continue;
    }
    if (!ending && params.hold_at_fault && safety::AllowsRecovery(loop.faults())) {
      if (held_at >= 0 && active_since >= 0) active_since += woken - held_at;
      held_at = woken;
      give_up_at = woken + give_up;
      continue;
    }
    held_at = -1;
    if (loop.faults().Any()) end(RunEnd::kFault);
    if (!ending && (loop.phase() == Phase::kAligning || loop.state() == safety::CellState::kPaused))
      give_up_at = woken + give_up;  // aligning makes progress, and a pause is intended
    if (params.seconds > 0.0 && active_since >= 0 && woken - active_since >= ToNanoseconds(params.seconds))
      end(RunEnd::kSeconds);
    if (loop.phase() == Phase::kHaptic) waits_again = false;
    if ((active_since < 0 || waits_again) && woken > give_up_at) end(RunEnd::kNeverActive);
    if (loop.phase() == Phase::kStopped) {
      end(RunEnd::kStopFlag);
      if (rest.IsOver(loop.state(), woken)) break;
    }
    if (ending && woken > give_up_at) break;
  }
  result.faults = loop.faults();
  result.statistics = loop.statistics();
  return result;
}

}  // namespace osteon::control
