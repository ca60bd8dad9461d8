#include "hil/simulated_cell_thread.h"

#include <algorithm>
#include <array>
#include <utility>

namespace osteon::hil {
SimulatedCellThread::SimulatedCellThread(const CellThreadParams& params, SimulatedCell cell)
    : params_(params),
      cell_(std::move(cell)),
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
  statistics.realtime =
      params_.realtime_priority > 0 && rt::RequestRealtimePriority(params_.realtime_priority);

  const auto period = static_cast<rt::Nanoseconds>(cell_.period_s() * 1e9 + 0.5);
  const rt::Nanoseconds tolerance = period / 2;
  rt::Nanoseconds due = rt::MonotonicNow() + period;  // of the next message
  rt::Nanoseconds sent = due - period;                // the last message
  while (!stop_.load(std::memory_order_relaxed)) {
    // until the next message is due, and until the client has had a whole period, unless its answer is here
    rt::Nanoseconds target = due;
    rt::SleepUntil(target);
    rt::Nanoseconds lateness = rt::MonotonicNow() - target;
    if (!ReceiveAll(statistics) && rt::MonotonicNow() < sent + period) {
      target = sent + period;
      rt::SleepUntil(target);
      lateness = std::max(lateness, rt::MonotonicNow() - target);
      ReceiveAll(statistics);
    }
    const bool on_time = lateness <= tolerance;
    statistics.worst_wakeup_ns = std::max(statistics.worst_wakeup_ns, lateness);
    if (!on_time) ++statistics.overruns;

    const rt::Nanoseconds now = rt::MonotonicNow();
    cell_.SetPower(power_.load(std::memory_order_relaxed));
    const auto datagram = cell_.Step(now, on_time);
    loads_.Store(cell_.force());  // before the message, so that who answers it finds the reading
    if (!datagram.empty() && !client_.Send(datagram)) ++statistics.undelivered;
    sent = rt::MonotonicNow();

    due = (on_time ? target : sent) + period;
    statistics.cell = cell_.state();
    published_.Store(statistics);
  }
}

// True where the answer to the message last sent was among what came.
bool SimulatedCellThread::ReceiveAll(CellThreadStatistics& statistics) {
  std::array<std::uint8_t, kFriMaxDatagram + 1>
      bytes;  // one more, so that an oversized datagram shows as such
  bool answered = false;
  statistics.undelivered += client_.ReceiveAll(
      bytes, [&](std::span<const std::uint8_t> datagram) { answered |= cell_.Receive(datagram); });
  return answered;
}

}  // namespace osteon::hil
