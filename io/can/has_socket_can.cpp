#include "io/can/has_socket_can.h"

#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

namespace osteon::io {

bool HasSocketCan() {
  const int socket_fd = ::socket(PF_CAN, SOCK_RAW, CAN_RAW);
  if (socket_fd < 0) return false;
  ::close(socket_fd);
  return true;
}

}  // namespace osteon::io
