#pragma once

#include <sys/un.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>

// Unix sockets for the server and the client of io/local.

namespace osteon::io {

/// Longest wait for the other side of a local socket.
inline constexpr std::chrono::milliseconds kLocalPatience{1000};

/// Owns a socket's descriptor; -1: none.
class LocalSocket {
 public:
  explicit LocalSocket(int fd = -1) : fd_(fd) {}
  ~LocalSocket();
  LocalSocket(LocalSocket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  LocalSocket& operator=(LocalSocket&&) = delete;
  LocalSocket(const LocalSocket&) = delete;
  LocalSocket& operator=(const LocalSocket&) = delete;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

/// Returns the address of a socket in the file system; an error if the path is longer than the system allows
/// (107 bytes).
[[nodiscard]] tl::expected<sockaddr_un, std::string> LocalAddress(const std::filesystem::path& path);

/// Reads a line and returns it without its line end. Returns nothing if the other side sends more than
/// `limit` bytes without a line end, closes the connection before it, or takes longer than `patience` in
/// total.
[[nodiscard]] std::optional<std::string> ReadLine(int fd, std::size_t limit,
                                                  std::chrono::milliseconds patience);

/// Writes a text. Returns false if the other side has closed the connection or accepts no data for
/// kLocalPatience.
[[nodiscard]] bool WriteAll(int fd, const std::string& text);

}  // namespace osteon::io
