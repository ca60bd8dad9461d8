#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>

#include "io/can/frame.h"

namespace osteon::hil {

/// Frames that a simulated device still has to send, oldest first. If the queue is full, new frames are
/// dropped, as in a real device's mailbox.
class FrameQueue {
 public:
  void Push(std::uint16_t id, std::initializer_list<int> bytes) noexcept {
    if (count_ == frames_.size()) return;
    io::CanFrame& frame = frames_[(first_ + count_++) % frames_.size()];
    frame = {.id = id};
    for (const int byte : bytes)
      if (frame.size < 8) frame.data[frame.size++] = static_cast<std::uint8_t>(byte);
  }
  /// Takes the oldest frame; false if there is none.
  bool Pop(io::CanFrame& frame) noexcept {
    if (count_ == 0) return false;
    frame = frames_[first_];
    first_ = (first_ + 1) % frames_.size();
    --count_;
    return true;
  }
  void Clear() noexcept { count_ = 0; }

 private:
  std::array<io::CanFrame, 64> frames_{};
  std::size_t first_{0}, count_{0};
};

}  // namespace osteon::hil
