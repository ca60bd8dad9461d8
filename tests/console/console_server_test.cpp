#include "console/server/console_server.h"

#include <civetweb.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "safety/cell_state.h"
#include "tests/io/temporary_folder.h"

// Tests of the console's server with real connections on the loopback. Each wait ends as soon as its
// condition holds; kPatience is only its upper bound.

namespace osteon::console {
namespace {

constexpr std::chrono::seconds kPatience{20};

// Replaces a page in a browser: a WebSocket client that keeps all messages that it receives.
// @param reads  false: the client does not read what the server sends
class Client {
 public:
  Client(int port, const char* origin, bool reads = true, const char* path = "/live") : reads_(reads) {
    std::array<char, 256> error{};
    connection_ = mg_connect_websocket_client("127.0.0.1", port, 0, error.data(), error.size(), path, origin,
                                              OnData, OnClose, this);
  }
  ~Client() {
    stop_.store(true);
    if (connection_ != nullptr) mg_close_connection(connection_);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  [[nodiscard]] bool open() const { return connection_ != nullptr; }
  void Send(const std::string& text) {
    mg_websocket_client_write(connection_, MG_WEBSOCKET_OPCODE_TEXT, text.data(), text.size());
  }
  /// Waits for the next message of this type for which `is` returns true; null if none arrives.
  nlohmann::json Await(const std::string& type, const std::function<bool(const nlohmann::json&)>& is = {}) {
    std::unique_lock lock(mutex_);
    nlohmann::json found;
    arrived_.wait_for(lock, kPatience, [&] {
      for (; next_ < texts_.size(); ++next_) {
        auto json = nlohmann::json::parse(texts_[next_]);
        if (json["type"] == type && (!is || is(json))) {
          found = std::move(json);
          ++next_;
          return true;
        }
      }
      return false;
    });
    return found;
  }
  /// Waits until `count` binary messages have arrived since the beginning. Binary messages carry bricks.
  bool AwaitBinary(std::size_t count) {
    std::unique_lock lock(mutex_);
    return arrived_.wait_for(lock, kPatience, [&] { return binaries_.size() >= count; });
  }
  [[nodiscard]] std::size_t binaries() {
    const std::lock_guard lock(mutex_);
    return binaries_.size();
  }
  /// Whether a message of this type has arrived.
  [[nodiscard]] bool Has(const std::string& type) {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(texts_,
                               [&](const auto& text) { return nlohmann::json::parse(text)["type"] == type; });
  }
  void StopReading() { reads_.store(false); }
  [[nodiscard]] std::size_t binary_bytes() {
    const std::lock_guard lock(mutex_);
    std::size_t bytes = 0;
    for (const std::string& binary : binaries_) bytes += binary.size();
    return bytes;
  }
  bool AwaitClose() {
    std::unique_lock lock(mutex_);
    return arrived_.wait_for(lock, kPatience, [&] { return closed_; });
  }

 private:
  static int OnData(mg_connection*, int bits, char* data, std::size_t size, void* user) {
    auto& client = *static_cast<Client*>(user);
    while (!client.reads_.load() && !client.stop_.load())
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::lock_guard lock(client.mutex_);
    if ((bits & 0x0F) == MG_WEBSOCKET_OPCODE_TEXT) client.texts_.emplace_back(data, size);
    if ((bits & 0x0F) == MG_WEBSOCKET_OPCODE_BINARY) client.binaries_.emplace_back(data, size);
    client.arrived_.notify_all();
    return 1;
  }
  static void OnClose(const mg_connection*, void* user) {
    auto& client = *static_cast<Client*>(user);
    const std::lock_guard lock(client.mutex_);
    client.closed_ = true;
    client.arrived_.notify_all();
  }

  std::atomic<bool> reads_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<std::string> texts_, binaries_;
  std::size_t next_{0};
  bool closed_{false};
  mg_connection* connection_{nullptr};
};

// A server whose feed receives a tick of a cutting cell about every millisecond.
class ConsoleServerTest : public testing::Test {
 protected:
  void SetUp() override {
    auto server = ConsoleServer::Start(
        {.port = 0,
         .page = folder_.path(),
         .hello = R"({"type":"hello","cell":"test"})",
         .context = {.force_limit_N = 200.0, .bone_age_s = [] { return std::optional<double>(2.0); }},
         .request =
             [this](OperatorRequest request) {
               requests_.fetch_or(1u << static_cast<unsigned>(request));
               return RequestAnswer{.done = true, .reason = ""};
             },
         .operator_left = [this] { ++left_; }},
        feed_, surface_);
    ASSERT_TRUE(server) << server.error();
    server_ = std::move(*server);
    feeder_ = std::thread([this] {
      control::TickRecord tick;
      while (!done_.load()) {
        tick.stamp += 1'000'000;
        ++tick.tick;
        tick.cell_state = static_cast<std::uint8_t>(safety::CellState::kCutting);
        feed_.TakeTick(tick);
        if (tick.tick % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
    });
  }
  void TearDown() override {
    server_.reset();
    done_.store(true);
    if (feeder_.joinable()) feeder_.join();
  }
  // without the port, because the client's Host header has none and the origin must equal the host
  [[nodiscard]] static std::string origin() { return "http://127.0.0.1"; }
  // Waits until `is` returns true. Returns false if that takes longer than kPatience.
  bool Eventually(const std::function<bool()>& is) const {
    for (const auto end = std::chrono::steady_clock::now() + kPatience;
         std::chrono::steady_clock::now() < end;) {
      if (is()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  io::test::TemporaryFolder folder_;
  LiveFeed feed_;
  SurfaceStore surface_;
  std::atomic<unsigned> requests_{0};
  std::atomic<int> left_{0};  // number of pages that vanished while they had the operator's role
  std::atomic<bool> done_{false};
  std::unique_ptr<ConsoleServer> server_;
  std::thread feeder_;
};

TEST_F(ConsoleServerTest, APageGetsHelloThenTheStreamAndTheSurface) {
  surface_.Begin(surface::BrickLayout{}, R"({"type":"surface"})");
  surface_.Put({{1, "brick"}});
  Client page(server_->port(), origin().c_str());
  ASSERT_TRUE(page.open());
  EXPECT_EQ(page.Await("hello")["cell"], "test");
  EXPECT_FALSE(page.Await("surface").is_null());
  EXPECT_GE(page.Await("surface_whole")["age_ms"].get<double>(), 2000.0);
  const auto first = page.Await("live"), second = page.Await("live");
  EXPECT_EQ(first["status"]["state"], "cutting");
  EXPECT_LT(first["windows"].back()[0].get<double>(), second["windows"].back()[0].get<double>());
  EXPECT_TRUE(page.AwaitBinary(1));
  surface_.Put({{1, "brick, cut"}});
  EXPECT_TRUE(page.AwaitBinary(2));
}

// A page clears its charts when it receives the message hello. Therefore the server must send it the earlier
// windows again.
TEST_F(ConsoleServerTest, APageThatAsksForAllGetsTheKeptWindowsAgain) {
  Client page(server_->port(), origin().c_str());
  ASSERT_TRUE(page.open());
  const double first_s = page.Await("live")["windows"][0][0].get<double>();
  const auto later = page.Await(
      "live", [&](const auto& live) { return live["windows"][0][0].template get<double>() > first_s + 0.1; });
  ASSERT_FALSE(later.is_null());
  page.Send(R"({"ask": "all"})");
  EXPECT_FALSE(page.Await("hello").is_null());
  EXPECT_LE(page.Await("live")["windows"][0][0].get<double>(), first_s);
}

// The change has 4.5 MB, and a message has at most 1 MiB (1.049 MB). The message surface_whole must come
// after the last part.
TEST_F(ConsoleServerTest, ALargeChangeIsReportedWholeAfterItsLastMessage) {
  surface_.Begin(surface::BrickLayout{}, R"({"type":"surface"})");
  std::vector<std::pair<std::uint64_t, std::string>> change;
  for (std::uint64_t brick = 0; brick < 450; ++brick) change.emplace_back(brick, std::string(10'000, 'x'));
  surface_.Put(std::move(change));
  Client page(server_->port(), origin().c_str());
  ASSERT_TRUE(page.open());
  EXPECT_FALSE(page.Await("surface_whole").is_null());
  EXPECT_GE(page.binaries(), 4500u / 1049u + 1u);
  EXPECT_EQ(page.binary_bytes(), 4'500'000u);
}

// During a cut a new change comes every 5 ms, with 412 bricks as for a reamer. The page must still receive
// complete changes.
TEST_F(ConsoleServerTest, WholeChangesReachThePageWhileTheCutGoesOn) {
  surface_.Begin(surface::BrickLayout{}, R"({"type":"surface"})");
  std::atomic<bool> done{false};
  std::thread cut([&] {
    while (!done.load()) {
      std::vector<std::pair<std::uint64_t, std::string>> change;
      for (std::uint64_t brick = 0; brick < 412; ++brick) change.emplace_back(brick, std::string(350, 'x'));
      surface_.Put(std::move(change));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  Client page(server_->port(), origin().c_str());
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(page.Await("surface_whole").is_null()) << i;
  done.store(true);
  cut.join();
}

// To compare two recordings, one server has two streams. It sends its notes to the pages of both streams.
TEST_F(ConsoleServerTest, APageThatAsksForTheSecondStreamGetsIt) {
  LiveFeed feed;
  control::TickRecord tick;
  for (tick.tick = 1; tick.tick <= 100; ++tick.tick) {
    tick.stamp = static_cast<rt::Nanoseconds>(tick.tick) * 1'000'000;
    tick.F_coupling_T_W.f = {42.0, 0.0, 0.0};
    feed.TakeTick(tick);
  }
  const auto server =
      ConsoleServer::Start({.port = 0,
                            .page = folder_.path(),
                            .hello = R"({"type":"hello","cell":"first"})",
                            .context = {},
                            .request = {},
                            .notes = {[] { return R"({"type":"note"})"; }},
                            .second = ConsoleStream{.hello = R"({"type":"hello","cell":"second"})",
                                                    .context = {},
                                                    .feed = feed,
                                                    .surface = surface_}},
                           feed_, surface_);
  ASSERT_TRUE(server) << server.error();
  Client first((*server)->port(), origin().c_str(), true, "/live?stream=1"),
      second((*server)->port(), origin().c_str(), true, "/live?stream=2");
  EXPECT_EQ(first.Await("hello")["cell"], "first");
  EXPECT_EQ(second.Await("hello")["cell"], "second");
  EXPECT_FALSE(second.Await("note").is_null());
  const auto is_of_second = [](const nlohmann::json& live) { return live["status"]["force_N"] == 42.0; };
  EXPECT_FALSE(second.Await("live", is_of_second).is_null());
  // a server without a second stream sends its only stream
  Client other(server_->port(), origin().c_str(), true, "/live?stream=2");
  EXPECT_EQ(other.Await("hello")["cell"], "test");
}

TEST_F(ConsoleServerTest, OnlyTheOperatorsPageSteers) {
  Client one(server_->port(), origin().c_str()), two(server_->port(), origin().c_str());
  ASSERT_TRUE(one.open() && two.open());
  one.Send(R"({"ask": "role"})");
  EXPECT_TRUE(one.Await("answer")["done"].get<bool>());
  two.Send(R"({"ask": "role"})");
  EXPECT_FALSE(two.Await("answer")["done"].get<bool>());
  two.Send(R"({"ask": "stop"})");
  EXPECT_FALSE(two.Await("answer")["done"].get<bool>());
  EXPECT_EQ(requests_.load(), 0u);
  one.Send(R"({"ask": "pause"})");
  EXPECT_TRUE(one.Await("answer")["done"].get<bool>());
  EXPECT_EQ(requests_.load(), 1u << static_cast<unsigned>(OperatorRequest::kPause));
  one.Send(R"({"ask": "watch"})");
  EXPECT_FALSE(
      two.Await("role", [](const auto& role) { return !role["taken"].template get<bool>(); }).is_null());
  two.Send(R"({"ask": "role"})");
  EXPECT_TRUE(two.Await("answer")["done"].get<bool>());
}

// No notice is given when a page closes that only watched, or that had returned the operator's role before.
TEST_F(ConsoleServerTest, OnlyAPageThatVanishesWithTheRoleIsReported) {
  {
    Client watches(server_->port(), origin().c_str()), gives_back(server_->port(), origin().c_str());
    gives_back.Send(R"({"ask": "role"})");
    EXPECT_FALSE(gives_back.Await("role", [](const auto& role) { return role["mine"].template get<bool>(); })
                     .is_null());
    gives_back.Send(R"({"ask": "watch"})");
    EXPECT_FALSE(
        gives_back.Await("role", [](const auto& role) { return !role["taken"].template get<bool>(); })
            .is_null());
  }
  EXPECT_TRUE(Eventually([&] { return server_->pages() == 0; }));
  EXPECT_EQ(left_.load(), 0);
  {
    Client operates(server_->port(), origin().c_str());
    operates.Send(R"({"ask": "role"})");
    EXPECT_FALSE(
        operates.Await("role", [](const auto& role) { return role["mine"].template get<bool>(); }).is_null());
  }
  EXPECT_TRUE(Eventually([&] { return left_.load() == 1; }));
  Client stays(server_->port(), origin().c_str());
  stays.Send(R"({"ask": "role"})");
  EXPECT_FALSE(
      stays.Await("role", [](const auto& role) { return role["mine"].template get<bool>(); }).is_null());
  server_.reset();  // at the end of the run pages close as well, which must not be reported
  EXPECT_EQ(left_.load(), 1);
}

TEST_F(ConsoleServerTest, AnOperatorsPageThatVanishesFreesTheRole) {
  Client stays(server_->port(), origin().c_str());
  {
    Client goes(server_->port(), origin().c_str());
    goes.Send(R"({"ask": "role"})");
    ASSERT_TRUE(goes.Await("answer")["done"].get<bool>());
  }
  EXPECT_FALSE(
      stays
          .Await("role",
                 [](const auto& role) { return !role["taken"].template get<bool>() && role["pages"] == 1; })
          .is_null());
}

// A page reports the time stamp of the figure that it has just drawn. The server computes the delay with its
// own clock. It ignores stamps that are in the future or too old.
TEST_F(ConsoleServerTest, TheDelayUntilAFigureIsDrawnIsMeasuredByTheServersClock) {
  Client page(server_->port(), origin().c_str());
  EXPECT_FALSE(server_->drawn_ms());
  const double now_s = rt::ToSeconds(rt::MonotonicNow());
  for (const double stamp_s : {now_s + 100.0, now_s - 100.0, -1e300})
    page.Send(nlohmann::json{{"ask", "drawn"}, {"value", stamp_s}}.dump());
  page.Send(nlohmann::json{{"ask", "drawn"}, {"value", now_s - 0.05}}.dump());
  ASSERT_TRUE(Eventually([&] { return server_->drawn_ms().has_value(); }));
  EXPECT_GE(*server_->drawn_ms(), 50.0);
  EXPECT_LT(*server_->drawn_ms(), 20e3);
  EXPECT_EQ(server_->counts().bad_messages, 0u);
}

TEST_F(ConsoleServerTest, PagesOfOtherOriginsAreRefused) {
  EXPECT_FALSE(Client(server_->port(), "http://evil.example").open());
  EXPECT_FALSE(Client(server_->port(), "null").open());
  EXPECT_TRUE(Eventually([&] { return server_->counts().refused == 2; }));
  EXPECT_EQ(server_->pages(), 0u);
}

TEST_F(ConsoleServerTest, AServerBeyondTheLoopbackNeedsItsToken) {
  auto open = ConsoleServer::Start(
      {.address = "0.0.0.0", .port = 0, .page = folder_.path(), .hello = "{}", .context = {}, .request = {}},
      feed_, surface_);
  ASSERT_TRUE(open) << open.error();
  const std::string url = (*open)->url();
  const std::size_t token = url.find("?token=");
  ASSERT_NE(token, std::string::npos) << url;
  EXPECT_FALSE(Client((*open)->port(), origin().c_str()).open());
  EXPECT_FALSE(Client((*open)->port(), origin().c_str(), true, "/live?token=0").open());
  EXPECT_TRUE(Client((*open)->port(), origin().c_str(), true, ("/live" + url.substr(token)).c_str()).open());
}

TEST_F(ConsoleServerTest, HostileMessagesAreAnsweredAndCounted) {
  Client page(server_->port(), origin().c_str());
  for (const char* bytes : {"x", "{\"ask\": \"raise the limit\"}", "[[[["}) {
    page.Send(bytes);
    EXPECT_NE(page.Await("answer")["reason"].get<std::string>().find("accepted"), std::string::npos);
  }
  EXPECT_EQ(server_->counts().bad_messages, 3u);
  EXPECT_EQ(requests_.load(), 0u);
}

TEST_F(ConsoleServerTest, OfSixtyFourPagesSixteenAreServed) {
  std::vector<std::unique_ptr<Client>> pages;
  for (int i = 0; i < 64; ++i) pages.push_back(std::make_unique<Client>(server_->port(), origin().c_str()));
  std::size_t served = 0;
  for (const auto& page : pages)
    if (page->open() && !page->Await("live").is_null()) ++served;
  EXPECT_EQ(served, kMaxPages);
  pages.clear();
  EXPECT_TRUE(Eventually([&] { return server_->pages() == 0; }));
  EXPECT_FALSE(Client(server_->port(), origin().c_str()).Await("live").is_null());
}

// The server closes a page that does not read for 10 s. One test checks all consequences, so that it has to
// wait only once.
TEST_F(ConsoleServerTest, APageThatDoesNotReadIsClosedDelaysNoOtherAndLearnsWhyWhenItReopens) {
  Client slow(server_->port(), origin().c_str());
  const std::string key = slow.Await("key")["key"];
  slow.StopReading();
  for (std::uint64_t brick = 0; brick < 40; ++brick) surface_.Put({{brick, std::string(1u << 20, 'x')}});
  Client stuck(server_->port(), origin().c_str(), false);
  ASSERT_TRUE(stuck.open());
  Client page(server_->port(), origin().c_str());
  EXPECT_TRUE(page.AwaitBinary(1));
  EXPECT_FALSE(page.Await("live").is_null());
  ASSERT_TRUE(Eventually([&] { return server_->counts().slow == 2; }));
  EXPECT_FALSE(page.Await("live").is_null());

  Client again(server_->port(), origin().c_str(), true, ("/live?was=" + key).c_str());
  const auto closed = again.Await("closed");
  EXPECT_EQ(closed["code"], 1008);
  EXPECT_NE(closed["reason"].get<std::string>().find("took nothing"), std::string::npos);
  // only the closed page learns the reason, and only once
  Client third(server_->port(), origin().c_str(), true, ("/live?was=" + key).c_str());
  Client other(server_->port(), origin().c_str());
  for (Client* each : {&third, &other}) {
    EXPECT_FALSE(each->Await("live").is_null());
    EXPECT_FALSE(each->Has("closed"));
  }
}

TEST_F(ConsoleServerTest, PagesThatOpenAndCloseLeaveNoConnection) {
  for (int i = 0; i < 100; ++i) {
    Client page(server_->port(), origin().c_str());
    ASSERT_TRUE(page.open()) << i;
    if (i % 10 == 0) page.Send(R"({"ask": "role"})");
  }
  EXPECT_TRUE(Eventually([&] { return server_->pages() == 0; }));
  EXPECT_EQ(server_->counts().opened, 100u);
}

TEST_F(ConsoleServerTest, APortInUseIsSkippedUnlessTheUserNamedIt) {
  const ConsoleParams params{
      .port = server_->port(), .page = folder_.path(), .hello = "{}", .context = {}, .request = {}};
  const auto next = ConsoleServer::Start(params, feed_, surface_);
  ASSERT_TRUE(next) << next.error();
  EXPECT_NE((*next)->port(), server_->port());
  ConsoleParams named = params;
  named.only_this_port = true;
  const auto refused = ConsoleServer::Start(named, feed_, surface_);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("--console PORT"), std::string::npos) << refused.error();
}

}  // namespace
}  // namespace osteon::console
