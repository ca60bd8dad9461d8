#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/marker.h"

namespace osteon::io {

/// Whether a batch keeps each message's sender.
enum class Sender : std::uint8_t { kDropped, kKept };

/// Room for several datagrams, or raw CAN frames, that cross a socket in one system call: a tick costs one
/// call in each direction instead of one for each message. No allocation after construction.
/// @tparam kBytes  largest message  @tparam kControl  control data of a message (cmsg), or 0
template <std::size_t kBytes, std::size_t kControl, Sender kSender = Sender::kDropped>
class MessageBatch {
 public:
  static constexpr std::size_t kMax = 32;  ///< messages in one call

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

  /// Takes the waiting messages, at most `most` (and kMax); never waits. @returns how many; below 0: errno
  /// gives the reason, EAGAIN if none waits.
  int Receive(int socket, std::size_t most) OSTEON_RT {
    if (most > kMax) most = kMax;
    // restore the headers that the last call changed: the first `used_` ones
    for (; used_ > 0; --used_) {
      msghdr& header = messages_[used_ - 1].msg_hdr;
      if constexpr (kControl > 0) {
        header.msg_control = control_[used_ - 1].bytes.data();
        header.msg_controllen = kControl;
      }
      if constexpr (kSender == Sender::kKept) header.msg_namelen = sizeof(sockaddr_in);
    }
    const int came = recvmmsg(socket, messages_.data(), static_cast<unsigned>(most), MSG_DONTWAIT, nullptr);
    // the system may also have changed the header of a message that it did not take
    used_ = came < 0 ? 1 : static_cast<std::size_t>(came) + 1;
    if (used_ > kMax) used_ = kMax;
    return came;
  }
  /// Bytes of message i as received; cut if the room was too small.
  [[nodiscard]] std::span<const std::uint8_t> bytes(std::size_t i) const OSTEON_RT {
    return {bytes_[i].data(), messages_[i].msg_len};
  }
  [[nodiscard]] msghdr& header(std::size_t i) OSTEON_RT { return messages_[i].msg_hdr; }
  /// Sender of an IPv4 socket's message i.
  [[nodiscard]] const sockaddr_in& sender(std::size_t i) const OSTEON_RT requires(kSender == Sender::kKept) {
    return senders_[i];
  }

  /// Room for the bytes of outgoing message i; SetSize sets how many are sent.
  [[nodiscard]] std::array<std::uint8_t, kBytes>& room(std::size_t i) OSTEON_RT { return bytes_[i]; }
  void SetSize(std::size_t i, std::size_t size) OSTEON_RT { parts_[i].iov_len = size; }

  /// Sends the first `count` messages in their order; never waits. @returns how many the system accepted;
  /// below 0: errno says why it refused the first.
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
  std::size_t used_{kMax};  // headers to restore before the next call
};

}  // namespace osteon::io
