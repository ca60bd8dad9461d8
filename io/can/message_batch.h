#pragma once

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "control/rt/marker.h"
#include "io/can/can_bus.h"

namespace osteon::io {

/// Room for several datagrams, or raw CAN frames, that cross a socket in one system call: a tick costs a
/// bus one call each way and not one a frame. Made once; no allocation after that.
/// @tparam kBytes  of one message at most  @tparam kControl  of what the system says about it (cmsg), or 0
template <std::size_t kBytes, std::size_t kControl>
class MessageBatch {
 public:
  static constexpr std::size_t kMost = 32;

  MessageBatch() {
    for (std::size_t i = 0; i < kMost; ++i) {
      parts_[i] = {.iov_base = bytes_[i].data(), .iov_len = kBytes};
      messages_[i].msg_hdr.msg_iov = &parts_[i];
      messages_[i].msg_hdr.msg_iovlen = 1;
    }
  }
  MessageBatch(const MessageBatch&) = delete;
  MessageBatch& operator=(const MessageBatch&) = delete;

  /// Takes what waits, at most `most` (and kMost) messages; never waits itself. @returns how many; below 0:
  /// errno says why none, EAGAIN that none waits.
  int Receive(int socket, std::size_t most) OSTEON_RT {
    if (most > kMost) most = kMost;
    if constexpr (kControl > 0)
      for (std::size_t i = 0; i < most; ++i) {
        messages_[i].msg_hdr.msg_control = control_[i].bytes.data();
        messages_[i].msg_hdr.msg_controllen = kControl;
      }
    return recvmmsg(socket, messages_.data(), static_cast<unsigned>(most), MSG_DONTWAIT, nullptr);
  }
  /// Of message i as it came; cut where the room ended.
  [[nodiscard]] std::span<const std::uint8_t> bytes(std::size_t i) const OSTEON_RT {
    return {bytes_[i].data(), messages_[i].msg_len};
  }
  [[nodiscard]] msghdr& header(std::size_t i) OSTEON_RT { return messages_[i].msg_hdr; }

  /// Room of message i that is to be sent, and how much of it.
  [[nodiscard]] std::array<std::uint8_t, kBytes>& room(std::size_t i) OSTEON_RT { return bytes_[i]; }
  void SetSize(std::size_t i, std::size_t size) OSTEON_RT { parts_[i].iov_len = size; }

  /// Sends the first `count` messages in their order; never waits. @returns how many the system took; below
  /// 0: errno says why it refused the first.
  int Send(int socket, std::size_t count) OSTEON_RT {
    return sendmmsg(socket, messages_.data(), static_cast<unsigned>(count), MSG_DONTWAIT | MSG_NOSIGNAL);
  }

 private:
  struct alignas(cmsghdr) Control {
    std::array<char, kControl> bytes;
  };
  std::array<std::array<std::uint8_t, kBytes>, kMost> bytes_{};
  std::array<Control, kControl == 0 ? 0 : kMost> control_{};
  std::array<iovec, kMost> parts_{};
  std::array<mmsghdr, kMost> messages_{};
};

/// What a call that took nothing means.
enum class Taken : std::uint8_t {
  kNothing,  ///< none waits
  kDown,     ///< the bus is down
  kReport,   ///< of an earlier frame: another may wait
};

/// CanBus::ReceiveAll over a batch: as few calls as there is room, in the order of arrival.
/// @param most_skipped  messages that are no frames to be delivered, and are passed over in one call
/// @param judge  () → Taken, by errno  @param take  (message, CanArrival&) → whether it is one to be
/// delivered
template <class Batch, class Judge, class Take>
CanResult ReceiveBatches(Batch& batch, int socket, std::size_t most_skipped, std::span<CanArrival> room,
                         std::size_t& count, const Judge& judge, const Take& take) OSTEON_RT {
  count = 0;
  std::size_t left = room.size() + most_skipped;
  while (count < room.size() && left > 0) {
    const std::size_t asked = std::min({room.size() - count, left, batch.kMost});
    const int taken = batch.Receive(socket, asked);
    if (taken <= 0) {
      const Taken why = judge();
      if (why == Taken::kDown) return CanResult::kDown;
      if (why == Taken::kNothing) break;
      --left;
      continue;
    }
    const auto came = static_cast<std::size_t>(taken);
    left -= came;
    for (std::size_t i = 0; i < came; ++i)
      if (take(i, room[count])) ++count;
    if (came < asked) break;  // that was all
  }
  return count > 0 ? CanResult::kOk : CanResult::kEmpty;
}

}  // namespace osteon::io
