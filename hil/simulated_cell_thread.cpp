#include "hil/simulated_cell_thread.h"

#include <algorithm>
#include <array>
#include <utility>

namespace osteon::hil {
SimulatedCellThread::SimulatedCellThread(const CellThreadParams& params, SimulatedCell cell)
    : params_(params),
      cell_(std::move(cell)),
      wires_(params.injections),
      client_("simulated arm", "client", params.client_address, params.client_port) {
  thread_ = std::thread([this] { Run(); });
}

SimulatedCellThread::~SimulatedCellThread() { Stop(); }

void SimulatedCellThread::Stop() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  client_.Close();
}

void SimulatedCellThread::Run() {
  CellThreadStatistics statistics;
  statistics.thread = rt::SetUpRealtimeThread(params_.thread);

  const auto period = static_cast<rt::Nanoseconds>(cell_.period_s() * 1e9 + 0.5);
  const rt::Nanoseconds tolerance = period / 2;
  rt::Nanoseconds due = rt::MonotonicNow() + period;  // time at which the next message must be sent
  rt::Nanoseconds sent = due - period;                // time at which the last message was sent
  for (bool is_ending = false;;) {
    if (!is_ending && stop_.load(std::memory_order_relaxed)) {
      if (!cell_.EndSession()) break;
      is_ending = true;
    }
    // Wait until the next message is due. If the client's answer is still missing, also wait until the client
    // has had a whole period.
    rt::Nanoseconds target = due;
    WaitUntil(target, statistics);
    rt::Nanoseconds lateness = rt::MonotonicNow() - target;
    if (!ReceiveAll(statistics) && rt::MonotonicNow() < sent + period) {
      target = sent + period;
      WaitUntil(target, statistics);
      lateness = std::max(lateness, rt::MonotonicNow() - target);
      ReceiveAll(statistics);
    }
    const bool on_time = lateness <= tolerance;
    statistics.worst_wakeup_ns = std::max(statistics.worst_wakeup_ns, lateness);
    if (!on_time) ++statistics.overruns;

    const rt::Nanoseconds now = rt::MonotonicNow();
    cell_.SetPower(power_.load(std::memory_order_relaxed));
    const auto datagram = cell_.Step(now, on_time);
    // stored before the message is sent, so that the load is available when the client answers
    loads_.Store(cell_.force());
    answered_ = false;
    if (cell_.state().active_once) {
      wires_.StartSchedule(now);
      commanded_.store(true, std::memory_order_relaxed);
    }
    if (!datagram.empty()) wires_.to_controller.Push(datagram, now);
    MoveDue(rt::MonotonicNow(), statistics);
    sent = rt::MonotonicNow();

    due = (on_time ? target : sent) + period;
    statistics.cell = cell_.state();
    statistics.wires = wires_.counters();
    published_.Store(statistics);
    if (params_.cycles) params_.cycles->Push(statistics.cell);
    if (is_ending && datagram.empty()) break;
  }
}

// Sleeps until `target`. With injections, also moves datagrams that become due in this time.
void SimulatedCellThread::WaitUntil(rt::Nanoseconds target, CellThreadStatistics& statistics) {
  if (!wires_.injects()) {
    rt::SleepUntil(target);
    return;
  }
  while (rt::MonotonicNow() < target) {
    const rt::Nanoseconds due =
        std::min({wires_.to_controller.NextDue(), wires_.from_controller.NextDue(), target});
    client_.WaitUntil(due);
    ReceiveAll(statistics);
  }
}

// Passes all received datagrams on. Returns true if the answer to the message last sent has arrived.
bool SimulatedCellThread::ReceiveAll(CellThreadStatistics& statistics) {
  std::array<std::uint8_t, kFriMaxDatagram + 1> bytes;  // one more byte, to detect an oversized datagram
  const rt::Nanoseconds now = rt::MonotonicNow();
  statistics.undelivered += client_.ReceiveAll(
      bytes, [&](std::span<const std::uint8_t> datagram) { wires_.from_controller.Push(datagram, now); });
  MoveDue(now, statistics);
  return answered_;
}

// Takes due datagrams out of the impaired wires: sends messages to the client, and passes answers to the arm.
void SimulatedCellThread::MoveDue(rt::Nanoseconds now, CellThreadStatistics& statistics) {
  while (wires_.to_controller.NextDue() <= now)
    if (!client_.Send(wires_.to_controller.Next(now))) ++statistics.undelivered;
  while (wires_.from_controller.NextDue() <= now)
    answered_ |= cell_.Receive(wires_.from_controller.Next(now));
}

}  // namespace osteon::hil
