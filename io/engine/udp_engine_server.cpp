#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "io/engine/udp_engine.h"
#include "io/net/udp_socket.h"

namespace osteon::io {
namespace {

constexpr int kMaxAtOnce = 256;  // largest number of datagrams read in one call, so that the call returns
                                 // even if datagrams keep arriving
constexpr std::size_t kMaxText = 300;  // longest name or error text in a welcome, in bytes

// Whether two texts are equal. For texts of equal length the computing time does not depend on where they
// differ, so a token cannot be guessed byte by byte.
bool SameText(std::span<const std::uint8_t> a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0u : 1u;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
    difference |= static_cast<unsigned>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

// Writes a text's length and the text, truncated to kMaxText bytes.
void PutText(ByteWriter& writer, const std::string& text) {
  const std::string cut = text.substr(0, kMaxText);
  writer.Put(static_cast<std::uint16_t>(cut.size()));
  writer.PutBytes({reinterpret_cast<const std::uint8_t*>(cut.data()), cut.size()});
}

// Returns a random number other than 0, or the time if the system provides no random numbers.
std::uint64_t NewSession() {
  std::uint64_t session = 0;
  while (session == 0)
    if (getrandom(&session, sizeof session, 0) != sizeof session)
      session = static_cast<std::uint64_t>(rt::MonotonicNow());
  return session;
}

}  // namespace

tl::expected<std::unique_ptr<UdpEngineServer>, std::string> UdpEngineServer::Open(
    const UdpServerParams& params) {
  if (params.token.empty() && !params.address.starts_with("127."))
    return tl::make_unexpected(params.address +
                               ": found no token, accepted one: beyond the loopback an engine asks for it");
  if (params.token.size() > kMaxToken)
    return tl::make_unexpected("the token: found " + std::to_string(params.token.size()) +
                               " bytes, accepted up to " + std::to_string(kMaxToken));
  const auto bound = BindUdp("engine", params.address, params.port);
  if (!bound) return tl::make_unexpected(bound.error());
  return std::unique_ptr<UdpEngineServer>(new UdpEngineServer(bound->socket, bound->port, params.token));
}

UdpEngineServer::UdpEngineServer(int socket, std::uint16_t port, std::string token)
    : socket_(socket), port_(port), token_(std::move(token)) {}

UdpEngineServer::~UdpEngineServer() { close(socket_); }

bool UdpEngineServer::IsPeer(const sockaddr_in& sender) const {
  return peer_ && sender.sin_addr.s_addr == peer_->sin_addr.s_addr && sender.sin_port == peer_->sin_port;
}

void UdpEngineServer::SendBytes(const EngineBytes& bytes, const sockaddr_in& to) {
  // An error is ignored: a message that cannot be sent is treated like a lost one.
  static_cast<void>(sendto(socket_, bytes.bytes.data(), bytes.size, MSG_DONTWAIT | MSG_NOSIGNAL,
                           reinterpret_cast<const sockaddr*>(&to), sizeof to));
}

void UdpEngineServer::SendWelcome(const sockaddr_in& to, EngineProgress progress, std::uint64_t session) {
  std::array<std::uint8_t, 9 + 3 * (2 + kMaxText)> content;
  ByteWriter writer(content);
  writer.Put(progress);
  writer.Put(static_cast<std::uint64_t>(carved_.size()));
  PutText(writer, engine_);
  PutText(writer, device_);
  PutText(writer,
          progress == EngineProgress::kRefused && session == 0 ? "the token is missing or wrong" : error_);
  EngineBytes bytes;
  EncodeEngine({.kind = EngineMessage::kWelcome, .session = session, .sequence = ++sent_},
               std::span<const std::uint8_t>(content.data(), writer.size()), bytes);
  SendBytes(bytes, to);
}

void UdpEngineServer::AnswerHello(std::span<const std::uint8_t> content, const sockaddr_in& sender) {
  ByteReader reader(content);
  const auto token_size = reader.Get<std::uint16_t>();
  const auto token = reader.GetBytes(token_size);
  const auto setup_size = reader.Get<std::uint64_t>();
  if (!reader.ok() || reader.left() > 0 || setup_size == 0 || setup_size > kMaxBlockBytes) {
    ++counters_.rejected;
    return;
  }
  if (!token_.empty() && !SameText(token, token_)) {
    ++counters_.rejected;
    return SendWelcome(sender, EngineProgress::kRefused, 0);
  }
  const rt::Nanoseconds now = rt::MonotonicNow();
  if (!IsPeer(sender)) {
    if (peer_ && now - heard_ < kRunSilence) return SendWelcome(sender, EngineProgress::kBusy, 0);
    if (peer_ && progress_ != EngineProgress::kTakesSetup) return;  // Await must end the old run first
    ResetSession();
    peer_ = sender;
    session_ = NewSession();
    setup_.emplace(EngineBlock::kSetup, setup_size);
  }
  heard_ = now;
  SendWelcome(sender, progress_, session_);
}

UdpEngineServer::Heard UdpEngineServer::Receive(rt::Nanoseconds deadline, EngineHeader& header,
                                                std::span<const std::uint8_t>& content) {
  for (int left = kMaxAtOnce; left > 0; --left) {
    const Datagram datagram = ReadDatagram(socket_, in_);
    if (datagram.read == Datagram::Read::kNone) {
      if (rt::MonotonicNow() >= deadline || WaitReadable(socket_, deadline) != Wait::kReady)
        return Heard::kNothing;
      continue;
    }
    if (datagram.read == Datagram::Read::kGone) return Heard::kNothing;
    if (datagram.read != Datagram::Read::kTaken) continue;
    if (DecodeEngine(datagram.bytes, header, content) != EngineError::kNone) {
      ++counters_.rejected;
      continue;
    }
    if (header.kind == EngineMessage::kHello) {
      AnswerHello(content, datagram.sender);
      return Heard::kHello;
    }
    if (!IsPeer(datagram.sender) || header.session != session_) {
      ++counters_.rejected;
      continue;
    }
    heard_ = rt::MonotonicNow();
    switch (header.kind) {
      case EngineMessage::kCommand:
        return Heard::kCommand;
      case EngineMessage::kWant:
        return Heard::kWant;
      case EngineMessage::kPiece:
        return Heard::kPiece;
      case EngineMessage::kEnd:
        return Heard::kEnd;
      case EngineMessage::kGoodbye:
        return Heard::kGoodbye;
      case EngineMessage::kHello:
      case EngineMessage::kWelcome:
      case EngineMessage::kFrame:
        break;
    }
    ++counters_.rejected;
  }
  return Heard::kNothing;
}

std::optional<std::vector<std::uint8_t>> UdpEngineServer::AwaitSetup(rt::Nanoseconds deadline) {
  for (;;) {
    const rt::Nanoseconds now = rt::MonotonicNow();
    if (now >= deadline) return std::nullopt;
    EngineHeader header;
    std::span<const std::uint8_t> content;
    const Heard heard = Receive(std::min(deadline, now + kAskAgain), header, content);
    if (heard == Heard::kGoodbye) ResetSession();
    if (!setup_) continue;
    if (heard == Heard::kPiece && !setup_->Accept(content)) ++counters_.rejected;
    if (const auto want = setup_->NextWant(rt::MonotonicNow()))
      SendBytes(EncodeWant({.kind = EngineMessage::kWant, .session = session_, .sequence = ++sent_}, *want),
                *peer_);
    if (!setup_->complete()) continue;
    progress_ = EngineProgress::kMakes;
    std::vector<std::uint8_t> bytes = setup_->TakeBytes();
    setup_.reset();
    return bytes;
  }
}

void UdpEngineServer::SetRunning(const std::string& engine, const std::string& device) {
  engine_ = engine;
  device_ = device;
  progress_ = EngineProgress::kRuns;
  if (peer_) SendWelcome(*peer_, progress_, session_);
}

void UdpEngineServer::SetFailed(const std::string& why) {
  error_ = why;
  progress_ = EngineProgress::kRefused;
  if (peer_) SendWelcome(*peer_, progress_, session_);
}

EngineEvent UdpEngineServer::Await(EngineCommand& command, rt::Nanoseconds deadline) {
  bool newer = false;  // a command was received; continue reading, because a newer one may wait
  for (;;) {
    EngineHeader header;
    std::span<const std::uint8_t> content;
    switch (Receive(newer ? 0 : deadline, header, content)) {
      case Heard::kNothing:
        if (newer) return EngineEvent::kCommand;
        return rt::MonotonicNow() - heard_ > kRunSilence ? EngineEvent::kGone : EngineEvent::kNothing;
      case Heard::kCommand: {
        EngineCommand read;
        const std::span<const std::uint8_t> message(in_.data(), kEngineHeaderBytes + content.size());
        if (DecodeEngine(message, header, read) != EngineError::kNone) {
          ++counters_.rejected;
        } else if (header.sequence > last_command_) {
          last_command_ = header.sequence;
          command = read;
          newer = true;
        }
        break;
      }
      case Heard::kWant:
        if (const auto want = DecodeWant(content); want && want->block == EngineBlock::kCarved)
          AnswerWant(*want, carved_, [&](std::span<const std::uint8_t> piece) {
            EngineBytes bytes;
            EncodeEngine({.kind = EngineMessage::kPiece, .session = session_, .sequence = ++sent_}, piece,
                         bytes);
            SendBytes(bytes, *peer_);
          });
        break;
      case Heard::kEnd:
        SendWelcome(*peer_, progress_, session_);
        if (progress_ == EngineProgress::kRuns) return EngineEvent::kEnd;
        break;
      case Heard::kGoodbye:
        return EngineEvent::kGone;
      case Heard::kHello:
      case Heard::kPiece:
        break;
    }
  }
}

void UdpEngineServer::Publish(const EngineFrame& frame) {
  EncodeEngine({.kind = EngineMessage::kFrame, .session = session_, .sequence = ++made_}, frame,
               frame_bytes_);
  SendBytes(frame_bytes_, *peer_);
}

void UdpEngineServer::PutCarved(std::vector<std::uint8_t> bytes) {
  carved_ = std::move(bytes);
  progress_ = EngineProgress::kCarved;
}

void UdpEngineServer::ResetSession() {
  peer_.reset();
  setup_.reset();
  session_ = made_ = last_command_ = 0;
  progress_ = EngineProgress::kTakesSetup;
  carved_.clear();
  engine_.clear();
  device_.clear();
  error_.clear();
}

}  // namespace osteon::io
