#include "console/server/foxglove_server.h"

#include <civetweb.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

// Tests the server for the Foxglove viewer: the protocol's messages as text and as bytes, and the server with
// real connections on the loopback.

namespace osteon::console {
namespace {

constexpr std::chrono::seconds kPatience{20};

TEST(FoxgloveProtocol, ReadsSubscriptions) {
  const auto request = ParseFoxgloveRequest(
      R"({"op": "subscribe", "subscriptions": [{"id": 7, "channelId": 1}, {"id": 8, "channelId": 0}]})", 2);
  ASSERT_TRUE(request) << request.error();
  const auto& all = std::get<FoxgloveSubscribe>(*request).subscriptions;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].id, 7u);
  EXPECT_EQ(all[0].channel, 1u);
  EXPECT_EQ(all[1].id, 8u);
  EXPECT_EQ(all[1].channel, 0u);
  const auto gone = ParseFoxgloveRequest(R"({"op": "unsubscribe", "subscriptionIds": [8]})", 2);
  ASSERT_TRUE(gone) << gone.error();
  EXPECT_EQ(std::get<FoxgloveUnsubscribe>(*gone).ids, std::vector<std::uint32_t>{8});
}

TEST(FoxgloveProtocol, RefusesOtherRequestsWithWhatIsAccepted) {
  for (const char* text :
       {"", "{", "[]", R"({"op": 1})", R"({"op": "setParameters"})", R"({"op": "subscribe"})",
        R"({"op": "subscribe", "subscriptions": 3})", R"({"op": "subscribe", "subscriptions": [3]})",
        R"({"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 0}]})",
        R"({"op": "subscribe", "subscriptions": [{"id": 4294967296, "channelId": 0}]})",
        R"({"op": "subscribe", "subscriptions": [{"id": 1.5, "channelId": 0}]})",
        R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 2}]})",
        R"({"op": "unsubscribe", "subscriptionIds": ["a"]})"}) {
    const auto request = ParseFoxgloveRequest(text, 2);
    ASSERT_FALSE(request) << text;
    EXPECT_NE(request.error().find("accepted"), std::string::npos) << request.error();
  }
  EXPECT_FALSE(ParseFoxgloveRequest(std::string(kMaxFoxgloveMessage + 1, ' '), 2));
  nlohmann::json many{{"op", "unsubscribe"}, {"subscriptionIds", nlohmann::json::array()}};
  for (std::size_t i = 0; i <= kMaxSubscriptions; ++i) many["subscriptionIds"].push_back(i);
  EXPECT_FALSE(ParseFoxgloveRequest(many.dump(), 2));
}

TEST(FoxgloveProtocol, WritesMessagesAsSpecified) {
  // the schema's bytes and their base64 text are those of Foxglove's own test of this message
  const std::vector<FoxgloveChannel> channels{
      {.topic = "t3", .schema_name = "t3-schema", .schema = "\xde\xad\xbe\xef"}};
  const auto advertised = nlohmann::json::parse(FoxgloveAdvertise(channels));
  EXPECT_EQ(advertised["op"], "advertise");
  EXPECT_EQ(advertised["channels"][0], (nlohmann::json{{"id", 0},
                                                       {"topic", "t3"},
                                                       {"encoding", "protobuf"},
                                                       {"schemaName", "t3-schema"},
                                                       {"schemaEncoding", "protobuf"},
                                                       {"schema", "3q2+7w=="}}));
  std::string bytes;
  FoxgloveMessageData(0x01020304, 0x05060708090A0B0C, "xy", bytes);
  EXPECT_EQ(bytes, std::string("\x01\x04\x03\x02\x01\x0C\x0B\x0A\x09\x08\x07\x06\x05xy", 15));
}

// A source of two channels, a and b. Each call of New gives a channel's next message: a1, a2, …
class CountingSource final : public FoxgloveSource {
 public:
  [[nodiscard]] const std::vector<FoxgloveChannel>& channels() const override { return channels_; }
  void New(std::size_t channel, FoxgloveCursor& cursor, std::vector<FoxgloveMessage>& out) const override {
    out.push_back({.stamp = 5, .bytes = channels_[channel].topic + std::to_string(++cursor.window)});
  }

 private:
  std::vector<FoxgloveChannel> channels_{{.topic = "a", .schema_name = "A", .schema = "s"},
                                         {.topic = "b", .schema_name = "B", .schema = "s"}};
};

// A Foxglove viewer: a WebSocket client that keeps all messages it receives.
class Viewer {
 public:
  // the client library copies the origin unchanged into its request, so a line break in it can add the header
  // of the subprotocol
  Viewer(int port, const std::string& origin, const char* subprotocol, const char* path = "/")
      : headers_(origin +
                 (subprotocol != nullptr ? std::string("\r\nSec-WebSocket-Protocol: ") + subprotocol : "")) {
    std::array<char, 256> error{};
    connection_ = mg_connect_websocket_client("127.0.0.1", port, 0, error.data(), error.size(), path,
                                              headers_.c_str(), OnData, nullptr, this);
  }
  ~Viewer() {
    if (connection_ != nullptr) mg_close_connection(connection_);
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  [[nodiscard]] bool open() const { return connection_ != nullptr; }
  void Send(const std::string& text, int opcode = MG_WEBSOCKET_OPCODE_TEXT) {
    mg_websocket_client_write(connection_, opcode, text.data(), text.size());
  }
  // Waits until `is` returns true for the messages received so far.
  bool Await(const std::function<bool(const std::vector<std::string>& texts,
                                      const std::vector<std::string>& binaries)>& is) {
    std::unique_lock lock(mutex_);
    return arrived_.wait_for(lock, kPatience, [&] { return is(texts_, binaries_); });
  }
  // Waits for a text message that contains `part`.
  bool AwaitText(const std::string& part) {
    return Await([&](const auto& texts, const auto&) {
      for (const std::string& text : texts)
        if (text.find(part) != std::string::npos) return true;
      return false;
    });
  }
  // Waits for a binary message of this subscription: opcode 1, id (4 bytes), stamp (8 bytes), payload.
  bool AwaitMessage(std::uint32_t id, const std::string& payload) {
    return Await([&](const auto&, const auto& binaries) {
      for (const std::string& bytes : binaries)
        if (bytes.size() > 13 && bytes[0] == 1 && std::memcmp(bytes.data() + 1, &id, 4) == 0 &&
            bytes.substr(13) == payload)
          return true;
      return false;
    });
  }

 private:
  static int OnData(mg_connection*, int bits, char* data, std::size_t size, void* user) {
    auto& viewer = *static_cast<Viewer*>(user);
    const std::lock_guard lock(viewer.mutex_);
    if ((bits & 0x0F) == MG_WEBSOCKET_OPCODE_TEXT) viewer.texts_.emplace_back(data, size);
    if ((bits & 0x0F) == MG_WEBSOCKET_OPCODE_BINARY) viewer.binaries_.emplace_back(data, size);
    viewer.arrived_.notify_all();
    return 1;
  }

  const std::string headers_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<std::string> texts_, binaries_;  // guarded by mutex_
  mg_connection* connection_{nullptr};
};

class FoxgloveServerTest : public ::testing::Test {
 protected:
  void Start(const std::string& address = "127.0.0.1") {
    auto server = FoxgloveServer::Start({.name = "a cell", .address = address, .port = 0}, source_);
    ASSERT_TRUE(server) << server.error();
    server_ = std::move(*server);
  }
  CountingSource source_;
  std::unique_ptr<FoxgloveServer> server_;
};

TEST_F(FoxgloveServerTest, SendsAViewerTheChannelsThatItSubscribesTo) {
  Start();
  for (const char* subprotocol : kFoxgloveSubprotocols) {
    Viewer viewer(server_->port(), "file://", subprotocol);
    ASSERT_TRUE(viewer.open()) << subprotocol;
    ASSERT_TRUE(viewer.AwaitText(R"("op":"serverInfo")"));
    ASSERT_TRUE(viewer.AwaitText(R"("op":"advertise")"));
    viewer.Send(R"({"op": "subscribe", "subscriptions": [{"id": 3, "channelId": 1}]})");
    ASSERT_TRUE(viewer.AwaitMessage(3, "b1"));
    ASSERT_TRUE(viewer.AwaitMessage(3, "b2")) << "the cursor moves on";
    viewer.Send(R"({"op": "subscribe", "subscriptions": [{"id": 4, "channelId": 0}]})");
    ASSERT_TRUE(viewer.AwaitMessage(4, "a1")) << "a later subscription begins at its beginning";
    viewer.Send(R"({"op": "unsubscribe", "subscriptionIds": [3]})");
    viewer.Send(R"({"op": "subscribe", "subscriptions": [{"id": 5, "channelId": 1}]})");
    ASSERT_TRUE(viewer.AwaitMessage(5, "b1"));
  }
}

TEST_F(FoxgloveServerTest, AnswersThatItAcceptsNoCommands) {
  Start();
  Viewer viewer(server_->port(), "http://localhost:8080", "foxglove.sdk.v1");
  ASSERT_TRUE(viewer.open());
  viewer.Send(R"({"op": "setParameters", "parameters": []})");
  EXPECT_TRUE(viewer.AwaitText("takes nothing"));
  viewer.Send("\x01 a message for the cell", MG_WEBSOCKET_OPCODE_BINARY);
  EXPECT_TRUE(viewer.AwaitText("binary message"));
  viewer.Send(
      R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 0}, {"id": 1, "channelId": 1}]})");
  EXPECT_TRUE(viewer.AwaitText("a second time"));
  EXPECT_TRUE(viewer.AwaitMessage(1, "a1"));
}

TEST_F(FoxgloveServerTest, RefusesOtherOriginsAndProtocols) {
  Start();
  EXPECT_FALSE(Viewer(server_->port(), "https://example.org", "foxglove.sdk.v1").open());
  EXPECT_FALSE(Viewer(server_->port(), "http://localhost.example.org", "foxglove.sdk.v1").open());
  EXPECT_FALSE(Viewer(server_->port(), "file://", "another.v1").open());
  EXPECT_FALSE(Viewer(server_->port(), "file://", nullptr).open());
  EXPECT_TRUE(Viewer(server_->port(), "https://app.foxglove.dev", "foxglove.sdk.v1").open());
}

TEST_F(FoxgloveServerTest, NeedsATokenBeyondTheLoopback) {
  Start("0.0.0.0");
  EXPECT_FALSE(Viewer(server_->port(), "file://", "foxglove.sdk.v1").open());
  const std::string url = server_->url();
  const std::string query = url.substr(url.find("/?") + 1);
  EXPECT_TRUE(Viewer(server_->port(), "file://", "foxglove.sdk.v1", ("/" + query).c_str()).open()) << url;
}

TEST_F(FoxgloveServerTest, ServesAtMostTheMaximumAndEndsWhileTheyAreOpen) {
  Start();
  std::vector<std::unique_ptr<Viewer>> viewers;
  for (std::size_t i = 0; i < kMaxFoxgloveViewers; ++i) {
    viewers.push_back(std::make_unique<Viewer>(server_->port(), "file://", "foxglove.websocket.v1"));
    ASSERT_TRUE(viewers.back()->open());
  }
  EXPECT_FALSE(Viewer(server_->port(), "file://", "foxglove.websocket.v1").open());
  EXPECT_EQ(server_->viewers(), kMaxFoxgloveViewers);
  server_.reset();
}

}  // namespace
}  // namespace osteon::console
