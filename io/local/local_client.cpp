#include "io/local/local_client.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "io/local/local_server.h"
#include "io/local/local_socket.h"

namespace osteon::io {
namespace {

constexpr std::size_t kMaxAnswer = 1u << 20;  // largest size of a server's answer [bytes]

// Connects to a server's socket. Returns 0, or errno in case of a failure.
int Connect(const LocalSocket& socket, const std::filesystem::path& path) {
  const auto address = LocalAddress(path);
  if (!address) return ENAMETOOLONG;
  if (::connect(socket.fd(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    return errno;
  return 0;
}

}  // namespace

std::vector<std::filesystem::path> FindLocalServers() {
  std::vector<std::filesystem::path> found;
  std::error_code error;
  for (const std::filesystem::path& folder : LocalSocketFolders())
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      if (entry.path().extension() != ".sock") continue;
      const LocalSocket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
      const int error_number = Connect(socket, entry.path());
      // a socket that refuses a connection was left by a process that has ended
      if (error_number == ECONNREFUSED) std::filesystem::remove(entry.path(), error);
      if (error_number == 0) found.push_back(entry.path());
    }
  std::ranges::sort(found);
  return found;
}

tl::expected<std::string, std::string> AskLocalServer(const std::filesystem::path& path,
                                                      const std::string& request) {
  const LocalSocket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (const int error = Connect(socket, path); error != 0)
    return tl::unexpected(path.string() + ": " + std::strerror(error));
  if (!WriteAll(socket.fd(), request + "\n")) return tl::unexpected(path.string() + ": takes no request");
  auto answer = ReadLine(socket.fd(), kMaxAnswer, 3 * kLocalPatience);
  if (!answer) return tl::unexpected(path.string() + ": gives no answer");
  return std::move(*answer);
}

}  // namespace osteon::io
