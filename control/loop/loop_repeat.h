#pragma once

#include "control/loop/servo_loop.h"
#include "control/ports.h"
#include "control/tick_record.h"
#include "simulation/contact/contact_model.h"

namespace osteon::control {

/// Computes a recorded tick again on another loop, which must have computed all ticks before it.
/// @param model  contact model that the recorded tick was given
TickRecord ReplayTick(ServoLoop& loop, const TickRecord& recorded, const simulation::ContactModel& model,
                      ArmCommand& command) OSTEON_RT;

/// Computes each tick a second time, shortly before the next message. A second loop with the same parameters
/// gets the inputs that the first loop has recorded, as in `osteon replay`. This has two purposes:
///
/// - Error detection: both results must be equal bit for bit. A difference means a hardware fault (memory,
///   heat) or a read of invalid memory. An error that both loops have in common is not detected.
/// - Warm caches: code, tables and branch history of the next tick are still in the processor, so that it
///   takes half the time. Without this, other programs on a shared processor may evict them within a
///   millisecond.
///
/// Every tick must be repeated, from the first on. For one thread.
class LoopRepeat {
 public:
  /// @param second  must not have computed a tick yet; must not be used elsewhere from now on
  explicit LoopRepeat(ServoLoop& second) : second_(second) {}

  /// Stores a recorded tick of the first loop, and the contact model that it was given.
  void StoreTick(const TickRecord& record, const simulation::ContactModel& model) OSTEON_RT;

  /// Whether a stored tick has not been repeated yet.
  [[nodiscard]] bool due() const OSTEON_RT { return due_; }

  /// Repeats the stored tick. @returns whether the result is the same
  [[nodiscard]] bool ReplayStoredTick() OSTEON_RT;

 private:
  ServoLoop& second_;
  TickRecord first_;
  simulation::ContactModel model_;
  ArmCommand command_;
  bool due_{false};
};

/// Repeats the stored tick if one is due, and reports a difference to the first loop.
void ReplayIfDue(ServoLoop& first, LoopRepeat& repeat) OSTEON_RT;

/// Warms the caches shortly before a message: repeats the last tick, then runs the link's message path.
void WarmUpTick(ServoLoop& first, LoopRepeat& repeat, ArmLink& link, const ArmCommand& command) OSTEON_RT;

}  // namespace osteon::control
