#include "io/can/can_pump.h"

#include <span>

namespace osteon::io {

CanResult CanPump::Pump(rt::Nanoseconds now) OSTEON_RT {
  std::size_t received_count = 0;
  const CanResult received = bus_.ReceiveAll(arrived_, received_count);
  for (std::size_t i = 0; i < received_count; ++i)
    for (std::size_t c = 0; c < count_; ++c) clients_[c]->Accept(arrived_[i]);
  if (received == CanResult::kDown) return received;

  std::size_t due_count = 0;  // frames that the clients want to send now
  for (std::size_t c = 0; c < count_; ++c)
    for (std::size_t i = 0; i < kMaxSends && clients_[c]->Next(now, due_[due_count]); ++i) ++due_count;
  if (due_count == 0) return CanResult::kOk;
  const CanResult sent = bus_.SendAll(std::span(due_).first(due_count));
  return sent == CanResult::kDown ? sent : CanResult::kOk;
}

}  // namespace osteon::io
