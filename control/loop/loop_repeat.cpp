#include "control/loop/loop_repeat.h"

#include <cstring>

#include "control/loop/tick_input.h"

namespace osteon::control {
namespace {

// Whether two values of a type that consists of doubles without padding are equal bit for bit. A NaN is equal
// to the same NaN.
template <class T>
bool HasSameBits(const T& a, const T& b) OSTEON_RT {
  static_assert(sizeof(T) % sizeof(double) == 0);
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

TickRecord ReplayTick(ServoLoop& loop, const TickRecord& recorded, const simulation::ContactModel& model,
                      ArmCommand& command) OSTEON_RT {
  const TickInput& in = recorded.input;
  // A recording without cell states comes from a loop that needed no permission to start.
  if (recorded.cell_state != kNoCellState)
    loop.AllowStart(safety::MotionPermits(recorded.permits).Has(safety::MotionPermit::kPathChecked));
  if (in.stop) loop.RequestStop();
  if (in.recover) loop.RequestRecovery();
  if (in.pause) loop.RequestPause();
  if (in.resume) loop.RequestResume();
  if (in.has_guidance_gain) loop.RequestGuidanceGain(in.guidance_gain);
  loop.RequestTool(in.tool_index);
  if (in.has_gains) loop.RequestGains(in.gains);
  if (in.repeat_differed) loop.ReportDifference();
  if (in.recorder_stalled) loop.ReportRecorder();
  return loop.Tick({.state = ArmStateOf(recorded),
                    .received = static_cast<ReceiveResult>(in.received),
                    .readings = CellReadingsOf(in),
                    .model = model,
                    .now = in.now},
                   command);
}

void LoopRepeat::StoreTick(const TickRecord& record, const simulation::ContactModel& model) OSTEON_RT {
  first_ = record;
  model_ = model;
  due_ = true;
}

bool LoopRepeat::ReplayStoredTick() OSTEON_RT {
  due_ = false;
  const TickRecord replayed = ReplayTick(second_, first_, model_, command_);
  return replayed.cell_state == first_.cell_state && replayed.faults == first_.faults &&
         replayed.limits == first_.limits && replayed.activation_cmd == first_.activation_cmd &&
         HasSameBits(command_.q, first_.q_cmd) && HasSameBits(command_.F, first_.F_cmd_T) &&
         HasSameBits(command_.tau, first_.tau_cmd) && HasSameBits(replayed.X_WT_cmd, first_.X_WT_cmd) &&
         HasSameBits(replayed.F_coupling_T_W, first_.F_coupling_T_W) &&
         HasSameBits(replayed.v_WT_cmd_m_per_s, first_.v_WT_cmd_m_per_s) &&
         replayed.spindle_rad_per_s == first_.spindle_rad_per_s;
}

void ReplayIfDue(ServoLoop& first, LoopRepeat& repeat) OSTEON_RT {
  if (repeat.due() && !repeat.ReplayStoredTick()) first.ReportDifference();
}

void WarmUpTick(ServoLoop& first, LoopRepeat& repeat, ArmLink& link, const ArmCommand& command) OSTEON_RT {
  ReplayIfDue(first, repeat);
  link.WarmUp(command);
  first.Prefetch();
}

}  // namespace osteon::control
