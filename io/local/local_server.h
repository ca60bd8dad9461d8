#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include <tl/expected.hpp>

namespace osteon::io {

/// Longest request that a local server reads.
inline constexpr std::size_t kMaxLocalRequest = 4096;

/// Folder of this user's local sockets: $XDG_RUNTIME_DIR/osteon, else osteon-UID among the temporary files.
/// Nobody else may enter it.
[[nodiscard]] std::filesystem::path LocalSocketFolder();

/// Answers requests of other programs of the same user by a Unix socket: a connection sends one line and gets
/// the answer's line, at most kMaxLocalRequest bytes and within a second; then the server closes it. A thread
/// of its own serves one connection after the other, so a request may take a lock, and never meets the tick.
class LocalServer {
 public:
  /// @param name  the socket's, within LocalSocketFolder(): "run-4711"
  /// @param answer  makes the answer to a request, both without their line ends. Called by the server's
  /// thread.
  /// @returns the error names the socket's path.
  [[nodiscard]] static tl::expected<std::unique_ptr<LocalServer>, std::string> Start(
      const std::string& name, std::function<std::string(const std::string& request)> answer);
  /// Ends the thread and removes the socket.
  virtual ~LocalServer() = default;
  LocalServer(const LocalServer&) = delete;
  LocalServer& operator=(const LocalServer&) = delete;

  [[nodiscard]] virtual const std::filesystem::path& path() const = 0;

 protected:
  LocalServer() = default;
};

}  // namespace osteon::io
