#pragma once

#include <time.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "io/can/can_bus.h"
#include "io/can/udp_can_codec.h"
#include "io/net/message_batch.h"

namespace osteon::io {

struct UdpCanParams {
  std::string bind_address{"127.0.0.1"};  ///< IPv4 address of this end
  std::uint16_t bind_port{29536};
  /// IPv4 address of the peer. The system drops datagrams of other senders.
  std::string peer_address{"127.0.0.1"};
  std::uint16_t peer_port{29537};
  std::vector<CanFilter> filters{};  ///< frames to deliver; none: all frames
};

/// A CAN bus with two ends over UDP (tunnel), for simulated cells only. It is for kernels without CAN, and
/// for machines on which the user may not set up an interface. The datagrams' format is that of
/// udp_can_codec.h.
///
/// Frames that are out of order or received twice are counted and not delivered. The frames of a gap in the
/// sender's sequence are counted as lost, and the next frame has after_gap set. If the peer was restarted,
/// its new session starts a new sequence. If nobody listens at the other end, Send returns kFull, as on a bus
/// on which no node acknowledges. One system call receives or sends up to 32 frames.
class UdpCanBus final : public CanBus {
 public:
  /// The error names address and port, and says what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<UdpCanBus>, std::string> Open(const UdpCanParams& params);

  /// Two ends of one bus in this process, on the loopback interface, with ports that the system chooses.
  using Pair = std::pair<std::unique_ptr<UdpCanBus>, std::unique_ptr<UdpCanBus>>;
  [[nodiscard]] static tl::expected<Pair, std::string> OpenPair();

  ~UdpCanBus() override;

  CanResult Send(const CanFrame& frame) OSTEON_RT override;
  CanResult SendAll(std::span<const CanFrame> frames) OSTEON_RT override;
  CanResult TryReceive(CanArrival& arrival) OSTEON_RT override;
  CanResult ReceiveAll(std::span<CanArrival> room, std::size_t& count) OSTEON_RT override;
  CanResult Receive(CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT override;
  [[nodiscard]] const CanStatus& status() const OSTEON_RT override { return status_; }

  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  UdpCanBus(int socket, std::vector<CanFilter> filters);
  [[nodiscard]] bool AcceptDatagram(std::span<const std::uint8_t> datagram, CanArrival& arrival) OSTEON_RT;
  [[nodiscard]] bool InOrder(const UdpCanMessage& message) OSTEON_RT;
  [[nodiscard]] bool PassesFilter(const CanFrame& frame) const OSTEON_RT;

  int socket_;
  std::uint16_t port_{0};
  std::vector<CanFilter> filters_;
  CanStatus status_;
  std::uint32_t session_, sequence_{0};  // this end's session, and the sequence number of its next frame
  std::uint32_t peer_session_{0}, expected_{0};  // the peer's session, and the sequence number expected next
  bool heard_{false};                            // a frame of the peer has been received
  bool gap_{false};                              // frames were lost since the last one delivered
  MessageBatch<kUdpCanMaxDatagram, 0> out_;
  MessageBatch<kUdpCanMaxDatagram + 1, CMSG_SPACE(sizeof(timespec))>
      in_;  // one byte more than the format's maximum, to detect oversized datagrams
};

}  // namespace osteon::io
