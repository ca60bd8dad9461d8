#include "hil/rsi/rsi_controller_thread.h"

#include <array>
#include <utility>

#include "control/rt/clock.h"

namespace osteon::hil {
namespace {

constexpr std::size_t kMaxDatagram = 2048;  // longer ones are cut off, and so refused

}  // namespace

RsiControllerThread::RsiControllerThread(const RsiThreadParams& params, RsiController controller)
    : params_(params),
      controller_(std::move(controller)),
      client_("simulated KR", "server", params.server_address, params.server_port) {
  thread_ = std::thread([this] { Run(); });
}

RsiControllerThread::~RsiControllerThread() { Stop(); }

void RsiControllerThread::Stop() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  client_.Close();
}

void RsiControllerThread::Run() {
  RsiThreadStatistics statistics;
  statistics.thread = rt::SetUpRealtimeThread(params_.thread);
  const auto period = static_cast<rt::Nanoseconds>(controller_.period_s() * 1e9 + 0.5);
  rt::Nanoseconds due = rt::MonotonicNow() + period;
  while (!stop_.load(std::memory_order_relaxed)) {
    rt::SleepUntil(due);
    const rt::Nanoseconds woken = rt::MonotonicNow();
    const bool on_time = woken - due <= period / 2;
    if (!on_time) ++statistics.overruns;
    ReceiveAll(statistics);
    const auto datagram = controller_.Step();
    if (!datagram.empty() && !client_.Send(datagram)) ++statistics.undelivered;
    due = (on_time ? due : woken) + period;
    statistics.controller = controller_.state();
    published_.Store(statistics);
  }
}

void RsiControllerThread::ReceiveAll(RsiThreadStatistics& statistics) {
  std::array<std::uint8_t, kMaxDatagram> bytes;
  statistics.undelivered += client_.ReceiveAll(
      bytes, [this](std::span<const std::uint8_t> datagram) { controller_.Receive(datagram); });
}

}  // namespace osteon::hil
