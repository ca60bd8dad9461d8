#include "io/fri/fri_link.h"

#include "base/prefetch.h"

namespace osteon::io {
tl::expected<std::unique_ptr<FriLink>, std::string> FriLink::Open(const FriLinkParams& params) {
  const auto arm = PeerAddress("FRI: the arm's", params.arm_address);
  if (!arm) return tl::unexpected(arm.error());
  const auto bound = BindUdp("FRI", params.bind_address, params.port);
  if (!bound) return tl::unexpected(bound.error());
  return std::unique_ptr<FriLink>(new FriLink(*bound, *arm, params));
}

control::ReceiveResult FriLink::Receive(control::ArmState& state, rt::Nanoseconds deadline) OSTEON_RT {
  return peer_.Receive(SessionJudge{session_, state}, deadline);
}

bool FriLink::Send(const control::ArmCommand& command) OSTEON_RT {
  if (!peer_.has_peer()) return false;
  const std::span<const std::uint8_t> answer = session_.Answer(command);
  return answer.empty() || peer_.Send(answer);
}

void FriLink::WarmUp(const control::ArmCommand& command) OSTEON_RT {
  if (warmup_) warmup_->Run(peer_.newest(), command);
  rt::Prefetch(session_);
}

}  // namespace osteon::io
