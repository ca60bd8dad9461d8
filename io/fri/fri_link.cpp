#include "io/fri/fri_link.h"

namespace osteon::io {
namespace {

// What UdpPeer asks of a protocol.
struct Judge {
  FriSession& session;
  control::ArmState& state;

  bool Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival) OSTEON_RT {
    return session.Accept(datagram, arrival, state) == FriAccept::kAccepted;
  }
  void Reject() OSTEON_RT { session.CountRejected(state); }
  void StartOver() OSTEON_RT { session.StartOver(); }
  void Superseded() OSTEON_RT { session.CountLate(state); }
};

}  // namespace

tl::expected<std::unique_ptr<FriLink>, std::string> FriLink::Open(const FriLinkParams& params) {
  const auto bound = BindUdp("FRI", params.bind_address, params.port);
  if (!bound) return tl::unexpected(bound.error());
  return std::unique_ptr<FriLink>(new FriLink(*bound, params));
}

control::ReceiveResult FriLink::Receive(control::ArmState& state, rt::Nanoseconds deadline) OSTEON_RT {
  return peer_.Receive(Judge{session_, state}, deadline);
}

bool FriLink::Send(const control::ArmCommand& command) OSTEON_RT {
  if (!peer_.has_peer()) return false;
  const std::span<const std::uint8_t> answer = session_.Answer(command);
  return answer.empty() || peer_.Send(answer);
}

}  // namespace osteon::io
