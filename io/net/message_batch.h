#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/marker.h"

namespace osteon::io {

/// Whether a batch stores each message's sender.
enum class Sender : std::uint8_t { kDropped, kKept };

/// Buffers for several datagrams or raw CAN frames that are received or sent with one system call, so that a
/// tick needs one call in each direction instead of one for each message. No allocation after construction.
/// @tparam kBytes  largest message  @tparam kControl  size of a message's control data (cmsg), or 0
template <std::size_t kBytes, std::size_t kControl, Sender kSender = Sender::kDropped>
class MessageBatch {
 public:
  static constexpr std::size_t kMax = 32;  ///< largest number of messages in one call

  MessageBatch() {
    for (std::size_t i = 0; i < kMax; ++i) {
      parts_[i] = {.iov_base = bytes_[i].data(), .iov_len = kBytes};
      messages_[i].msg_hdr.msg_iov = &parts_[i];
      messages_[i].msg_hdr.msg_iovlen = 1;
      if constexpr (kSender == Sender::kKept) messages_[i].msg_hdr.msg_name = &senders_[i];
    }
  }
  MessageBatch(const MessageBatch&) = delete;
  MessageBatch& operator=(const MessageBatch&) = delete;

  /// Receives the waiting messages, at most `most` and at most kMax; never waits. @returns the number
  /// received; if negative, errno gives the reason (EAGAIN: no message waits).
  int Receive(int socket, std::size_t most) OSTEON_RT {
    if (most > kMax) most = kMax;
    // restore the first `used_` headers, which the last call changed
    for (; used_ > 0; --used_) {
      msghdr& header = messages_[used_ - 1].msg_hdr;
      if constexpr (kControl > 0) {
        header.msg_control = control_[used_ - 1].bytes.data();
        header.msg_controllen = kControl;
      }
      if constexpr (kSender == Sender::kKept) header.msg_namelen = sizeof(sockaddr_in);
    }
    const int came = recvmmsg(socket, messages_.data(), static_cast<unsigned>(most), MSG_DONTWAIT, nullptr);
    // the system may also have changed the header after that of the last received message
    used_ = came < 0 ? 1 : static_cast<std::size_t>(came) + 1;
    if (used_ > kMax) used_ = kMax;
    return came;
  }
  /// Bytes of received message i; truncated if the buffer was too small.
  [[nodiscard]] std::span<const std::uint8_t> bytes(std::size_t i) const OSTEON_RT {
    return {bytes_[i].data(), messages_[i].msg_len};
  }
  [[nodiscard]] msghdr& header(std::size_t i) OSTEON_RT { return messages_[i].msg_hdr; }
  /// Sender of an IPv4 socket's message i.
  [[nodiscard]] const sockaddr_in& sender(std::size_t i) const OSTEON_RT requires(kSender == Sender::kKept) {
    return senders_[i];
  }

  /// Buffer for the bytes of outgoing message i; SetSize sets how many of them are sent.
  [[nodiscard]] std::array<std::uint8_t, kBytes>& room(std::size_t i) OSTEON_RT { return bytes_[i]; }
  void SetSize(std::size_t i, std::size_t size) OSTEON_RT { parts_[i].iov_len = size; }

  /// Sends the first `count` messages in their order; never waits. @returns the number that the system
  /// accepted; if negative, errno says why it refused the first message.
  int Send(int socket, std::size_t count) OSTEON_RT {
    return sendmmsg(socket, messages_.data(), static_cast<unsigned>(count), MSG_DONTWAIT | MSG_NOSIGNAL);
  }

 private:
  struct alignas(cmsghdr) Control {
    std::array<char, kControl> bytes;
  };
  std::array<std::array<std::uint8_t, kBytes>, kMax> bytes_{};
  std::array<Control, kControl == 0 ? 0 : kMax> control_{};
  std::array<sockaddr_in, kSender == Sender::kKept ? kMax : 0> senders_{};
  std::array<iovec, kMax> parts_{};
  std::array<mmsghdr, kMax> messages_{};
  std::size_t used_{kMax};  // number of headers to restore before the next call
};

}  // namespace osteon::io
