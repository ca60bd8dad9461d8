#include "io/net/free_ports.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace osteon::io {
namespace {

// Range of ports that is searched. It is below the ports that operating systems assign automatically.
constexpr int kMinPort = 20000, kMaxPort = 32000;

// Whether a port of the loopback interface is free. @param type  SOCK_DGRAM (UDP) or SOCK_STREAM (TCP)
bool IsFree(int type, int port) {
  const int socket = ::socket(AF_INET, type, 0);
  if (socket < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool free = bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(socket);
  return free;
}

}  // namespace

tl::expected<std::uint16_t, std::string> FindFreePorts(int count) {
  const int range = kMaxPort - kMinPort;
  for (int tried = 0; tried < range; tried += count) {
    const int first = kMinPort + (getpid() * 8 + tried) % range;
    int free = 0;
    while (free < count && IsFree(SOCK_DGRAM, first + free) && IsFree(SOCK_STREAM, first + free)) ++free;
    if (free == count) return static_cast<std::uint16_t>(first);
  }
  return tl::make_unexpected("no " + std::to_string(count) + " free ports in a row between " +
                             std::to_string(kMinPort) + " and " + std::to_string(kMaxPort));
}

}  // namespace osteon::io
