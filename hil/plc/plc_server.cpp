#include "hil/plc/plc_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "base/realtime_thread.h"

namespace osteon::hil {
namespace {

// largest number of simultaneous connections; further ones are refused
constexpr std::size_t kMaxClients = 4;
constexpr std::uint16_t kFirst = 970, kLast = 983;  // registers that the PLC writes
// registers that controller and guard write
constexpr std::uint16_t kControllerHeartbeat = 990, kMotionRequest = 991, kGuardHeartbeat = 992,
                        kGuardPermits = 993;

}  // namespace

PlcServer::PlcServer(const PlcServerParams& params) : params_(params), logic_(params.logic) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(params.port);
  if (inet_pton(AF_INET, params.bind_address.c_str(), &address.sin_addr) != 1)
    throw std::invalid_argument("simulated PLC: bind_address: found \"" + params.bind_address +
                                "\", accepted a dotted IPv4 address such as 127.0.0.1");
  if (params.cycle_ms < 1 || params.cycle_ms > 100)
    throw std::invalid_argument("simulated PLC: cycle_ms: found " + std::to_string(params.cycle_ms) +
                                ", accepted 1 … 100");
  const std::string place = "simulated PLC: TCP " + params.bind_address + ":" + std::to_string(params.port);
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (listener_ < 0) throw std::system_error(errno, std::generic_category(), place);
  const int on = 1;
  (void)setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  socklen_t size = sizeof address;
  if (bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) != 0 || listen(listener_, 8) != 0 ||
      getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    const int error = errno;
    close(listener_);
    throw std::system_error(error, std::generic_category(), place);
  }
  port_ = ntohs(address.sin_port);

  registers_.read = [this](std::uint16_t at) -> std::optional<std::uint16_t> {
    const PlcLogicOutputs& out = logic_.outputs();
    switch (at) {
      case 970:
        return static_cast<std::uint16_t>(shown_.mode);
      case 973:
        return shown_.brake_test_due;
      case 974:
        return out.run_permitted;
      case 977:
        return logic_.params().version;
      case 978:
        return out.emergency_stop;
      case 979:
        return static_cast<std::uint16_t>(shown_.enabling);
      case 980:
        return shown_.foot_pedal;
      case 981:
        return out.spindle_permitted;
      case 982:
        return out.power_on;
      case 983:
        return out.heartbeat;
      case kControllerHeartbeat:  // these registers return the value that was written
        return controller_heartbeat_;
      case kMotionRequest:
        return motion_request_;
      case kGuardHeartbeat:
        return guard_heartbeat_;
      case kGuardPermits:
        return guard_permits_;
      default:
        if (at < kFirst || at > kLast) return {};
        return std::uint16_t{0};
    }
  };
  registers_.writable = [](std::uint16_t at) { return at >= kControllerHeartbeat && at <= kGuardPermits; };
  registers_.write = [this](std::uint16_t at, std::uint16_t value) {
    (at == kControllerHeartbeat ? controller_heartbeat_
     : at == kMotionRequest     ? motion_request_
     : at == kGuardHeartbeat    ? guard_heartbeat_
                                : guard_permits_) = value;
  };
  thread_ = std::thread([this] { Run(); });
}

PlcServer::~PlcServer() { Stop(); }

void PlcServer::Stop() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  for (const Client& client : clients_) close(client.socket);
  clients_.clear();
  if (listener_ >= 0) close(listener_);
  listener_ = -1;
}

void PlcServer::SetPanel(const PlcPanel& panel) {
  const std::lock_guard lock(mutex_);
  panel_ = panel;
}

PlcLogicOutputs PlcServer::outputs() const {
  const std::lock_guard lock(mutex_);
  return outputs_;
}

PlcServerCounters PlcServer::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

void PlcServer::StepProgram() {
  const std::lock_guard lock(mutex_);
  shown_ = panel_;
  outputs_ = logic_.Step(rt::MonotonicNow(), {.emergency_stop = panel_.emergency_stop,
                                              .enabling = panel_.enabling,
                                              .foot_pedal = panel_.foot_pedal,
                                              .mode = panel_.mode,
                                              .reset = panel_.reset,
                                              .brake_test_due = panel_.brake_test_due,
                                              .controller_heartbeat = controller_heartbeat_,
                                              .guard_heartbeat = guard_heartbeat_,
                                              .motion_request = motion_request_ == 1,
                                              .guard_permits = guard_permits_ == 1});
}

void PlcServer::Run() {
  rt::NameThread("PLC");
  rt::RaisePriority();
  const rt::Nanoseconds cycle = params_.cycle_ms * rt::kMillisecond;
  rt::Nanoseconds due = rt::MonotonicNow();
  while (!stop_.load(std::memory_order_relaxed)) {
    const rt::Nanoseconds now = rt::MonotonicNow();
    if (now >= due) {
      if (!program_stopped_.load(std::memory_order_relaxed)) StepProgram();
      due = std::max(due + cycle, now);
    }
    if (drop_.exchange(false, std::memory_order_relaxed)) {
      for (const Client& client : clients_) close(client.socket);
      const std::lock_guard lock(mutex_);
      counters_.dropped += clients_.size();
      clients_.clear();
    }

    // wait until the next cycle, a due answer, or a client's data
    const bool hung = hung_.load(std::memory_order_relaxed);
    if (!hung) SendDueAnswers();
    std::array<pollfd, 1 + kMaxClients> waiting{};
    const std::size_t served = clients_.size();
    for (std::size_t i = 0; i < served; ++i) waiting[1 + i] = {clients_[i].socket, POLLIN, 0};
    waiting[0] = {listener_, POLLIN, 0};
    const rt::Nanoseconds wake = hung ? due : NextWake(due);
    const rt::Nanoseconds left = std::max<rt::Nanoseconds>(0, wake - rt::MonotonicNow());
    const timespec time{.tv_sec = left / rt::kSecond, .tv_nsec = left % rt::kSecond};
    if (ppoll(waiting.data(), hung ? 0 : 1 + served, &time, nullptr) <= 0 || hung) continue;
    for (std::size_t i = served; i-- > 0;) {
      if (waiting[1 + i].revents == 0 || Serve(clients_[i])) continue;
      close(clients_[i].socket);
      clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (waiting[0].revents != 0) Accept();
  }
}

void PlcServer::Accept() {
  const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (client < 0) return;
  const std::lock_guard lock(mutex_);
  if (clients_.size() == kMaxClients) {
    ++counters_.refused;
    close(client);
    return;
  }
  ++counters_.connections;
  clients_.push_back({.socket = client, .received = {}, .answers = {}});
}

// Reads the received bytes once and answers the complete requests. Returns false if the connection must be
// closed.
bool PlcServer::Serve(Client& client) {
  std::array<std::uint8_t, 2 * kModbusMaxAdu> bytes;
  const ssize_t size = recv(client.socket, bytes.data(), bytes.size(), 0);
  if (size <= 0) return size < 0 && (errno == EAGAIN || errno == EINTR);
  client.received.insert(client.received.end(), bytes.begin(), bytes.begin() + size);
  for (;;) {
    const MbapFrame frame = FrameOf(client.received);
    if (frame.state == MbapState::kIncomplete) return true;
    if (frame.state == MbapState::kBroken) {
      const std::lock_guard lock(mutex_);
      ++counters_.broken;
      return false;
    }
    const rt::Nanoseconds now = rt::MonotonicNow();
    const rt::Nanoseconds delay =
        std::max(delay_.load(std::memory_order_relaxed), delay_once_.exchange(0, std::memory_order_relaxed));
    // not before the previous answer
    const rt::Nanoseconds due =
        client.answers.empty() ? now + delay : std::max(now + delay, client.answers.back().due);
    const auto request = std::span<const std::uint8_t>(client.received).first(frame.size);
    const bool busy = busy_.load(std::memory_order_relaxed) > 0;
    if (busy) busy_.fetch_sub(1, std::memory_order_relaxed);
    client.answers.push_back(
        {.due = due, .bytes = busy ? RefuseModbus(request, kServerBusy) : AnswerModbus(request, registers_)});
    client.received.erase(client.received.begin(),
                          client.received.begin() + static_cast<std::ptrdiff_t>(frame.size));
    {
      const std::lock_guard lock(mutex_);
      ++counters_.requests;
      if (due > now) ++counters_.delayed;
    }
    if (!SendDue(client, now)) return false;
  }
}

// Sends the answers that are due. Returns false if the connection must be closed.
bool PlcServer::SendDue(Client& client, rt::Nanoseconds now) {
  while (!client.answers.empty() && client.answers.front().due <= now) {
    const std::vector<std::uint8_t> bytes = std::move(client.answers.front().bytes);
    client.answers.pop_front();
    // An answer is small. If it cannot be sent completely, the client has stopped reading.
    if (send(client.socket, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size()))
      return false;
  }
  return true;
}

void PlcServer::SendDueAnswers() {
  const rt::Nanoseconds now = rt::MonotonicNow();
  std::erase_if(clients_, [now](Client& client) {
    if (SendDue(client, now)) return false;
    close(client.socket);
    return true;
  });
}

rt::Nanoseconds PlcServer::NextWake(rt::Nanoseconds cycle_due) const {
  rt::Nanoseconds wake = cycle_due;
  for (const Client& client : clients_)
    if (!client.answers.empty()) wake = std::min(wake, client.answers.front().due);
  return wake;
}

}  // namespace osteon::hil
