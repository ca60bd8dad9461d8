#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "io/engine/udp_engine.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/engine/engine_samples.h"

// Tests the simulation engine on another machine, connected over UDP: runs, refusals, datagrams of strangers,
// and large blocks that are sent in pieces.

namespace osteon::io {
namespace {

using testing::HasSubstr;

constexpr rt::Nanoseconds kPatience = 20 * rt::kSecond;  // so long that a busy machine fails no test
constexpr rt::Nanoseconds kSlice =
    5 * rt::kMillisecond;  // interval at which the engine's thread checks whether it must end

// Deadline of a wait that must succeed.
rt::Nanoseconds Soon() { return rt::MonotonicNow() + kPatience; }

// A server with its thread. It answers each command with a frame, and serves one run after the other.
class Engine {
 public:
  explicit Engine(const UdpServerParams& params = {}) {
    auto opened = UdpEngineServer::Open(params);
    if (!opened) throw std::runtime_error(opened.error());
    server_ = std::move(*opened);
    port = server_->port();
    thread_ = std::thread([this] { Serve(); });
  }
  ~Engine() { End(); }
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  void End() {
    stop_.store(true);
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const EngineCounters& counters() const { return server_->counters(); }

  std::uint16_t port{0};
  std::vector<std::uint8_t> setup_bytes;      // set-up of the last run; read it only after End()
  std::vector<std::uint8_t> carved{1, 2, 3};  // carved state that the client fetches; set it before a run
  std::atomic<int> runs{0};

 private:
  void Serve() {
    while (!stop_.load()) {
      auto setup = server_->AwaitSetup(rt::MonotonicNow() + kSlice);
      if (!setup) continue;
      setup_bytes = std::move(*setup);
      ++runs;
      server_->SetRunning("cpu", "a test");
      std::uint64_t number = 0;
      for (EngineEvent event = EngineEvent::kNothing; event != EngineEvent::kGone && !stop_.load();) {
        EngineCommand command;
        event = server_->Await(command, rt::MonotonicNow() + kSlice);
        if (event == EngineEvent::kEnd) server_->PutCarved(carved);
        if (event != EngineEvent::kCommand) continue;
        EngineFrame frame = test::SampleFrame();
        frame.model.pose_stamp = command.command.stamp;
        frame.model.frame = ++number;
        server_->Publish(frame);
      }
      server_->ResetSession();
    }
  }

  std::unique_ptr<UdpEngineServer> server_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

tl::expected<std::unique_ptr<UdpEngineClient>, std::string> Connect(std::uint16_t port,
                                                                    const std::string& token = "") {
  return UdpEngineClient::Connect(
      {.address = "127.0.0.1", .port = port, .token = token, .answer_within = kPatience},
      EncodeSetup(test::SampleSetup()));
}

// The UDP socket of a program that does not belong to the run.
class Stranger {
 public:
  explicit Stranger(std::uint16_t port) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_port = htons(port);
    inet_pton(AF_INET, "127.0.0.1", &there.sin_addr);
    static_cast<void>(connect(socket_, reinterpret_cast<const sockaddr*>(&there), sizeof there));
  }
  ~Stranger() { close(socket_); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;
  void Send(std::span<const std::uint8_t> bytes) const {
    static_cast<void>(send(socket_, bytes.data(), bytes.size(), 0));
  }

 private:
  int socket_;
};

TEST(UdpEngine, ServesARunFromItsSetUpToItsCarvedState) {
  Engine engine;
  engine.carved.resize(1'000'003);  // so large that its pieces need many windows
  for (std::size_t i = 0; i < engine.carved.size(); ++i) engine.carved[i] = static_cast<std::uint8_t>(i * 7);
  auto client = Connect(engine.port);
  ASSERT_TRUE(client) << client.error();
  EXPECT_EQ((*client)->engine(), "cpu");
  EXPECT_EQ((*client)->device(), "a test");
  EXPECT_EQ((*client)->Load().frame, 0u);
  EngineFrame frame;
  for (int i = 1; i <= 50; ++i) {
    (*client)->Store(test::CommandAt(1000 * i));
    ASSERT_TRUE((*client)->AwaitFrame(frame, Soon()));
    EXPECT_EQ(frame.model.pose_stamp, 1000 * i) << "the stamp returns";
    EXPECT_EQ((*client)->Load().pose_stamp, 1000 * i);
  }
  (*client)->Store(test::CommandAt(50'000));  // the same command again, so nothing is sent
  EXPECT_FALSE((*client)->AwaitFrame(frame, rt::MonotonicNow() + 20 * rt::kMillisecond));
  const auto carved = (*client)->FetchCarved(Soon());
  ASSERT_TRUE(carved) << carved.error();
  EXPECT_EQ(*carved, engine.carved);
  EXPECT_EQ((*client)->counters().lost, 0u);
  client->reset();
  engine.End();
  EXPECT_EQ(engine.setup_bytes, EncodeSetup(test::SampleSetup()));
}

TEST(UdpEngine, ServesOneRunAfterTheOther) {
  Engine engine;
  for (int run = 1; run <= 3; ++run) {
    auto client = Connect(engine.port);
    ASSERT_TRUE(client) << client.error();
    EXPECT_EQ(engine.runs.load(), run);
    (*client)->Store(test::CommandAt(10));
    EngineFrame frame;
    ASSERT_TRUE((*client)->AwaitFrame(frame, Soon()));
    EXPECT_EQ(frame.model.frame, 1u) << "its own engine";
  }
}

TEST(UdpEngine, ASecondRunIsRefusedWhileTheFirstLives) {
  Engine engine;
  auto first = Connect(engine.port);
  ASSERT_TRUE(first) << first.error();
  const auto second = Connect(engine.port);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error(), HasSubstr("serves another run"));
  (*first)->Store(test::CommandAt(10));
  EngineFrame frame;
  EXPECT_TRUE((*first)->AwaitFrame(frame, Soon())) << "the first goes on";
}

TEST(UdpEngine, ARunWithoutTheTokenIsRefused) {
  Engine engine({.token = "0123456789abcdef"});
  EXPECT_THAT(Connect(engine.port).error(), HasSubstr("the token is missing or wrong"));
  EXPECT_THAT(Connect(engine.port, "0123456789abcdeg").error(), HasSubstr("the token is missing or wrong"));
  EXPECT_TRUE(Connect(engine.port, "0123456789abcdef"));
}

TEST(UdpEngine, ListensBeyondTheLoopbackOnlyWithAToken) {
  const auto open = UdpEngineServer::Open({.address = "0.0.0.0"});
  ASSERT_FALSE(open);
  EXPECT_THAT(open.error(), HasSubstr("found no token"));
}

TEST(UdpEngine, AnErrorTellsThatNoEngineListens) {
  std::uint16_t port = 0;
  {
    Engine engine;
    port = engine.port;
  }
  const auto client =
      UdpEngineClient::Connect({.address = "127.0.0.1", .port = port, .answer_within = 50 * rt::kMillisecond},
                               std::vector<std::uint8_t>{1});
  ASSERT_FALSE(client);
  EXPECT_THAT(client.error(), HasSubstr("does `osteon simulate --listen` run there"));
}

// A stranger sends noise, and valid messages of another session. The run must continue, and the server must
// count these messages.
TEST(UdpEngine, MessagesOfStrangersAreRejected) {
  Engine engine;
  auto client = Connect(engine.port);
  ASSERT_TRUE(client) << client.error();
  const Stranger stranger(engine.port);
  EngineBytes bytes;
  EncodeEngine({.kind = EngineMessage::kCommand, .session = 1, .sequence = 1'000'000}, test::SampleCommand(),
               bytes);
  stranger.Send(bytes.view());
  EncodeEngine({.kind = EngineMessage::kGoodbye, .session = 1}, std::span<const std::uint8_t>{}, bytes);
  stranger.Send(bytes.view());
  const std::vector<std::uint8_t> noise(1400, 0xa5);
  stranger.Send(noise);
  stranger.Send({});
  EngineFrame frame;
  (*client)->Store(test::CommandAt(10));
  ASSERT_TRUE((*client)->AwaitFrame(frame, Soon()));
  EXPECT_EQ(frame.model.pose_stamp, 10);
  client->reset();
  engine.End();
  EXPECT_GE(engine.counters().rejected, 4u);
}

// A large block is sent in pieces. Half of the pieces are lost at random, and some arrive twice. The receiver
// must request the missing pieces until the block is complete.
TEST(UdpEngine, LostPiecesAreRequestedAgain) {
  std::vector<std::uint8_t> block(100 * kPieceBytes + 17);
  for (std::size_t i = 0; i < block.size(); ++i) block[i] = static_cast<std::uint8_t>(i % 251);
  BlockReceiver receiver(EngineBlock::kCarved, block.size());
  std::uint32_t random = 12345;
  rt::Nanoseconds now = 0;
  int rounds = 0;
  for (; !receiver.complete() && rounds < 10'000; ++rounds) {
    now += rt::kMillisecond;
    const auto want = receiver.NextWant(now);
    if (!want) continue;
    AnswerWant(*want, block, [&](std::span<const std::uint8_t> piece) {
      random = random * 1664525u + 1013904223u;
      if (random >> 31u) return;  // this piece is lost
      EXPECT_TRUE(receiver.Accept(piece));
      if ((random >> 29u) % 4 == 0) {
        EXPECT_TRUE(receiver.Accept(piece));  // this piece arrives twice
      }
    });
  }
  ASSERT_TRUE(receiver.complete()) << rounds;
  EXPECT_EQ(receiver.TakeBytes(), block);
}

TEST(UdpEngine, PiecesThatDoNotFitAreRefused) {
  BlockReceiver receiver(EngineBlock::kCarved, 2000);
  std::array<std::uint8_t, kPieceBytes + 9> content{};
  // a piece of this block with this number; its content has `size` bytes
  const auto piece = [&](std::uint8_t block, std::uint64_t number, std::size_t size) {
    ByteWriter writer(content);
    writer.Put(block);
    writer.Put(number);
    return std::span<const std::uint8_t>(content).first(9 + size);
  };
  EXPECT_FALSE(receiver.Accept(piece(0, 0, kPieceBytes))) << "of another block";
  EXPECT_FALSE(receiver.Accept(piece(1, 2, kPieceBytes))) << "beyond its end";
  EXPECT_FALSE(receiver.Accept(piece(1, 0, 10))) << "too short";
  EXPECT_FALSE(receiver.Accept(piece(1, 1, kPieceBytes))) << "too long";
  EXPECT_TRUE(receiver.Accept(piece(1, 1, 2000 - kPieceBytes)));
  EXPECT_FALSE(receiver.complete());
}

TEST(UdpEngine, StoreAndLoadDoNotAllocate) {
  Engine engine;
  auto client = Connect(engine.port);
  ASSERT_TRUE(client) << client.error();
  rt::CheckedNoAllocScope no_alloc;
  (*client)->Store(test::CommandAt(70));
  const std::uint64_t frame = (*client)->Load().frame;
  no_alloc.End();
  EXPECT_EQ(frame, 0u);
}

}  // namespace
}  // namespace osteon::io
