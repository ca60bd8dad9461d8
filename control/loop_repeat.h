#pragma once

#include "control/ports.h"
#include "control/servo_loop.h"
#include "control/tick_record.h"
#include "simulation/contact_model.h"

namespace osteon::control {

/// The recorded tick by another loop that has had all ticks before it. `model`: what it was given.
TickRecord TickAgain(ServoLoop& loop, const TickRecord& recorded, const simulation::ContactModel& model,
                     ArmCommand& command) OSTEON_RT;

/// Each tick a second time: another loop, made with the same parameters, is given what the record says that
/// the first was given (as `osteon replay` does), shortly before the next message. Two ends in one:
///
/// - Bit for bit the same has to come out. A difference is one of the computer's (memory, heat) or a value
///   that this program takes from where it should not; what both have wrong it does not see.
/// - The next tick finds its code, tables and branches near, and is answered in half the time: a millisecond
///   is long enough for a processor that others use as well to lose them.
///
/// Sees each tick from the first on. One thread.
class LoopRepeat {
 public:
  /// @param second  has had no tick; nobody else's from here on
  explicit LoopRepeat(ServoLoop& second) : second_(second) {}

  /// A tick of the first loop, as it is recorded, and the contact model that it was given.
  void Saw(const TickRecord& record, const simulation::ContactModel& model) OSTEON_RT;

  /// A tick was seen, and is not repeated yet.
  [[nodiscard]] bool due() const OSTEON_RT { return due_; }

  /// Computes it again. False: something came out otherwise.
  [[nodiscard]] bool Repeat() OSTEON_RT;

 private:
  ServoLoop& second_;
  TickRecord first_;
  simulation::ContactModel model_;
  ArmCommand command_;
  bool due_{false};
};

/// Repeats the tick that is due, if one is, and tells the first loop of a difference.
void RepeatIfDue(ServoLoop& first, LoopRepeat& repeat) OSTEON_RT;

/// What is done shortly before a message: the tick before once more, then the message's way, so that the next
/// tick finds all of it near.
void RehearseTick(ServoLoop& first, LoopRepeat& repeat, ArmLink& link, const ArmCommand& command) OSTEON_RT;

}  // namespace osteon::control
