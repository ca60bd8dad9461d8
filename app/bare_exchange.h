#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "io/net/udp_socket.h"

namespace osteon::app {

/// What the kernel alone takes for a tick's datagrams over loopback: one call that takes a message which has
/// arrived, one that sends an answer, and nothing in between. No loop on this machine can be faster.
class BareExchange {
 public:
  /// @throws std::runtime_error where a socket can't be opened.
  BareExchange();
  ~BareExchange();
  BareExchange(const BareExchange&) = delete;
  BareExchange& operator=(const BareExchange&) = delete;

  /// One exchange. @param message, answer  sizes [bytes], at most 2000
  /// @returns the time of both calls [us]. @throws std::runtime_error where loopback loses one.
  double Time(std::size_t message, std::size_t answer);

 private:
  io::BoundUdp ours_, theirs_;
  std::array<std::uint8_t, 2000> bytes_{};
};

}  // namespace osteon::app
