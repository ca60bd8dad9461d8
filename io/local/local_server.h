#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::io {

/// Largest size of a request that a local server accepts [bytes].
inline constexpr std::size_t kMaxLocalRequest = 4096;

/// Environment variable that names the folder of the local sockets. If it is set, clients search for sockets
/// in that folder only. The service (plugin/packaging/osteon@.service) sets it.
inline constexpr const char* kLocalFolderVariable = "OSTEON_SOCKET_FOLDER";
/// Folder of the sockets of cells that run as a service. The service's group may enter it.
inline constexpr const char* kServiceSocketFolder = "/run/osteon";

/// Folder of this process's local sockets: $OSTEON_SOCKET_FOLDER if it is set, otherwise
/// $XDG_RUNTIME_DIR/osteon, otherwise osteon-UID in the folder for temporary files. No other user may enter
/// it. Exception: a folder that $OSTEON_SOCKET_FOLDER names may be open to its group (mode 750).
[[nodiscard]] std::filesystem::path LocalSocketFolder();

/// Folders in which clients search for sockets: LocalSocketFolder() and, unless $OSTEON_SOCKET_FOLDER is set,
/// kServiceSocketFolder.
[[nodiscard]] std::vector<std::filesystem::path> LocalSocketFolders();

/// Answers requests of other programs through a Unix socket. The programs must be those of the same user, of
/// root, or of the group that may enter the sockets' folder. A client connects, sends one line of at most
/// kMaxLocalRequest bytes within a second, and gets one line as the answer; then the server closes the
/// connection. A separate thread answers one request after the other, so an answer may lock a mutex without
/// delaying the tick.
class LocalServer {
 public:
  /// @param name  name of the socket in LocalSocketFolder(), without its extension, e.g. "run-4711"
  /// @param answer  function that makes the answer to a request; both are without line ends. The server's
  /// thread calls it.
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
