#include "hil/rsi/rsi_controller_thread.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "control/rt/clock.h"

namespace osteon::hil {
namespace {

constexpr int kMaxDatagramsPerCycle = 64;   // one is owed; the rest of a flood waits
constexpr std::size_t kMaxDatagram = 2048;  // longer ones are cut off, and so refused

}  // namespace

RsiControllerThread::RsiControllerThread(const RsiThreadParams& params, RsiController controller)
    : params_(params), controller_(std::move(controller)) {
  sockaddr_in server{};
  server.sin_family = AF_INET;
  server.sin_port = htons(params.server_port);
  if (inet_pton(AF_INET, params.server_address.c_str(), &server.sin_addr) != 1)
    throw std::invalid_argument("simulated KR: server_address: found \"" + params.server_address +
                                "\", accepted a dotted IPv4 address such as 127.0.0.1");
  if (params.server_port == 0)
    throw std::invalid_argument("simulated KR: server_port: found 0, accepted 1 … 65535");

  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) throw std::system_error(errno, std::generic_category(), "simulated KR: UDP socket");
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&server), sizeof(server)) != 0) {
    const int error = errno;
    close(socket_);
    throw std::system_error(
        error, std::generic_category(),
        "simulated KR: UDP to " + params.server_address + ":" + std::to_string(params.server_port));
  }
  thread_ = std::thread([this] { Run(); });
}

RsiControllerThread::~RsiControllerThread() { Stop(); }

void RsiControllerThread::Stop() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
}

void RsiControllerThread::Run() {
  RsiThreadStatistics statistics;
  statistics.realtime =
      params_.realtime_priority > 0 && rt::RequestRealtimePriority(params_.realtime_priority);
  const auto period = static_cast<rt::Nanoseconds>(controller_.period_s() * 1e9 + 0.5);
  rt::Nanoseconds due = rt::MonotonicNow() + period;
  while (!stop_.load(std::memory_order_relaxed)) {
    rt::SleepUntil(due);
    const rt::Nanoseconds woken = rt::MonotonicNow();
    const bool on_time = woken - due <= period / 2;
    if (!on_time) ++statistics.overruns;
    ReceiveAll(statistics);
    const auto datagram = controller_.Step();
    if (!datagram.empty() && send(socket_, datagram.data(), datagram.size(), MSG_NOSIGNAL) < 0)
      ++statistics.undelivered;
    due = (on_time ? due : woken) + period;
    statistics.controller = controller_.state();
    published_.Store(statistics);
  }
}

void RsiControllerThread::ReceiveAll(RsiThreadStatistics& statistics) {
  std::array<std::uint8_t, kMaxDatagram> bytes;
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
    controller_.Receive({bytes.data(), static_cast<std::size_t>(size)});
  }
}

}  // namespace osteon::hil
