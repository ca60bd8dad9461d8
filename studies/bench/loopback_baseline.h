#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "io/net/udp_socket.h"

namespace osteon::studies {

/// Measures the kernel's own time for a tick's datagrams over loopback: one call receives a message that has
/// already arrived, and one call sends an answer, with no work between them. No servo loop on this machine
/// can be faster than this.
class LoopbackBaseline {
 public:
  /// @throws std::runtime_error if a socket can't be opened.
  LoopbackBaseline();
  ~LoopbackBaseline();
  LoopbackBaseline(const LoopbackBaseline&) = delete;
  LoopbackBaseline& operator=(const LoopbackBaseline&) = delete;

  /// Times one exchange. @param message, answer  sizes [bytes], at most 2000
  /// @returns the time of both calls [us]. @throws std::runtime_error if loopback loses a datagram.
  double Time(std::size_t message, std::size_t answer);

 private:
  io::BoundUdp ours_, theirs_;
  std::array<std::uint8_t, 2000> bytes_{};
};

}  // namespace osteon::studies
