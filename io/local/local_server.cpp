#include "io/local/local_server.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <utility>

#include "base/realtime_thread.h"
#include "io/local/local_socket.h"

namespace osteon::io {
namespace {

constexpr int kBacklog = 8;

// Makes the folder for this user alone. A folder of that name that somebody else has made is refused.
std::string MakeFolder(const std::filesystem::path& folder) {
  ::mkdir(folder.c_str(), 0700);
  struct stat status {};
  if (::lstat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode))
    return folder.string() + ": cannot make the folder: " + std::strerror(errno);
  if (status.st_uid != ::geteuid() || (status.st_mode & 0077) != 0)
    return folder.string() +
           ": found a folder that others may enter, accepted one of this user alone (chmod 700)";
  return "";
}

bool OfThisUser(int connection) {
  ucred peer{};
  socklen_t size = sizeof peer;
  return ::getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 &&
         (peer.uid == ::geteuid() || peer.uid == 0);
}

class Server final : public LocalServer {
 public:
  Server(std::filesystem::path path, LocalSocket socket, LocalSocket wake, LocalSocket woken,
         std::function<std::string(const std::string&)> answer)
      : path_(std::move(path)),
        socket_(std::move(socket)),
        wake_(std::move(wake)),
        woken_(std::move(woken)),
        answer_(std::move(answer)),
        thread_([this] { Run(); }) {}

  ~Server() override {
    (void)!::write(wake_.fd(), "", 1);
    thread_.join();
    ::unlink(path_.c_str());
  }

  [[nodiscard]] const std::filesystem::path& path() const override { return path_; }

 private:
  void Run() {
    rt::NameThread("local socket");
    while (true) {
      std::array<pollfd, 2> fds{pollfd{.fd = socket_.fd(), .events = POLLIN, .revents = 0},
                                pollfd{.fd = woken_.fd(), .events = POLLIN, .revents = 0}};
      if (::poll(fds.data(), fds.size(), -1) < 0 && errno != EINTR) return;
      if (fds[1].revents != 0) return;
      if (fds[0].revents == 0) continue;
      const LocalSocket connection(::accept4(socket_.fd(), nullptr, nullptr, SOCK_CLOEXEC));
      if (connection.fd() < 0 || !OfThisUser(connection.fd())) continue;
      if (const auto request = ReadLine(connection.fd(), kMaxLocalRequest, kLocalPatience))
        (void)WriteAll(connection.fd(), answer_(*request) + "\n");
    }
  }

  std::filesystem::path path_;
  LocalSocket socket_, wake_, woken_;
  std::function<std::string(const std::string&)> answer_;
  std::thread thread_;
};

}  // namespace

std::filesystem::path LocalSocketFolder() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && runtime[0] == '/') return std::filesystem::path(runtime) / "osteon";
  return std::filesystem::temp_directory_path() / ("osteon-" + std::to_string(::geteuid()));
}

tl::expected<std::unique_ptr<LocalServer>, std::string> LocalServer::Start(
    const std::string& name, std::function<std::string(const std::string& request)> answer) {
  const std::filesystem::path folder = LocalSocketFolder(), path = folder / (name + ".sock");
  const auto refuse = [&](const char* what) {
    return tl::unexpected(path.string() + ": " + what + ": " + std::strerror(errno));
  };
  if (std::string wrong = MakeFolder(folder); !wrong.empty()) return tl::unexpected(std::move(wrong));
  const auto address = LocalAddress(path);
  if (!address) return tl::unexpected(address.error());
  LocalSocket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (socket.fd() < 0) return refuse("cannot open a socket");
  ::unlink(path.c_str());  // of an earlier process with this number
  if (::bind(socket.fd(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    return refuse("cannot bind");
  if (::listen(socket.fd(), kBacklog) != 0) return refuse("cannot listen");
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return refuse("cannot make a pipe");
  return std::make_unique<Server>(path, std::move(socket), LocalSocket(pipe[1]), LocalSocket(pipe[0]),
                                  std::move(answer));
}

}  // namespace osteon::io
