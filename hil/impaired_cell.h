#pragma once

#include "hil/cell_wires.h"
#include "hil/simulated_cell.h"

namespace osteon::hil {

/// A simulated cell in virtual time behind impaired wires: messages are lost, delayed or changed on the
/// wires. It is used in lockstep, like SimulatedCell. The difference: in a period, zero, one or several
/// messages reach the client, each at its own time.
///
///     ImpairedCell cell(SimulatedCell(params, script), injections);
///     for (rt::Nanoseconds now = 0; …; now += period) {
///       bool accepted = false;
///       cell.Step(now, [&](std::span<const std::uint8_t> message, rt::Nanoseconds arrival) {
///         accepted |= session.Accept(message, arrival, state) == io::FriAccept::kAccepted;
///       });
///       loop.Tick(…);                            // a timeout if nothing was accepted
///       if (accepted) cell.Receive(session.Answer(command));
///     }
///
/// Without injections every byte and every time is the same as without the wires.
class ImpairedCell {
 public:
  /// @throws std::invalid_argument from Validate(injections).
  ImpairedCell(SimulatedCell cell, const InjectionParams& injections);

  /// Advances the cell by one period, then calls deliver(message, arrival) for each message that reaches the
  /// client before the next period. A message's span is valid during the call.
  template <class Deliver>
  void Step(rt::Nanoseconds now, Deliver&& deliver) {
    StepCell(now);
    // time of the client's tick if no message arrives: the end of the period
    client_time_ = now + period_ - 1;
    const rt::Nanoseconds end = client_time_;
    for (rt::Nanoseconds due = wires_.to_controller.NextDue(); due <= end;
         due = wires_.to_controller.NextDue()) {
      client_time_ = due;
      deliver(wires_.to_controller.Next(due), due);
    }
  }

  /// Sends the client's answer to the newest message to the cell. An empty answer is ignored.
  void Receive(std::span<const std::uint8_t> answer) {
    if (!answer.empty()) wires_.from_controller.Push(answer, client_time_);
  }

  [[nodiscard]] const CellState& state() const { return cell_.state(); }
  [[nodiscard]] SimulatedCell& cell() { return cell_; }
  [[nodiscard]] double period_s() const { return cell_.period_s(); }
  [[nodiscard]] CellWireCounters counters() const { return wires_.counters(); }

 private:
  void StepCell(rt::Nanoseconds now);

  SimulatedCell cell_;
  CellWires wires_;
  rt::Nanoseconds period_;
  rt::Nanoseconds client_time_{0};  // time of the client's present tick
};

}  // namespace osteon::hil
