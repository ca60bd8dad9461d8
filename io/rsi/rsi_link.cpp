#include "io/rsi/rsi_link.h"

#include <stdexcept>

#include "base/prefetch.h"

namespace osteon::io {
tl::expected<std::unique_ptr<RsiLink>, std::string> RsiLink::Open(const RsiLinkParams& params) {
  try {
    (void)RsiSession(params.session);
  } catch (const std::invalid_argument& error) {
    return tl::unexpected(std::string(error.what()));
  }
  const auto arm = PeerAddress("RSI: the arm's", params.arm_address);
  if (!arm) return tl::unexpected(arm.error());
  const auto bound = BindUdp("RSI", params.bind_address, params.port);
  if (!bound) return tl::unexpected(bound.error());
  return std::unique_ptr<RsiLink>(new RsiLink(*bound, *arm, params));
}

control::ReceiveResult RsiLink::Receive(control::ArmState& state, rt::Nanoseconds deadline) OSTEON_RT {
  return peer_.Receive(SessionJudge{session_, state}, deadline);
}

bool RsiLink::Send(const control::ArmCommand& command) OSTEON_RT {
  if (!peer_.has_peer()) return false;
  const std::span<const std::uint8_t> answer = session_.Answer(command);
  return answer.empty() || peer_.Send(answer);
}

void RsiLink::WarmUp(const control::ArmCommand& command) OSTEON_RT {
  if (warmup_) warmup_->Run(peer_.newest(), command);
  rt::Prefetch(session_);
}

}  // namespace osteon::io
