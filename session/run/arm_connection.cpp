#include "session/run/arm_connection.h"

#include <utility>

#include <fmt/format.h>

namespace osteon::session {
namespace {

// Says what prevents commanding an arm on RSI; empty: nothing does.
std::string DiagnosisOf(const io::RsiStatus& status, const io::RsiError& error) {
  if (status.sessions == 0 && error) return "What came was refused as RSI: " + io::Describe(error) + ".";
  if (status.sessions == 0)
    return "No session of RSI has begun: is its program past the HALT, sending to this address and port, and "
           "was it started after osteon?";
  if (status.not_finite > 0) return "A command was not finite and was held.";
  if (status.out_of_range > 0)
    return fmt::format("The arm is held: a correction of number {} is beyond the cell's range.",
                       status.worst);
  return {};
}

}  // namespace

std::string Describe(const config::ArmLinkConfig& link) {
  if (const io::FriSessionParams* fri = link.fri()) return fmt::format("FRI {}", io::Name(fri->version));
  const io::RsiSessionParams& rsi = *link.rsi();
  return fmt::format(
      "RSI {}, {}, {} ms{}", rsi.layout == io::RsiLayout::kImFree ? "im_free" : "kroshu",
      rsi.kind == io::RsiCorrection::kAxes ? "axes" : "cartesian", rsi.cycle_ms,
      rsi.absolute && !rsi.hold_on
          ? ", where a lost answer throws the arm back to where RSI began (the cell accepts it)"
          : "");
}

// On RSI, only KROSHU's message layout has a <Stop> to ask the arm's program to end.
bool CanRequestStop(const config::ArmLinkConfig& link) {
  return link.rsi() && link.rsi()->layout == io::RsiLayout::kKroshu;
}

ArmProtocolSession::ArmProtocolSession(const config::ArmLinkConfig& link)
    : session_(link.fri() ? std::variant<io::FriSession, io::RsiSession>(io::FriSession(*link.fri()))
                          : io::RsiSession(*link.rsi())),
      can_stop_(CanRequestStop(link)) {}

bool ArmProtocolSession::Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                                control::ArmState& state) {
  if (auto* fri = std::get_if<io::FriSession>(&session_))
    return fri->Accept(datagram, stamp, state) == io::FriAccept::kAccepted;
  return std::get<io::RsiSession>(session_).Accept(datagram, stamp, state) == io::RsiAccept::kAccepted;
}

std::span<const std::uint8_t> ArmProtocolSession::Answer(const control::ArmCommand& command) {
  return std::visit([&](auto& session) { return session.Answer(command); }, session_);
}

bool ArmProtocolSession::RequestStop() {
  if (can_stop_) std::get<io::RsiSession>(session_).RequestStop();
  return can_stop_;
}

std::string ArmProtocolSession::Diagnosis() const {
  if (const auto* fri = std::get_if<io::FriSession>(&session_)) return fri->Diagnosis();
  const auto& rsi = std::get<io::RsiSession>(session_);
  return DiagnosisOf(rsi.status(), rsi.last_error());
}

tl::expected<ArmConnection, std::string> ArmConnection::Open(const config::ArmLinkConfig& link,
                                                             const std::string& peer) {
  if (const io::FriSessionParams* fri = link.fri()) {
    auto opened = io::FriLink::Open(
        {.bind_address = link.host, .arm_address = peer, .port = link.port, .session = *fri});
    if (!opened) return tl::make_unexpected(opened.error());
    return ArmConnection(std::move(*opened), false);
  }
  auto opened = io::RsiLink::Open(
      {.bind_address = link.host, .arm_address = peer, .port = link.port, .session = *link.rsi()});
  if (!opened) return tl::make_unexpected(opened.error());
  return ArmConnection(std::move(*opened), CanRequestStop(link));
}

control::ArmLink& ArmConnection::link() {
  return *std::visit([](auto& link) -> control::ArmLink* { return link.get(); }, link_);
}

void ArmConnection::EndSession() {
  if (!can_stop_) return;
  io::RsiLink& rsi = *std::get<std::unique_ptr<io::RsiLink>>(link_);
  rsi.RequestStop();
  control::ArmState state;
  const rt::Nanoseconds until = rt::MonotonicNow() + kMaxEndDelay;
  // the arm is silent once it has ended its session; if it missed the answer, it sends another message
  while (rsi.Receive(state, until) == control::ReceiveResult::kOk && rt::MonotonicNow() < until)
    static_cast<void>(rsi.Send({}));
}

std::string ArmConnection::Diagnosis() const {
  if (const auto* fri = std::get_if<std::unique_ptr<io::FriLink>>(&link_))
    return (*fri)->session().Diagnosis();
  const auto& rsi = std::get<std::unique_ptr<io::RsiLink>>(link_);
  return DiagnosisOf(rsi->status(), rsi->last_error());
}

}  // namespace osteon::session
