#pragma once

#include "control/loop/servo_loop.h"
#include "control/ports.h"
#include "control/tick_record.h"
#include "simulation/contact/contact_model.h"

namespace osteon::control {

/// Computes a recorded tick again on another loop that has had all ticks before it. `model`: the tick's
/// input.
TickRecord ReplayTick(ServoLoop& loop, const TickRecord& recorded, const simulation::ContactModel& model,
                      ArmCommand& command) OSTEON_RT;

/// Computes each tick a second time, shortly before the next message: another loop with the same parameters
/// gets the inputs that the record holds for the first (as `osteon replay` does). This has two purposes:
///
/// - The result has to be equal bit for bit. A difference is a fault of the computer (memory, heat) or a
/// value that the program reads from a wrong place. An error common to both loops is not detected.
/// - The caches are warm: the next tick finds its code, tables and branches there and is answered in half the
/// time. A millisecond is long enough for a shared processor to lose them.
///
/// Must be given every tick from the first on. One thread.
class LoopRepeat {
 public:
  /// @param second  has had no tick; used by nobody else from here on
  explicit LoopRepeat(ServoLoop& second) : second_(second) {}

  /// Stores a tick of the first loop, as recorded, with the contact model that it was given.
  void StoreTick(const TickRecord& record, const simulation::ContactModel& model) OSTEON_RT;

  /// Whether a stored tick has not been repeated yet.
  [[nodiscard]] bool due() const OSTEON_RT { return due_; }

  /// Repeats the stored tick. False if the result differs.
  [[nodiscard]] bool ReplayStoredTick() OSTEON_RT;

 private:
  ServoLoop& second_;
  TickRecord first_;
  simulation::ContactModel model_;
  ArmCommand command_;
  bool due_{false};
};

/// Repeats a stored tick, if any, and reports a difference to the first loop.
void ReplayIfDue(ServoLoop& first, LoopRepeat& repeat) OSTEON_RT;

/// Warms the caches shortly before a message: repeats the tick before, then runs the link's message path.
void WarmUpTick(ServoLoop& first, LoopRepeat& repeat, ArmLink& link, const ArmCommand& command) OSTEON_RT;

}  // namespace osteon::control
