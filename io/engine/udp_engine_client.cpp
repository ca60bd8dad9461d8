#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include <fmt/format.h>

#include "io/engine/udp_engine.h"
#include "io/net/udp_socket.h"

namespace osteon::io {
namespace {

// Longest wait for a message; after it, messages that are due are sent again.
constexpr rt::Nanoseconds kReceiveSlice = 10 * rt::kMillisecond;
// Interval at which kEnd is sent to the engine until the engine answers.
constexpr rt::Nanoseconds kEndEvery = 50 * rt::kMillisecond;
// number of copies of kGoodbye; if all are lost, the engine is free only after kRunSilence
constexpr int kGoodbyes = 3;

// Reads a text's length and the text. Control characters are replaced by blanks, because the text will be
// printed.
std::string ReadText(ByteReader& reader) {
  const auto size = reader.Get<std::uint16_t>();
  const auto bytes = reader.GetBytes(size);
  std::string text(bytes.begin(), bytes.end());
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

}  // namespace

tl::expected<std::unique_ptr<UdpEngineClient>, std::string> UdpEngineClient::Connect(
    const UdpEngineParams& params, std::span<const std::uint8_t> setup) {
  const auto server = Ipv4("engine", params.address, params.port);
  if (!server) return tl::make_unexpected(server.error());
  const bool loopback = params.address.starts_with("127.");
  const auto bound = BindUdp("engine", loopback ? "127.0.0.1" : "0.0.0.0", 0);
  if (!bound) return tl::make_unexpected(bound.error());
  std::unique_ptr<UdpEngineClient> client(new UdpEngineClient(bound->socket, params, setup));
  // Connect the socket, so that it receives only from the engine.
  if (connect(bound->socket, reinterpret_cast<const sockaddr*>(&*server), sizeof *server) != 0)
    return tl::make_unexpected(
        fmt::format("{}:{}: cannot be reached: {}", params.address, params.port, SystemReason(errno)));
  if (std::string wrong = client->Greet(); !wrong.empty())
    return tl::make_unexpected(fmt::format("{}:{}: {}", params.address, params.port, wrong));
  return client;
}

UdpEngineClient::UdpEngineClient(int socket, const UdpEngineParams& params,
                                 std::span<const std::uint8_t> setup)
    : socket_(socket), params_(params), setup_(setup.begin(), setup.end()) {}

UdpEngineClient::~UdpEngineClient() {
  EngineBytes bytes;
  EncodeEngine({.kind = EngineMessage::kGoodbye, .session = session_}, std::span<const std::uint8_t>{},
               bytes);
  for (int i = 0; session_ != 0 && i < kGoodbyes; ++i) SendBytes(bytes);
  close(socket_);
}

void UdpEngineClient::SendBytes(const EngineBytes& bytes) OSTEON_RT {
  // An error is ignored: a message that cannot be sent is treated like a lost one.
  static_cast<void>(send(socket_, bytes.bytes.data(), bytes.size, MSG_DONTWAIT | MSG_NOSIGNAL));
}

void UdpEngineClient::SendHello() {
  std::array<std::uint8_t, 2 + kMaxToken + 8> content;
  ByteWriter writer(content);
  const std::string token = params_.token.substr(0, kMaxToken);
  writer.Put(static_cast<std::uint16_t>(token.size()));
  writer.PutBytes({reinterpret_cast<const std::uint8_t*>(token.data()), token.size()});
  writer.Put(static_cast<std::uint64_t>(setup_.size()));
  EngineBytes bytes;
  EncodeEngine({.kind = EngineMessage::kHello, .session = session_, .sequence = ++greeted_},
               std::span<const std::uint8_t>(content.data(), writer.size()), bytes);
  SendBytes(bytes);
  hello_at_ = rt::MonotonicNow();
}

std::optional<UdpEngineClient::Welcome> UdpEngineClient::DecodeWelcome(
    std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  Welcome welcome;
  reader.Get(welcome.progress);
  reader.Get(welcome.carved_bytes);
  welcome.engine = ReadText(reader);
  welcome.device = ReadText(reader);
  welcome.error = ReadText(reader);
  if (!reader.ok() || reader.left() > 0 || welcome.progress > EngineProgress::kRefused ||
      welcome.carved_bytes > kMaxBlockBytes)
    return std::nullopt;
  return welcome;
}

bool UdpEngineClient::Receive(rt::Nanoseconds deadline, EngineHeader& header,
                              std::span<const std::uint8_t>& content) {
  for (;;) {
    const Datagram datagram = ReadDatagram(socket_, in_);
    if (datagram.read == Datagram::Read::kGone) return false;
    if (datagram.read == Datagram::Read::kTaken) {
      const bool known = DecodeEngine(datagram.bytes, header, content) == EngineError::kNone &&
                         (session_ == 0 || header.session == session_);
      if (known) return true;
      ++counters_.rejected;
    }
    // if the system reports an error (nobody listens at the port), pause, to avoid a busy loop
    if (datagram.read == Datagram::Read::kReported)
      rt::SleepUntil(std::min(deadline, rt::MonotonicNow() + rt::kMillisecond));
    if (rt::MonotonicNow() >= deadline) return false;
    if (datagram.read == Datagram::Read::kNone && WaitReadable(socket_, deadline) != Wait::kReady)
      return false;
  }
}

std::string UdpEngineClient::Greet() {
  const rt::Nanoseconds begun = rt::MonotonicNow();
  bool answered = false;
  for (;;) {
    const rt::Nanoseconds now = rt::MonotonicNow();
    if (!answered && now - begun > params_.answer_within)
      return "no answer: does `osteon simulate --listen` run there, of the same version?";
    if (now - begun > params_.ready_within) return "the engine was not ready in time";
    if (now - hello_at_ >= kGreetEvery) SendHello();
    EngineHeader header;
    std::span<const std::uint8_t> content;
    if (!Receive(now + kReceiveSlice, header, content)) continue;
    // the engine asks for pieces of the set-up
    if (header.kind == EngineMessage::kWant && session_ != 0) {
      if (const auto want = DecodeWant(content); want && want->block == EngineBlock::kSetup)
        AnswerWant(*want, setup_, [&](std::span<const std::uint8_t> piece) {
          EngineBytes bytes;
          EncodeEngine({.kind = EngineMessage::kPiece, .session = session_, .sequence = ++asked_}, piece,
                       bytes);
          SendBytes(bytes);
        });
      continue;
    }
    if (header.kind != EngineMessage::kWelcome) continue;
    const auto welcome = DecodeWelcome(content);
    if (!welcome) continue;
    answered = true;
    if (welcome->progress == EngineProgress::kRefused) return welcome->error;
    if (welcome->progress == EngineProgress::kBusy) return "the engine there serves another run";
    session_ = header.session;
    if (welcome->progress != EngineProgress::kRuns) continue;
    engine_ = welcome->engine;
    device_ = welcome->device;
    return "";
  }
}

void UdpEngineClient::Store(const simulation::ToolCommand& command) OSTEON_RT {
  if (command.stamp <= last_stamp_) return;
  last_stamp_ = command.stamp;
  SendCommand({.command = command});
}

void UdpEngineClient::Send(const EngineCommand& command) { SendCommand(command); }

void UdpEngineClient::SendCommand(const EngineCommand& command) OSTEON_RT {
  EncodeEngine({.kind = EngineMessage::kCommand, .session = session_, .sequence = ++sent_}, command,
               command_bytes_);
  SendBytes(command_bytes_);
}

bool UdpEngineClient::AwaitFrame(EngineFrame& frame, rt::Nanoseconds deadline) {
  EngineHeader header;
  std::span<const std::uint8_t> content;
  for (;;) {
    // shows the engine that the run still exists
    if (rt::MonotonicNow() - hello_at_ >= kGreetEvery) SendHello();
    if (!Receive(deadline, header, content)) return false;
    if (header.kind != EngineMessage::kFrame) continue;
    const std::span<const std::uint8_t> message(in_.data(), kEngineHeaderBytes + content.size());
    if (DecodeEngine(message, header, frame) != EngineError::kNone) {
      ++counters_.rejected;
      continue;
    }
    // the frame was overtaken by a newer one, and was already counted as lost
    if (header.sequence < next_frame_) continue;
    models_.Store(frame.model);
    counters_.lost += header.sequence - next_frame_;
    next_frame_ = header.sequence + 1;
    ++counters_.frames;
    return true;
  }
}

tl::expected<std::vector<std::uint8_t>, std::string> UdpEngineClient::FetchCarved(rt::Nanoseconds deadline) {
  std::optional<BlockReceiver> carved;
  rt::Nanoseconds asked_at = 0;
  std::uint64_t questions = 0;  // number of messages sent by this function
  EngineBytes bytes;
  while (!carved || !carved->complete()) {
    const rt::Nanoseconds now = rt::MonotonicNow();
    if (now >= deadline) return tl::make_unexpected(std::string("the engine does not answer"));
    if (!carved && now - asked_at >= kEndEvery) {
      asked_at = now;
      EncodeEngine({.kind = EngineMessage::kEnd, .session = session_, .sequence = ++questions},
                   std::span<const std::uint8_t>{}, bytes);
      SendBytes(bytes);
    }
    if (const auto want = carved ? carved->NextWant(now) : std::nullopt)
      SendBytes(
          EncodeWant({.kind = EngineMessage::kWant, .session = session_, .sequence = ++questions}, *want));
    EngineHeader header;
    std::span<const std::uint8_t> content;
    if (!Receive(std::min(deadline, now + kReceiveSlice), header, content)) continue;
    if (carved && header.kind == EngineMessage::kPiece) carved->Accept(content);
    if (carved || header.kind != EngineMessage::kWelcome) continue;
    const auto welcome = DecodeWelcome(content);
    if (welcome && welcome->progress == EngineProgress::kRefused) return tl::make_unexpected(welcome->error);
    if (welcome && welcome->progress == EngineProgress::kCarved)
      carved.emplace(EngineBlock::kCarved, welcome->carved_bytes);
  }
  return carved->TakeBytes();
}

}  // namespace osteon::io
