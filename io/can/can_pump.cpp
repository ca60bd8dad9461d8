#include "io/can/can_pump.h"

namespace osteon::io {

CanResult CanPump::Pump(rt::Nanoseconds now) OSTEON_RT {
  CanArrival arrival;
  for (int i = 0; i < kMaxReads; ++i) {
    const CanResult result = bus_.TryReceive(arrival);
    if (result == CanResult::kDown) return result;
    if (result != CanResult::kOk) break;
    for (std::size_t c = 0; c < count_; ++c) clients_[c]->Accept(arrival);
  }
  CanFrame frame;
  for (std::size_t c = 0; c < count_; ++c) {
    for (int i = 0; i < kMaxSends && clients_[c]->Next(now, frame); ++i)
      if (bus_.Send(frame) == CanResult::kDown) return CanResult::kDown;
  }
  return CanResult::kOk;
}

}  // namespace osteon::io
