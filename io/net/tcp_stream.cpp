#include "io/net/tcp_stream.h"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "base/clock.h"
#include "io/net/udp_socket.h"

namespace osteon::io {

tl::expected<TcpStream, std::string> TcpStream::Connect(const std::string& address, std::uint16_t port) {
  const auto place = Ipv4("server", address, port);
  if (!place) return tl::unexpected(place.error());
  TcpStream stream(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr generic{};
  static_assert(sizeof generic == sizeof(sockaddr_in));
  std::memcpy(&generic, &*place, sizeof generic);
  if (stream.socket_ < 0 || ::connect(stream.socket_, &generic, sizeof generic) != 0)
    return tl::unexpected(fmt::format("{}:{}: {}", address, port, std::strerror(errno)));
  return stream;
}

TcpStream::TcpStream(TcpStream&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), closed_(other.closed_) {}

TcpStream::~TcpStream() {
  if (socket_ >= 0) ::close(socket_);
}

bool TcpStream::Send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

std::string TcpStream::Receive(std::chrono::milliseconds patience) {
  const rt::Nanoseconds wait = std::chrono::duration_cast<std::chrono::nanoseconds>(patience).count();
  if (WaitReadable(socket_, rt::MonotonicNow() + wait) != Wait::kReady) return {};
  std::array<char, 65536> room{};
  const ssize_t size = ::recv(socket_, room.data(), room.size(), MSG_DONTWAIT);
  if (size > 0) return {room.data(), static_cast<std::size_t>(size)};
  closed_ = size == 0 || (errno != EAGAIN && errno != EINTR);
  return {};
}

void TcpStream::Kill() {
  const linger now{.l_onoff = 1, .l_linger = 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
  ::close(std::exchange(socket_, -1));
}

}  // namespace osteon::io
