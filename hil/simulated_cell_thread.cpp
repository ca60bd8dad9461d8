#include "hil/simulated_cell_thread.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace osteon::hil {
namespace {

// A client owes one answer a period. More than this many datagrams in one is a flood: the rest waits for the
// next period, so that the arm keeps its time.
constexpr int kMaxDatagramsPerCycle = 64;

}  // namespace

SimulatedCellThread::SimulatedCellThread(const CellThreadParams& params, SimulatedCell cell)
    : params_(params), cell_(std::move(cell)) {
  sockaddr_in client{};
  client.sin_family = AF_INET;
  client.sin_port = htons(params.client_port);
  if (inet_pton(AF_INET, params.client_address.c_str(), &client.sin_addr) != 1)
    throw std::invalid_argument("simulated arm: client_address: found \"" + params.client_address +
                                "\", accepted a dotted IPv4 address such as 127.0.0.1");
  if (params.client_port == 0)
    throw std::invalid_argument("simulated arm: client_port: found 0, accepted 1 … 65535");

  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) throw std::system_error(errno, std::generic_category(), "simulated arm: UDP socket");
  sockaddr_in own{};
  socklen_t size = sizeof(own);
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&client), sizeof(client)) != 0 ||
      getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
    const int error = errno;
    close(socket_);
    throw std::system_error(
        error, std::generic_category(),
        "simulated arm: UDP to " + params.client_address + ":" + std::to_string(params.client_port));
  }
  port_ = ntohs(own.sin_port);
  thread_ = std::thread([this] { Run(); });
}

SimulatedCellThread::~SimulatedCellThread() { Stop(); }

void SimulatedCellThread::Stop() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
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
    const auto datagram = cell_.Step(now, on_time);
    sensor_.Store(cell_.force());  // before the message, so that who answers it finds the reading
    if (!datagram.empty() && send(socket_, datagram.data(), datagram.size(), 0) < 0) ++statistics.undelivered;
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
  for (int i = 0; i < kMaxDatagramsPerCycle; ++i) {
    const ssize_t size = recv(socket_, bytes.data(), bytes.size(), 0);
    if (size < 0) {
      if (errno == ECONNREFUSED) {  // the last message found nobody; not the end of the queue
        ++statistics.undelivered;
        continue;
      }
      if (errno == EINTR) continue;
      break;
    }
    answered |= cell_.Receive({bytes.data(), static_cast<std::size_t>(size)});
  }
  return answered;
}

}  // namespace osteon::hil
