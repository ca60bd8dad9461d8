#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "io/can/can_pump.h"
#include "io/can/udp_can_bus.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/can/can_frames.h"
#include "tests/io/net/loopback_socket.h"

// Tests CAN frames in UDP datagrams, the tunnel to a simulated cell: the codec, UdpCanBus, and CanPump on top
// of UdpCanBus.

namespace osteon::io {
namespace {

using Bytes = std::vector<std::uint8_t>;

CanFrame Frame(std::uint16_t id, std::initializer_list<std::uint8_t> data) {
  CanFrame frame{.id = id, .size = static_cast<std::uint8_t>(data.size())};
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

// The bytes of kGoldenMessage, written by hand after the layout in udp_can_codec.h.
const Bytes kGolden{0x4F, 0x43, 0x41, 0x4E, 0x01, 0x03, 0x07, 0xFE, 0xA1, 0xA2,
                    0xA3, 0xA4, 0x00, 0x00, 0x01, 0x02, 0xDE, 0xAD, 0xBE};
const UdpCanMessage kGoldenMessage{
    .frame = Frame(0x7FE, {0xDE, 0xAD, 0xBE}), .session = 0xA1A2A3A4, .sequence = 0x102};

Bytes Encoded(const UdpCanMessage& message) {
  std::array<std::uint8_t, kUdpCanMaxDatagram> buffer{};
  const std::size_t size = EncodeUdpCan(message, buffer);
  return {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size)};
}

UdpCanError ErrorOf(const Bytes& datagram) {
  UdpCanMessage message;
  return DecodeUdpCan(datagram, message);
}

TEST(UdpCanCodec, HasTheDocumentedBytes) {
  EXPECT_EQ(Encoded(kGoldenMessage), kGolden);
  UdpCanMessage message;
  ASSERT_EQ(DecodeUdpCan(kGolden, message), UdpCanError::kNone);
  EXPECT_EQ(message.frame, kGoldenMessage.frame);
  EXPECT_EQ(message.session, kGoldenMessage.session);
  EXPECT_EQ(message.sequence, kGoldenMessage.sequence);
}

TEST(UdpCanCodec, RefusesDatagramsThatDeviateFromTheLayout) {
  const auto changed = [](std::size_t at, std::uint8_t value) {
    Bytes bytes = kGolden;
    bytes[at] = value;
    return bytes;
  };
  EXPECT_EQ(ErrorOf({}), UdpCanError::kTooShort);
  EXPECT_EQ(ErrorOf(Bytes(kGolden.begin(), kGolden.begin() + 15)), UdpCanError::kTooShort);
  EXPECT_EQ(ErrorOf(changed(0, 'o')), UdpCanError::kMagic);
  EXPECT_EQ(ErrorOf(changed(4, 2)), UdpCanError::kVersion);
  EXPECT_EQ(ErrorOf(changed(5, 2)), UdpCanError::kLength) << "a byte more than it says";
  EXPECT_EQ(ErrorOf(changed(5, 4)), UdpCanError::kLength) << "a byte less";
  EXPECT_EQ(ErrorOf(changed(6, 0x08)), UdpCanError::kId);
  Bytes long_one = kGolden;
  long_one[5] = 9;
  long_one.resize(16 + 9);
  EXPECT_EQ(ErrorOf(long_one), UdpCanError::kLength) << "consistent, but no classical frame";
  EXPECT_TRUE(Encoded({.frame = {.id = 0x800}}).empty());
  EXPECT_TRUE(Encoded({.frame = {.id = 1, .size = 9}}).empty());
}

TEST(CanFrame, IsPrintedInCandumpsNotation) {
  EXPECT_EQ(ToText(Frame(0x64, {0x0B, 0x00, 0xFF})), "064#0B00FF");
  EXPECT_EQ(IdText(0x20), "0x020");
}

UdpCanBus::Pair OpenPair() {
  auto pair = UdpCanBus::OpenPair();
  EXPECT_TRUE(pair) << pair.error();
  return std::move(*pair);
}

TEST(UdpCanBus, CarriesFramesBothWaysInOrder) {
  const auto [a, b] = OpenPair();
  CanArrival arrival;
  EXPECT_EQ(b->TryReceive(arrival), CanResult::kEmpty);
  const rt::Nanoseconds before = rt::MonotonicNow() - rt::kSecond;
  for (std::uint16_t id = 0; id < 5; ++id) ASSERT_EQ(a->Send(Frame(id, {1, 2})), CanResult::kOk);
  ASSERT_EQ(b->Send(Frame(0x7FF, {})), CanResult::kOk);
  std::array<CanArrival, 8> room;
  ASSERT_EQ(b->Drain(room), 5u);
  for (std::uint16_t id = 0; id < 5; ++id) EXPECT_EQ(room[id].frame, Frame(id, {1, 2}));
  EXPECT_GT(room[0].stamp, before);
  EXPECT_LE(room[4].stamp, rt::MonotonicNow());
  ASSERT_EQ(a->Receive(arrival, 0), CanResult::kOk) << "taken after the deadline too";
  EXPECT_EQ(arrival.frame, Frame(0x7FF, {}));
  EXPECT_EQ(a->Receive(arrival, rt::MonotonicNow() + rt::kMillisecond), CanResult::kEmpty);
  EXPECT_EQ(a->status().sent, 5u);
  EXPECT_EQ(b->status().received, 5u);
}

TEST(UdpCanBus, DrainTakesNoMoreFramesThanFitIntoTheBuffer) {
  const auto [a, b] = OpenPair();
  for (int i = 0; i < 5; ++i) ASSERT_EQ(a->Send(Frame(1, {})), CanResult::kOk);
  std::array<CanArrival, 3> room;
  EXPECT_EQ(b->Drain(room), 3u);
  EXPECT_EQ(b->Drain(room), 2u);
}

TEST(UdpCanBus, RefusesInvalidFrames) {
  const auto [a, b] = OpenPair();
  EXPECT_EQ(a->Send({.id = 0x800}), CanResult::kFull);
  EXPECT_EQ(a->Send({.id = 1, .size = 9}), CanResult::kFull);
  EXPECT_EQ(a->status().unsent, 2u);
  CanArrival arrival;
  EXPECT_EQ(b->TryReceive(arrival), CanResult::kEmpty);
}

// The other end of the tunnel as a plain socket, so that a test can send damaged datagrams.
using Peer = test::LoopbackSocket;

// A bus that sends to this peer and receives only from this peer.
std::unique_ptr<UdpCanBus> OpenToward(const Peer& peer, std::vector<CanFilter> filters = {}) {
  auto bus = UdpCanBus::Open({.bind_port = 0, .peer_port = peer.port(), .filters = std::move(filters)});
  EXPECT_TRUE(bus) << bus.error();
  return std::move(*bus);
}

// A datagram with this session and sequence number. Its frame's id is the low byte of the sequence number.
Bytes Numbered(std::uint32_t session, std::uint32_t sequence) {
  return Encoded({.frame = Frame(static_cast<std::uint16_t>(sequence & 0xFF), {}),
                  .session = session,
                  .sequence = sequence});
}

TEST(UdpCanBus, CountsLossesAndMarksTheNextFrame) {
  const Peer peer;
  const auto bus = OpenToward(peer);
  CanArrival arrival;
  for (const std::uint32_t sequence : {0u, 1u, 4u, 5u}) peer.SendTo(bus->port(), Numbered(1, sequence));
  const std::array<bool, 4> gap{false, false, true, false};
  for (const bool expected : gap) {
    ASSERT_EQ(bus->TryReceive(arrival), CanResult::kOk);
    EXPECT_EQ(arrival.after_gap, expected) << arrival.frame.id;
  }
  EXPECT_EQ(bus->status().lost, 2u);
}

TEST(UdpCanBus, DeliversNoFrameTwiceOrOutOfOrder) {
  const Peer peer;
  const auto bus = OpenToward(peer);
  for (const std::uint32_t sequence : {0u, 1u, 1u, 0u, 3u, 2u, 4u})
    peer.SendTo(bus->port(), Numbered(1, sequence));
  std::vector<int> got;
  for (CanArrival arrival; bus->TryReceive(arrival) == CanResult::kOk;) got.push_back(arrival.frame.id);
  EXPECT_EQ(got, (std::vector<int>{0, 1, 3, 4}));
  EXPECT_EQ(bus->status().duplicate, 3u);
  EXPECT_EQ(bus->status().lost, 1u);
}

TEST(UdpCanBus, ARestartedPeerOrAWrappedCounterIsNoLoss) {
  const Peer peer;
  const auto bus = OpenToward(peer);
  for (const std::uint32_t sequence : {0xFFFFFFFEu, 0xFFFFFFFFu, 0u})
    peer.SendTo(bus->port(), Numbered(1, sequence));
  peer.SendTo(bus->port(), Numbered(2, 0));
  std::array<CanArrival, 8> room;
  EXPECT_EQ(bus->Drain(room), 4u);
  EXPECT_EQ(bus->status().lost, 0u);
  EXPECT_EQ(bus->status().duplicate, 0u);
}

TEST(UdpCanBus, CountsInvalidDatagramsAndListensToItsPeerAlone) {
  const Peer peer, stranger;
  const auto bus = OpenToward(peer);
  stranger.SendTo(bus->port(), Numbered(1, 0));
  peer.SendTo(bus->port(), Bytes{});
  peer.SendTo(bus->port(), Bytes(500, 'O'));
  peer.SendTo(bus->port(), Bytes(kGolden.begin(), kGolden.end() - 1));
  peer.SendTo(bus->port(), Numbered(1, 7));
  CanArrival arrival;
  ASSERT_EQ(bus->TryReceive(arrival), CanResult::kOk);
  EXPECT_EQ(arrival.frame.id, 7);
  EXPECT_EQ(bus->TryReceive(arrival), CanResult::kEmpty);
  EXPECT_EQ(bus->status().rejected, 3u) << "the stranger's never reached us";
}

TEST(UdpCanBus, DeliversOnlyFramesThatPassAFilter) {
  const Peer peer;
  const auto bus = OpenToward(peer, {{.id = 0x10, .mask = 0x7F0}, {.id = 0x42}});
  std::uint32_t sequence = 0;
  for (const int id : {0x0F, 0x10, 0x1F, 0x20, 0x42, 0x43})
    peer.SendTo(
        bus->port(),
        Encoded({.frame = Frame(static_cast<std::uint16_t>(id), {}), .session = 1, .sequence = sequence++}));
  std::vector<int> got;
  for (CanArrival arrival; bus->TryReceive(arrival) == CanResult::kOk;) got.push_back(arrival.frame.id);
  EXPECT_EQ(got, (std::vector<int>{0x10, 0x1F, 0x42}));
  EXPECT_EQ(bus->status().lost, 0u) << "what the filter holds back is not lost";
}

TEST(UdpCanBus, WithoutAListenerFramesCountAsUnsent) {
  auto peer = std::make_unique<Peer>();
  const auto bus = OpenToward(*peer);
  peer.reset();
  ASSERT_EQ(bus->Send(Frame(1, {})), CanResult::kOk) << "the system hears of it afterwards";
  EXPECT_EQ(bus->Send(Frame(1, {})), CanResult::kFull);
  CanArrival arrival;
  EXPECT_EQ(bus->Receive(arrival, rt::MonotonicNow() + rt::kMillisecond), CanResult::kEmpty);
}

// If nobody listens, the system reports an undelivered frame only at the next send, and then refuses the next
// frame. So two of four frames count as sent, whether they are sent in a batch or one by one.
TEST(UdpCanBus, ABatchWithoutAListenerIsCountedLikeSingleFrames) {
  const auto counted = [](bool batch) {
    auto peer = std::make_unique<Peer>();
    const auto bus = OpenToward(*peer);
    peer.reset();
    const std::array<CanFrame, 4> frames{Frame(1, {}), Frame(2, {}), Frame(3, {}), Frame(4, {})};
    if (batch) {
      EXPECT_EQ(bus->SendAll(frames), CanResult::kFull);
    } else {
      for (const CanFrame& frame : frames) (void)bus->Send(frame);
    }
    return std::pair(bus->status().sent, bus->status().unsent);
  };
  EXPECT_EQ(counted(true), counted(false));
  EXPECT_EQ(counted(true), std::pair(std::uint64_t{2}, std::uint64_t{2}));
}

TEST(UdpCanBus, OpenErrorsNameTheWrongAddressOrPort) {
  const auto says = [](const UdpCanParams& params, const std::string& text) {
    const auto bus = UdpCanBus::Open(params);
    ASSERT_FALSE(bus);
    EXPECT_NE(bus.error().find(text), std::string::npos) << bus.error();
  };
  const auto [a, b] = OpenPair();
  says({.bind_port = a->port(), .peer_port = 1}, "127.0.0.1:" + std::to_string(a->port()) + " is taken");
  says({.bind_address = "localhost", .bind_port = 0}, "bind address 'localhost' is not an IPv4 address");
  says({.bind_port = 0, .peer_address = "::1"}, "peer address '::1' is not an IPv4 address");
  says({.bind_address = "192.0.2.1", .bind_port = 0}, "no network card with that address");
  says({.bind_port = 0, .peer_port = 0}, "peer port: found 0");
}

// A client that sends each frame back once, with the id increased by one.
class Echo final : public CanClient {
 public:
  void Accept(const CanArrival& arrival) OSTEON_RT override {
    last_ = arrival.frame;
    due_ = true;
  }
  bool Next(rt::Nanoseconds, CanFrame& frame) OSTEON_RT override {
    if (!due_) return false;
    due_ = false;
    frame = last_;
    ++frame.id;
    return true;
  }

 private:
  CanFrame last_;
  bool due_{false};
};

TEST(CanPump, CarriesFramesBothWaysWithoutAllocating) {
  const auto [a, b] = OpenPair();
  Echo first, second;
  CanPump pump(*b);
  ASSERT_TRUE(pump.Add(first) && pump.Add(second));
  ASSERT_EQ(a->Send(Frame(0x20, {9})), CanResult::kOk);
  CanResult pumped{}, sent{}, received{};
  CanArrival arrival;
  {
    rt::CheckedNoAllocScope no_alloc;
    pumped = pump.Pump(1);
    received = a->Receive(arrival, rt::MonotonicNow() + rt::kSecond);
    sent = a->Send(arrival.frame);
  }
  EXPECT_EQ(pumped, CanResult::kOk);
  EXPECT_EQ(sent, CanResult::kOk);
  ASSERT_EQ(received, CanResult::kOk);
  EXPECT_EQ(arrival.frame, Frame(0x21, {9}));
  std::array<CanArrival, 4> room;
  EXPECT_EQ(a->Drain(room), 1u) << "both clients answered";
}

// A client that always has a further frame to send. It numbers its frames from 0 and keeps the frames that it
// receives.
class EndlessSender final : public CanClient {
 public:
  explicit EndlessSender(std::uint16_t id) : id_(id) {}
  void Accept(const CanArrival& arrival) OSTEON_RT override {
    if (heard_ < got_.size()) got_[heard_++] = arrival.frame;
  }
  bool Next(rt::Nanoseconds, CanFrame& frame) OSTEON_RT override {
    frame = {.id = id_, .size = 1, .data = {next_++}};
    return true;
  }
  [[nodiscard]] std::span<const CanFrame> got() const { return std::span(got_).first(heard_); }

 private:
  std::uint16_t id_;
  std::uint8_t next_{0};
  std::array<CanFrame, 256> got_{};
  std::size_t heard_{0};
};

// Four clients send as many frames as one call of Pump accepts. Pump is called twice, and a single Pump
// receives all frames.
TEST(CanPump, ManyFramesOfOneTickArriveCompleteAndInOrder) {
  const auto [a, b] = OpenPair();
  std::vector<EndlessSender> senders{EndlessSender(0x10), EndlessSender(0x20), EndlessSender(0x30),
                                     EndlessSender(0x40)};
  EndlessSender receiver(0x50);
  CanPump sending(*a), receiving(*b);
  for (EndlessSender& each : senders) ASSERT_TRUE(sending.Add(each));
  ASSERT_TRUE(receiving.Add(receiver));
  constexpr std::size_t kAtOnce =
      CanPump::kMaxClients * CanPump::kMaxSends;  // 64, more than fit in one batch
  for (int call = 0; call < 2; ++call) ASSERT_EQ(sending.Pump(call), CanResult::kOk);
  ASSERT_EQ(receiving.Pump(0), CanResult::kOk);
  ASSERT_EQ(receiver.got().size(), 2 * kAtOnce) << "kMaxReads at once, of both calls";
  for (std::size_t i = 0; i < 2 * kAtOnce; ++i) {
    const std::size_t call = i / kAtOnce, client = i % kAtOnce / CanPump::kMaxSends;
    const auto number = static_cast<std::uint8_t>(call * CanPump::kMaxSends + i % CanPump::kMaxSends);
    EXPECT_EQ(receiver.got()[i], Frame(static_cast<std::uint16_t>(0x10 * (client + 1)), {number})) << i;
  }
  EXPECT_EQ(a->status().sent, 2 * kAtOnce);
  EXPECT_EQ(a->status().unsent, 0u);
  EXPECT_EQ(b->status().received, 2 * kAtOnce);
  EXPECT_EQ(b->status().lost, 0u);
}

TEST(UdpCanBus, AFullQueueLosesNoFrameSilently) {
  const auto [a, b] = OpenPair();
  // more frames than the socket's queue holds on any system, so some frames find no room
  constexpr std::size_t kFrames = 100'000, kAtOnce = 50;
  std::vector<CanFrame> frames;
  for (std::size_t i = 0; i < kAtOnce; ++i) frames.push_back(Frame(0x123, {static_cast<std::uint8_t>(i)}));
  for (std::size_t i = 0; i < kFrames; i += kAtOnce) (void)a->SendAll(frames);
  EXPECT_EQ(a->status().sent + a->status().unsent, kFrames);
  std::array<CanArrival, 40> room;
  std::uint64_t got = 0;
  for (std::size_t count = 0; b->ReceiveAll(room, count) == CanResult::kOk;) got += count;
  ASSERT_LT(got, a->status().sent) << "the queue was never full: nothing was shown";
  // the next frame tells the receiver how many frames were lost
  ASSERT_EQ(a->Send(Frame(0x123, {255})), CanResult::kOk);
  CanArrival last;
  ASSERT_EQ(b->Receive(last, rt::MonotonicNow() + rt::kSecond), CanResult::kOk);
  EXPECT_TRUE(last.after_gap);
  EXPECT_EQ(got + 1 + b->status().lost, a->status().sent);
  EXPECT_EQ(b->status().received, got + 1);
}

// The second and the fourth frame are invalid: one has an id of more than 11 bits, the other has nine bytes.
TEST(UdpCanBus, AnInvalidFrameDoesNotKeepTheOthersFromBeingSent) {
  const auto [a, b] = OpenPair();
  const std::array<CanFrame, 4> frames{Frame(1, {}), CanFrame{.id = 0x800}, Frame(2, {}),
                                       CanFrame{.id = 3, .size = 9}};
  EXPECT_EQ(a->SendAll(frames), CanResult::kFull);
  EXPECT_EQ(a->status().sent, 2u);
  EXPECT_EQ(a->status().unsent, 2u);
  std::array<CanArrival, 4> room;
  ASSERT_EQ(b->Drain(room), 2u);
  EXPECT_EQ(room[0].frame.id, 1);
  EXPECT_EQ(room[1].frame.id, 2);
  EXPECT_FALSE(room[1].after_gap) << "what was not sent has no number";
  EXPECT_EQ(b->status().lost, 0u);
}

TEST(CanPump, RefusesMoreClientsThanItHolds) {
  const auto [a, b] = OpenPair();
  Echo echo;
  CanPump pump(*a);
  for (std::size_t i = 0; i < CanPump::kMaxClients; ++i) EXPECT_TRUE(pump.Add(echo));
  EXPECT_FALSE(pump.Add(echo));
}

}  // namespace
}  // namespace osteon::io
