#pragma once

#include <sys/un.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>

// Unix sockets, as server and client of io/local use them.

namespace osteon::io {

/// Longest wait for the other side of a local socket.
inline constexpr std::chrono::milliseconds kLocalPatience{1000};

/// Owns a descriptor; -1: none.
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

/// The address of a socket in the file system. The error: a path longer than the system takes (107 bytes).
[[nodiscard]] tl::expected<sockaddr_un, std::string> LocalAddress(const std::filesystem::path& path);

/// Reads up to a line end, which is removed. Nothing if the other side sends more than `limit` bytes without
/// one, closes before it, or takes longer than `patience` in all.
[[nodiscard]] std::optional<std::string> ReadLine(int fd, std::size_t limit,
                                                  std::chrono::milliseconds patience);

/// Writes a text. False if the other side has gone or takes nothing for kLocalPatience.
[[nodiscard]] bool WriteAll(int fd, const std::string& text);

}  // namespace osteon::io
