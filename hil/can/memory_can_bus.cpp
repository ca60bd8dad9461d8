#include "hil/can/memory_can_bus.h"

namespace osteon::hil {

io::CanResult MemoryCanBus::Send(const io::CanFrame& frame) OSTEON_RT {
  if (!other_ || other_->count_ == other_->arrived_.size() || frame.size > frame.data.size() ||
      frame.id > io::kCanMaxId) {
    ++status_.unsent;
    return io::CanResult::kFull;
  }
  other_->arrived_[(other_->first_ + other_->count_++) % other_->arrived_.size()] = {.frame = frame,
                                                                                     .stamp = now_};
  ++status_.sent;
  return io::CanResult::kOk;
}

io::CanResult MemoryCanBus::TryReceive(io::CanArrival& arrival) OSTEON_RT {
  if (count_ == 0) return io::CanResult::kEmpty;
  arrival = arrived_[first_];
  first_ = (first_ + 1) % arrived_.size();
  --count_;
  ++status_.received;
  return io::CanResult::kOk;
}

io::CanResult MemoryCanBus::Receive(io::CanArrival& arrival, rt::Nanoseconds) OSTEON_RT {
  return TryReceive(arrival);
}

}  // namespace osteon::hil
