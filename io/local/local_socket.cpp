#include "io/local/local_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace osteon::io {
namespace {

using Clock = std::chrono::steady_clock;

// Waits until the descriptor is ready for `events` (as for poll). Returns false if it is not ready at the
// time `until`.
bool Await(int fd, short events, Clock::time_point until) {
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    if (left <= 0) return false;
    pollfd ready{.fd = fd, .events = events, .revents = 0};
    const int count = ::poll(&ready, 1, static_cast<int>(left));
    if (count > 0) return true;
    if (count == 0 || errno != EINTR) return false;
  }
}

}  // namespace

LocalSocket::~LocalSocket() {
  if (fd_ >= 0) ::close(fd_);
}

tl::expected<sockaddr_un, std::string> LocalAddress(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string& text = path.native();
  if (text.size() >= sizeof address.sun_path)
    return tl::unexpected(text + ": found a path of " + std::to_string(text.size()) +
                          " bytes, accepted at most " + std::to_string(sizeof address.sun_path - 1));
  std::memcpy(address.sun_path, text.c_str(), text.size() + 1);
  return address;
}

std::optional<std::string> ReadLine(int fd, std::size_t limit, std::chrono::milliseconds patience) {
  const Clock::time_point until = Clock::now() + patience;
  std::string line;
  std::array<char, 1024> bytes{};
  while (Await(fd, POLLIN, until)) {
    const ssize_t count = ::recv(fd, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return std::nullopt;
    line.append(bytes.data(), static_cast<std::size_t>(count));
    const std::size_t end = line.find('\n');
    if (end != std::string::npos && end <= limit) return line.substr(0, end);
    if (line.size() > limit) return std::nullopt;
  }
  return std::nullopt;
}

bool WriteAll(int fd, const std::string& text) {
  const Clock::time_point until = Clock::now() + kLocalPatience;
  std::size_t sent = 0;
  while (sent < text.size()) {
    if (!Await(fd, POLLOUT, until)) return false;
    const ssize_t count = ::send(fd, text.data() + sent, text.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace osteon::io
