#pragma once

#include <linux/can.h>
#include <time.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/can/can_bus.h"
#include "io/net/message_batch.h"

namespace osteon::io {

struct SocketCanParams {
  std::string interface { "can0" };  ///< a network interface of type CAN that is up
  std::vector<CanFilter> filters{};  ///< frames to deliver; none: all frames
  /// Whether other programs of this machine receive the sent frames (candump, a simulated device on vcan).
  /// The sending socket itself never receives them.
  bool local_loopback{false};
};

/// A bus on Linux SocketCAN: a raw socket on one interface, for classical frames with 11-bit identifiers. The
/// kernel filters out frames with 29-bit identifiers and remote requests. Reports of the CAN controller
/// (error frames) are counted and update status(). After bus-off, Send returns kDown until the controller has
/// restarted (`restart-ms`).
///
/// Stamps are the times of arrival in the kernel. Frames that do not fit in the socket's queue are counted as
/// lost, and the next frame has after_gap set. One system call receives or sends up to 32 frames.
///
/// The interface must be set up once, as root:
///
///     ip link set can0 up type can bitrate 1000000 restart-ms 100
class SocketCanBus final : public CanBus {
 public:
  /// The error names the interface and says what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<SocketCanBus>, std::string> Open(
      const SocketCanParams& params);
  ~SocketCanBus() override;

  CanResult Send(const CanFrame& frame) OSTEON_RT override;
  CanResult SendAll(std::span<const CanFrame> frames) OSTEON_RT override;
  CanResult TryReceive(CanArrival& arrival) OSTEON_RT override;
  CanResult ReceiveAll(std::span<CanArrival> room, std::size_t& count) OSTEON_RT override;
  CanResult Receive(CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT override;
  [[nodiscard]] const CanStatus& status() const OSTEON_RT override { return status_; }

 private:
  explicit SocketCanBus(int socket) : socket_(socket) {}
  // Evaluates a message of the socket. Returns true if it is a data frame, which is then in `arrival`.
  [[nodiscard]] bool AcceptFrame(std::span<const std::uint8_t> bytes, msghdr& message,
                                 CanArrival& arrival) OSTEON_RT;
  // Updates the status from a report of the CAN controller. @param data  the error frame's eight bytes
  void HandleErrorFrame(std::uint32_t error_class, const std::uint8_t* data) OSTEON_RT;

  int socket_;
  CanStatus status_;
  std::uint32_t overflow_{0};  // the kernel's counter of frames that did not fit in the socket's queue
  bool gap_{false};            // frames were lost since the last one delivered
  MessageBatch<sizeof(can_frame), 0> out_;
  MessageBatch<sizeof(can_frame), CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))> in_;
};

}  // namespace osteon::io
