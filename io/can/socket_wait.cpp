#include "io/can/socket_wait.h"

#include <poll.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace osteon::io {

CanResult WaitReadable(int socket, rt::Nanoseconds deadline) OSTEON_RT {
  for (;;) {
    const rt::Nanoseconds left = std::max<rt::Nanoseconds>(0, deadline - rt::MonotonicNow());
    const timespec wait{.tv_sec = left / rt::kSecond, .tv_nsec = left % rt::kSecond};
    pollfd poll_socket{.fd = socket, .events = POLLIN, .revents = 0};
    const int ready = ppoll(&poll_socket, 1, &wait, nullptr);
    if (ready > 0) return (poll_socket.revents & POLLNVAL) != 0 ? CanResult::kDown : CanResult::kOk;
    if (ready < 0 && errno != EINTR) return CanResult::kDown;
    if (rt::MonotonicNow() >= deadline) return CanResult::kEmpty;
  }
}

rt::Nanoseconds ArrivalTime(msghdr& message) OSTEON_RT {
  const rt::Nanoseconds now = rt::MonotonicNow();
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec arrived{}, real_now{};
    std::memcpy(&arrived, CMSG_DATA(part), sizeof arrived);
    clock_gettime(CLOCK_REALTIME, &real_now);
    const rt::Nanoseconds age =
        (real_now.tv_sec - arrived.tv_sec) * rt::kSecond + (real_now.tv_nsec - arrived.tv_nsec);
    if (age >= 0 && age < rt::kSecond) return now - age;
  }
  return now;
}

}  // namespace osteon::io
