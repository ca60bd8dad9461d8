#include "io/local/local_server.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <list>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "base/realtime_thread.h"
#include "io/local/local_socket.h"

namespace osteon::io {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kBacklog = 64;  // largest number of connections that wait to be accepted
// largest number of simultaneous clients; a further client replaces the oldest one
constexpr std::size_t kMaxClients = 16;

// A connection whose request is not complete yet.
struct Client {
  LocalSocket socket;
  std::string received;
  Clock::time_point until;  // the connection is closed at this time
};

// Returns the absolute path in an environment variable; empty if the variable is not set or contains no
// absolute path.
std::filesystem::path FolderOf(const char* variable) {
  const char* folder = std::getenv(variable);
  return folder != nullptr && folder[0] == '/' ? std::filesystem::path(folder) : std::filesystem::path();
}

// Creates the folder for this user only, unless it exists. Refuses a folder of another user, or one that
// other users may enter.
// @param[out] group  the group that may send requests: set if $OSTEON_SOCKET_FOLDER names the folder and its
// group may enter it  @returns why the folder is refused; empty if it is accepted
std::string MakeFolder(const std::filesystem::path& folder, std::optional<gid_t>& group) {
  ::mkdir(folder.c_str(), 0700);
  struct stat status {};
  if (::lstat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode))
    return folder.string() + ": cannot make the folder: " + std::strerror(errno);
  const bool named = !FolderOf(kLocalFolderVariable).empty();
  if (status.st_uid != ::geteuid() || (status.st_mode & (named ? 0027u : 0077u)) != 0)
    return folder.string() + ": found a folder that others may enter, accepted one of this user alone (" +
           (named ? "chmod 700, or 750 for its group)" : "chmod 700)");
  if ((status.st_mode & S_IXGRP) != 0) group = status.st_gid;
  return "";
}

// Whether the process at the other end has the group as its primary or as a supplementary group.
bool IsMember(int connection, const ucred& peer, gid_t group) {
  std::array<gid_t, 1024> groups{};
  socklen_t size = sizeof groups;
  if (peer.gid == group) return true;
  if (::getsockopt(connection, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size) != 0) return false;
  const auto end = groups.begin() + static_cast<std::ptrdiff_t>(size / sizeof(gid_t));
  return std::find(groups.begin(), end, group) != end;
}

// Whether the other side is this user, root, or a member of the group that may send requests.
bool MayAsk(int connection, std::optional<gid_t> group) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return false;
  return peer.uid == ::geteuid() || peer.uid == 0 || (group && IsMember(connection, peer, *group));
}

class Server final : public LocalServer {
 public:
  Server(std::filesystem::path path, std::optional<gid_t> group, LocalSocket socket, LocalSocket wake,
         LocalSocket woken, std::function<std::string(const std::string&)> answer)
      : path_(std::move(path)),
        group_(group),
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
  // The thread's function: serves clients until the destructor writes into the pipe.
  void Run() {
    rt::NameThread("local socket");
    std::vector<pollfd> ready;
    while (true) {
      ready = {{.fd = woken_.fd(), .events = POLLIN, .revents = 0},
               {.fd = socket_.fd(), .events = POLLIN, .revents = 0}};
      for (const Client& client : clients_)
        ready.push_back({.fd = client.socket.fd(), .events = POLLIN, .revents = 0});
      if (::poll(ready.data(), ready.size(), Wait_ms()) < 0 && errno != EINTR) return;
      if (ready[0].revents != 0) return;
      std::size_t i = 2;  // the first two entries are the pipe and the listening socket
      for (auto client = clients_.begin(); client != clients_.end(); ++i) {
        const bool done = (ready[i].revents != 0 && Serve(*client)) || Clock::now() >= client->until;
        client = done ? clients_.erase(client) : std::next(client);
      }
      if (ready[1].revents != 0) Accept();
    }
  }

  // Time until the connection of the oldest client (the first in the list) is closed; -1: there is no client.
  [[nodiscard]] int Wait_ms() const {
    if (clients_.empty()) return -1;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(clients_.front().until - Clock::now());
    return static_cast<int>(std::max<std::int64_t>(0, left.count()));
  }

  // Accepts a waiting connection, unless its process may not send requests.
  void Accept() {
    LocalSocket connection(::accept4(socket_.fd(), nullptr, nullptr, SOCK_CLOEXEC));
    if (connection.fd() < 0 || !MayAsk(connection.fd(), group_)) return;
    if (clients_.size() == kMaxClients) clients_.pop_front();
    clients_.push_back(
        {.socket = std::move(connection), .received = {}, .until = Clock::now() + kLocalPatience});
  }

  // Reads the bytes that a client has sent, and answers its request once that is complete.
  // @returns whether the connection is over
  bool Serve(Client& client) {
    std::array<char, 1024> bytes{};
    const ssize_t count = ::recv(client.socket.fd(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return false;
    if (count <= 0) return true;
    client.received.append(bytes.data(), static_cast<std::size_t>(count));
    const std::size_t end = client.received.find('\n');
    if (end == std::string::npos) return client.received.size() > kMaxLocalRequest;
    if (end <= kMaxLocalRequest)
      (void)WriteAll(client.socket.fd(), answer_(client.received.substr(0, end)) + "\n");
    return true;
  }

  std::filesystem::path path_;
  std::optional<gid_t> group_;
  LocalSocket socket_;  // the listening socket
  // ends of a pipe for writing and for reading: a byte in the pipe ends the thread
  LocalSocket wake_, woken_;
  std::function<std::string(const std::string&)> answer_;
  std::list<Client> clients_;
  std::thread thread_;
};

}  // namespace

std::vector<std::filesystem::path> LocalSocketFolders() {
  std::vector<std::filesystem::path> folders{LocalSocketFolder()};
  if (FolderOf(kLocalFolderVariable).empty() && folders.front() != kServiceSocketFolder)
    folders.emplace_back(kServiceSocketFolder);
  return folders;
}

std::filesystem::path LocalSocketFolder() {
  if (auto named = FolderOf(kLocalFolderVariable); !named.empty()) return named;
  if (const auto runtime = FolderOf("XDG_RUNTIME_DIR"); !runtime.empty()) return runtime / "osteon";
  return std::filesystem::temp_directory_path() / ("osteon-" + std::to_string(::geteuid()));
}

tl::expected<std::unique_ptr<LocalServer>, std::string> LocalServer::Start(
    const std::string& name, std::function<std::string(const std::string& request)> answer) {
  const std::filesystem::path folder = LocalSocketFolder(), path = folder / (name + ".sock");
  const auto refuse = [&](const char* what) {
    return tl::unexpected(path.string() + ": " + what + ": " + std::strerror(errno));
  };
  std::optional<gid_t> group;
  if (std::string wrong = MakeFolder(folder, group); !wrong.empty()) return tl::unexpected(std::move(wrong));
  const auto address = LocalAddress(path);
  if (!address) return tl::unexpected(address.error());
  LocalSocket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (socket.fd() < 0) return refuse("cannot open a socket");
  ::unlink(path.c_str());  // an earlier process with the same process id may have left a socket
  if (::bind(socket.fd(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    return refuse("cannot bind");
  if (::chmod(path.c_str(), group ? 0660 : 0600) != 0) return refuse("cannot set its rights");
  if (::listen(socket.fd(), kBacklog) != 0) return refuse("cannot listen");
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return refuse("cannot make a pipe");
  return std::make_unique<Server>(path, group, std::move(socket), LocalSocket(pipe[1]), LocalSocket(pipe[0]),
                                  std::move(answer));
}

}  // namespace osteon::io
