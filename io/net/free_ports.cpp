#include "io/net/free_ports.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace osteon::io {
namespace {

constexpr int kLowest = 20000, kHighest = 32000;

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
  const int range = kHighest - kLowest;
  for (int tried = 0; tried < range; tried += count) {
    const int first = kLowest + (getpid() * 8 + tried) % range;
    int free = 0;
    while (free < count && IsFree(SOCK_DGRAM, first + free) && IsFree(SOCK_STREAM, first + free)) ++free;
    if (free == count) return static_cast<std::uint16_t>(first);
  }
  return tl::make_unexpected("no " + std::to_string(count) + " free ports in a row between " +
                             std::to_string(kLowest) + " and " + std::to_string(kHighest));
}

}  // namespace osteon::io
