#include "io/modbus/plc_client.h"

#include <arpa/inet.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

// The PLC client against a server of libmodbus, and against servers that misbehave.

namespace osteon::io {
namespace {

using Bytes = std::vector<std::uint8_t>;

// A TCP server on the loopback that serves one connection at a time. `serve` gets each accepted socket that
// has bytes, and returns whether the socket stays open.
class Listener {
 public:
  explicit Listener(std::function<bool(int)> serve) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(socket_, 4), 0);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, serve = std::move(serve)] {
      int client = -1;
      while (!stop_) {
        pollfd waiting{client >= 0 ? client : socket_, POLLIN, 0};
        if (poll(&waiting, 1, 20) != 1) continue;
        if (client < 0) {
          client = accept(socket_, nullptr, nullptr);
          ++accepted_;
        } else if (!serve(client)) {
          close(client);
          client = -1;
        }
      }
      if (client >= 0) close(client);
    });
  }
  ~Listener() { Stop(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  void Stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] int accepted() const { return accepted_; }

 private:
  int socket_;
  std::uint16_t port_{0};
  std::atomic<bool> stop_{false};
  std::atomic<int> accepted_{0};
  std::thread thread_;
};

// A PLC made with libmodbus' server, with the registers 970 … 993: VERSION is 3, RUN_PERMITTED is 1, and the
// PLC's heartbeat (983) counts requests.
class LibmodbusServer {
 public:
  LibmodbusServer()
      : context_(modbus_new_tcp("127.0.0.1", 0)),
        mapping_(modbus_mapping_new_start_address(0, 0, 0, 0, 970, 24, 0, 0)) {
    Set(977, 3);
    Set(974, 1);
  }
  ~LibmodbusServer() {
    modbus_mapping_free(mapping_);
    modbus_free(context_);
  }
  LibmodbusServer(const LibmodbusServer&) = delete;
  LibmodbusServer& operator=(const LibmodbusServer&) = delete;

  // Answers one request on that socket; false if the connection has ended.
  bool Serve(int client) {
    modbus_set_socket(context_, client);
    std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> request;
    const int size = modbus_receive(context_, request.data());
    if (size < 0) return false;
    ++mapping_->tab_registers[983 - 970];
    if (modbus_reply(context_, request.data(), size, mapping_) < 0) return false;
    heartbeats = mapping_->tab_registers[20] * 65536u + mapping_->tab_registers[22];
    motion = mapping_->tab_registers[21];
    guard_permits = mapping_->tab_registers[23];
    return true;
  }
  // Call before the first Serve() only.
  void Set(int address, std::uint16_t value) { mapping_->tab_registers[address - 970] = value; }

  std::atomic<std::uint32_t> heartbeats{0};  // upper 16 bits: the controller's; lower 16 bits: the guard's
  std::atomic<int> motion{0}, guard_permits{0};

 private:
  modbus_t* context_;
  modbus_mapping_t* mapping_;
};

// A client that retries within milliseconds.
PlcClientParams QuickParams(std::uint16_t port) {
  return {.port = port, .response_timeout_ms = 200, .first_pause_ms = 5, .longest_pause_ms = 20};
}

// Waits until `holds` is true; false after about 20 s.
bool Until(PlcClient& client, const std::function<bool(const PlcReading&)>& holds) {
  for (int i = 0; i < 20'000; ++i) {
    if (holds(client.Latest())) return true;
    rt::SleepUntil(rt::MonotonicNow() + rt::kMillisecond);
  }
  return false;
}

TEST(PlcClient, ReadsRegistersAndWritesTheLoopsHeartbeat) {
  LibmodbusServer plc;
  plc.Set(970, 3);
  plc.Set(979, 1);
  const Listener listener([&](int socket) { return plc.Serve(socket); });
  PlcClient client(QuickParams(listener.port()));
  ASSERT_TRUE(Until(client, [](const PlcReading& r) { return r.counters.reads > 3; }))
      << Describe(QuickParams(listener.port()), client.Latest());
  const PlcReading reading = client.Latest();
  EXPECT_EQ(reading.link, PlcLink::kConnected);
  EXPECT_EQ(reading.inputs.mode, PlcMode::kAutomatic);
  EXPECT_EQ(reading.inputs.enabling, PlcEnabling::kEnabled);
  EXPECT_TRUE(reading.inputs.run_permitted);
  EXPECT_GT(reading.stamp, 0);
  EXPECT_LE(reading.stamp, rt::MonotonicNow());
  EXPECT_EQ(plc.heartbeats, 0u) << "no loop, no heartbeat";
  EXPECT_EQ(reading.counters.writes, 0u);

  client.RequestMotion(true);
  client.NotifyAlive();
  ASSERT_TRUE(Until(client, [&](const PlcReading&) { return plc.heartbeats == 1u << 16; }));
  EXPECT_EQ(plc.motion, 1);
  const std::uint32_t reads = client.Latest().counters.reads;
  ASSERT_TRUE(Until(client, [&](const PlcReading& r) { return r.counters.reads > reads + 15; }));
  EXPECT_EQ(plc.heartbeats, 1u << 16) << "one beat of the loop, one of the register";
  client.RequestMotion(false);
  client.NotifyAlive();
  ASSERT_TRUE(Until(client, [&](const PlcReading&) { return plc.heartbeats == 2u << 16; }));
  EXPECT_EQ(plc.motion, 0);
  client.Stop();
  EXPECT_EQ(client.Latest().link, PlcLink::kConnecting) << "nothing is connected any more";
}

TEST(PlcClient, AGuardWritesOnlyItsOwnRegisters) {
  LibmodbusServer plc;
  const Listener listener([&](int socket) { return plc.Serve(socket); });
  PlcClientParams params = QuickParams(listener.port());
  params.role = PlcRole::kGuard;
  PlcClient client(params);
  client.RequestMotion(true);
  client.NotifyAlive();
  ASSERT_TRUE(Until(client, [&](const PlcReading&) { return plc.heartbeats == 1; }));
  EXPECT_EQ(plc.motion, 0);
  EXPECT_EQ(plc.guard_permits, 1);
  client.RequestMotion(false);
  client.NotifyAlive();
  ASSERT_TRUE(Until(client, [&](const PlcReading&) { return plc.heartbeats == 2; }));
  EXPECT_EQ(plc.guard_permits, 0) << "withdrawn";
}

// The server closes each connection after five answers; the client must connect again and count this.
TEST(PlcClient, LostConnectionsAreCountedAndMadeAgain) {
  LibmodbusServer plc;
  std::atomic<int> left{5};
  const Listener listener([&](int socket) { return left-- > 0 ? plc.Serve(socket) : (left = 5, false); });
  PlcClient client(QuickParams(listener.port()));
  EXPECT_TRUE(Until(client, [](const PlcReading& r) { return r.counters.lost >= 3; }));
  EXPECT_TRUE(Until(client, [](const PlcReading& r) { return r.link == PlcLink::kConnected; }));
  EXPECT_GE(listener.accepted(), 4);
}

TEST(PlcClient, AnErrorTellsThatNoPlcListens) {
  Listener listener([](int) { return false; });
  const std::uint16_t port = listener.port();
  listener.Stop();  // the port is free now
  PlcClient client(QuickParams(port));
  ASSERT_TRUE(Until(client, [](const PlcReading& r) { return r.counters.refused >= 3; }));
  EXPECT_EQ(client.Latest().link, PlcLink::kConnecting);
  EXPECT_EQ(client.Latest().stamp, 0);
  const std::string text = Describe(QuickParams(port), client.Latest());
  EXPECT_NE(text.find("PLC 127.0.0.1:" + std::to_string(port) + ": no connection: Connection refused"),
            std::string::npos)
      << text;
}

// Each server's answer has a different error. The client must count the error, must never report that it is
// connected, and must never return a reading.
TEST(PlcClient, WrongAnswersNeverBecomeAReading) {
  // answers a request with these bytes; if they begin with 0xee, the request's transaction number replaces
  // the first two
  const auto answer = [](int socket, const Bytes& bytes) {
    std::array<std::uint8_t, 300> request;
    const ssize_t size = recv(socket, request.data(), request.size(), 0);
    if (size < 12) return false;
    Bytes sent = bytes;
    if (!sent.empty() && sent[0] == 0xee) std::copy_n(request.begin(), 2, sent.begin());  // the transaction
    return sent.empty() || send(socket, sent.data(), sent.size(), MSG_NOSIGNAL) > 0;
  };
  // a right answer: RUN_PERMITTED and VERSION 3
  Bytes good{0xee, 0xee, 0, 0, 0, 31, 0xff, 3, 28};
  for (const int value : {1, 0, 0, 0, 1, 0, 0, 3, 0, 0, 0, 0, 0, 0}) {
    good.push_back(0);
    good.push_back(static_cast<std::uint8_t>(value));
  }
  const auto changed = [&](std::size_t at, std::uint8_t value) {
    Bytes bytes = good;
    bytes[at] = value;
    return bytes;
  };
  struct Case {
    const char* name;
    Bytes bytes;
    std::function<bool(const PlcCounters&)> counted;
  };
  const auto rejected = [](const PlcCounters& n) { return n.rejected >= 2; };
  const auto timed_out = [](const PlcCounters& n) { return n.timeouts >= 2; };
  for (const Case& c : {
           Case{"hangs", {}, timed_out},
           Case{"half an answer", Bytes(good.begin(), good.begin() + 20), timed_out},
           Case{"another transaction", changed(0, 0x77), rejected},
           Case{"exception 2", {0xee, 0xee, 0, 0, 0, 3, 0xff, 0x83, 2}, rejected},
           Case{"an exception that is none", {0xee, 0xee, 0, 0, 0, 3, 0xff, 0x83, 200}, rejected},
           Case{"RUN_PERMITTED of 2", changed(9 + 2 * 4 + 1, 2), rejected},
           Case{"noise", Bytes(64, 0xa5), [](const PlcCounters& n) { return n.lost >= 2; }},
       }) {
    SCOPED_TRACE(c.name);
    const Listener listener([&](int socket) { return answer(socket, c.bytes); });
    PlcClientParams params = QuickParams(listener.port());
    params.response_timeout_ms = 20;
    PlcClient client(params);
    EXPECT_TRUE(Until(client, [&](const PlcReading& r) {
      EXPECT_NE(r.link, PlcLink::kConnected);
      return c.counted(r.counters);
    })) << Describe(params, client.Latest());
    EXPECT_EQ(client.Latest().stamp, 0);
    EXPECT_EQ(client.Latest().counters.writes, 0u);
  }
  // check of this test's own table: the unchanged answer gives a reading
  const Listener listener([&](int socket) { return answer(socket, good); });
  PlcClient client(QuickParams(listener.port()));
  EXPECT_TRUE(Until(client, [](const PlcReading& r) { return r.inputs.run_permitted; }));
}

TEST(PlcClient, NamesTheRegisterThatIsOutOfRange) {
  LibmodbusServer plc;
  plc.Set(979, 9);
  const Listener listener([&](int socket) { return plc.Serve(socket); });
  PlcClient client(QuickParams(listener.port()));
  ASSERT_TRUE(Until(client, [](const PlcReading& r) { return r.bad.address != 0; }));
  const std::string text = Describe(QuickParams(listener.port()), client.Latest());
  EXPECT_NE(text.find("register 979: found 9, accepted 0 … 2"), std::string::npos) << text;
}

TEST(PlcClient, TheTickNeitherWaitsNorAllocates) {
  LibmodbusServer plc;
  const Listener listener([&](int socket) { return plc.Serve(socket); });
  PlcClient client(QuickParams(listener.port()));
  ASSERT_TRUE(Until(client, [](const PlcReading& r) { return r.counters.reads > 0; }));
  PlcVerdict verdict{};
  rt::CheckedNoAllocScope no_alloc;
  for (int i = 0; i < 1000; ++i) {
    client.NotifyAlive();
    client.RequestMotion(i % 2 == 0);
    verdict = Judge(client.Latest(), rt::MonotonicNow(), 100 * rt::kSecond);
  }
  no_alloc.End();
  EXPECT_EQ(verdict, PlcVerdict::kRun);
}

TEST(PlcClient, RefusesParametersOutOfRangeAndNamesThem) {
  const auto refused = [](const PlcClientParams& params) -> std::string {
    try {
      PlcClient client(params);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refused({.address = "plc"}).find("address: found \"plc\""), std::string::npos);
  EXPECT_NE(refused({.port = 0}).find("port"), std::string::npos);
  EXPECT_NE(refused({.read_every_ms = 0}).find("read_every_ms"), std::string::npos);
  EXPECT_NE(refused({.heartbeat_every_ms = 101}).find("heartbeat_every_ms: found 101"), std::string::npos);
  EXPECT_NE(refused({.response_timeout_ms = 0}).find("response_timeout_ms"), std::string::npos);
  EXPECT_NE(refused({.connect_timeout_ms = 0}).find("connect_timeout_ms"), std::string::npos);
  EXPECT_NE(refused({.first_pause_ms = 0}).find("first_pause_ms"), std::string::npos);
  EXPECT_NE(refused({.first_pause_ms = 50, .longest_pause_ms = 49}).find("longest_pause_ms"),
            std::string::npos);
}

}  // namespace
}  // namespace osteon::io
