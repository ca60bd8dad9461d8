#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::io {

/// Longest request that a local server reads.
inline constexpr std::size_t kMaxLocalRequest = 4096;

/// Environment variable that names the folder of the local sockets. If it is set, requests look for sockets
/// in that folder alone. The service (plugin/packaging/osteon@.service) sets it.
inline constexpr const char* kLocalFolderVariable = "OSTEON_SOCKET_FOLDER";
/// Folder of the sockets of cells that run as a service. The service's group may enter it.
inline constexpr const char* kServiceSocketFolder = "/run/osteon";

/// Folder of this process's local sockets: $OSTEON_SOCKET_FOLDER, else $XDG_RUNTIME_DIR/osteon, else
/// osteon-UID among the temporary files. No other user may enter it, except that a folder which
/// $OSTEON_SOCKET_FOLDER names may be open to its group (mode 750).
[[nodiscard]] std::filesystem::path LocalSocketFolder();

/// Folders in which requests look for sockets: LocalSocketFolder() and, unless $OSTEON_SOCKET_FOLDER is set,
/// kServiceSocketFolder.
[[nodiscard]] std::vector<std::filesystem::path> LocalSocketFolders();

/// Answers requests of other programs of the same user, of root, and of the group that may enter the sockets'
/// folder, by a Unix socket: a client connects, sends one line of at most kMaxLocalRequest bytes within a
/// second, and gets one line as the answer; then the server closes the connection. A thread of its own
/// answers one request after the other, so answering may take a lock, and never delays the tick.
class LocalServer {
 public:
  /// @param name  of the socket in LocalSocketFolder(), without its ending: "run-4711"
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
